"""Which vehicles leave the road and are told to rest on it again."""

from __future__ import annotations

import pytest

from sgcad_core.planner.lines.departures import comes_back
from sgcad_core.records.course import CourseTold, RestTold


@pytest.mark.parametrize(
    ("departs", "rest", "back"),
    [
        ("right", RestTold(where="road"), True),
        ("left", RestTold(where="intersection"), True),
        ("left", RestTold(where="off_road", side="right"), True),
        ("right", RestTold(where="off_road", side="right"), False),
        ("right", RestTold(), False),
        (None, RestTold(where="road"), False),
    ],
)
def test_one_that_left_the_road_comes_back_to_a_rest_on_it_or_beyond_it(departs, rest, back) -> None:
    assert comes_back("straight", CourseTold(departs=departs, rest=rest)) is back


def test_a_maneuver_off_the_road_is_left_for_a_rest_on_it() -> None:
    assert comes_back("departing_road_left", CourseTold(rest=RestTold(where="road")))
    assert not comes_back("straight", CourseTold(rest=RestTold(where="road")))
