"""Where a told course is missed, the same encounter is tried a little otherwise, and the moment of a touch is exact."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.planner.attempts import Unfolded, least_missed
from sgcad_core.planner.encounter import _root
from sgcad_core.planner.resting import IMPACTS
from sgcad_core.planner.scene import Scene


def test_without_an_encounter_nothing_else_is_tried() -> None:
    calls = []

    def unfold(found, impacts):
        calls.append((found, impacts))
        return Unfolded(Scene(10, 2), (), 0.0, 9.0)

    assert least_missed(None, unfold).missed == 9.0
    assert calls == [(None, IMPACTS)]


@pytest.mark.parametrize("bend", [0.0, 0.3])
def test_the_moment_of_a_touch_is_found_between_two_samples(bend: float) -> None:
    rng = np.random.default_rng(1)
    wanted, rate = rng.uniform(-0.95, 0.95, 40), rng.uniform(0.2, 1.0, 40)

    def over(at):
        return rate * (at - wanted) + bend * np.sign(at - wanted) * (at - wanted) ** 2

    assert _root(over, 40) == pytest.approx(wanted, abs=5e-3)
