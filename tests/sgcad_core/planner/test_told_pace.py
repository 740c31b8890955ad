"""The speed of free traffic as words tell it."""

from __future__ import annotations

import pytest

from sgcad_core.planner.told_pace import BACKS_MPS, MOST_MPS, OVER_LIMIT_MPS, SLOW_SHARE, free_speed


def test_untold_is_the_limit_up_to_what_anybody_drives() -> None:
    assert free_speed(None, 15.0, None) == 15.0
    assert free_speed(None, 40.0, None) == MOST_MPS


@pytest.mark.parametrize("limit_mps", [9.0, 15.6, 31.0])
def test_fast_is_above_the_limit_and_slow_far_below_it(limit_mps: float) -> None:
    assert free_speed("fast", limit_mps, None) == pytest.approx(limit_mps + OVER_LIMIT_MPS)
    assert free_speed("slow", limit_mps, None) == pytest.approx(min(limit_mps, MOST_MPS) * SLOW_SHARE)


def test_a_cyclist_is_fast_or_slow_as_cyclists_are() -> None:
    assert free_speed("slow", 15.0, 5.5) < free_speed(None, 15.0, 5.5) == 5.5 < free_speed("fast", 15.0, 5.5) < 15.0


def test_one_that_backs_does_so_faster_or_slower_too() -> None:
    assert BACKS_MPS["slow"] < BACKS_MPS[None] < BACKS_MPS["fast"] < 10.0
