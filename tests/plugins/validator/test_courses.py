"""Where an actor may start: upstream of everything, on pieces of a leg that a small model can name."""

import pytest

from plugins.validator._courses import approaches, heading
from sgcad_core.reading.layout.road_ways import ways_of
from sgcad_core.reading.text.compass import angle_of
from sgcad_core.records.specs import Access, Leg, RoadLayout
from sgcad_core.roads.layout import road_spec


def starts(legs: str, way: str, *accesses: Access) -> set[tuple[str, str]]:
    layout = RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in legs), accesses=accesses)
    spec = road_spec(layout)
    ways = heading(ways_of(spec), angle_of(way))
    return {(w.road.id, w.direction) for w in approaches(ways, spec)}


@pytest.mark.parametrize(("legs", "way", "found"), [
    ("EW", "W", {("E", "forward")}),
    ("NESW", "N", {("S", "forward")}),
    ("ESW", "E", {("W", "forward")}),
    ("ESW", "S", {("S", "backward")}),
])  # fmt: skip
def test_a_start_lies_where_nobody_drives_into_it(legs: str, way: str, found: set[tuple[str, str]]) -> None:
    assert starts(legs, way) == found


def test_a_leg_with_an_access_may_be_named_by_the_leg() -> None:
    access = Access(leg="E", side="right", distance_m=40.0)
    assert starts("EW", "W", access) == {("E", "forward"), ("E_outer", "forward")}
    assert starts("EW", "E", access) == {("W", "forward")}
