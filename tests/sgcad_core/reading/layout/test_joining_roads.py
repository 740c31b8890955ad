"""The street lies across the driveway that vehicles leave, and a crash on a ramp alone needs no other road."""

from __future__ import annotations

import pytest

from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import RoadLayout
from sgcad_core.roads.layout import road_spec


def drawn(text: str) -> tuple[RoadLayout, dict[str, tuple[str, str | None]]]:
    """The layout, and the road on which each vehicle starts with the one that it takes."""
    found = read(text)
    layout = layout_of_facts(found.roads)
    behavior = behavior_of_facts(found.crash, road_spec(layout))
    return layout, {actor.id: (actor.road, actor.exit_road) for actor in behavior.actors}


@pytest.mark.parametrize(("text", "drive", "starts"), [
    (
        "V1 was southbound leaving a private drive and meant to turn right. V2 was southbound leaving the same "
        "private drive and meant to turn left. The front of V1 struck the left side of V2.",
        "N", {"V1": "N", "V2": "N"},
    ),
    (
        "V1 was northbound in lane one of a two-lane road, exiting a private drive, and wanted to cross over. V2 was "
        "eastbound in lane two of a four-lane divided road. The front of V2 struck the left side of V1.",
        "S", {"V1": "S", "V2": "W"},
    ),
    (
        "V1 was entering the road, heading east on a two-way, two lane driveway. V2 was northbound on the road. The "
        "front of V1 struck the left side of V2.",
        "W", {"V1": "W", "V2": "S"},
    ),
])  # fmt: skip
def test_who_leaves_a_driveway_starts_in_it(text: str, drive: str, starts: dict[str, str]) -> None:
    layout, ways = drawn(text)
    assert [leg.bearing for leg in layout.legs if leg.kind == "driveway"] == [drive]
    assert {leg.bearing for leg in layout.legs} in ({"N", "E", "W"}, {"S", "E", "W"}, {"N", "S", "E"}, {"N", "S", "W"})
    assert {id: road for id, (road, _) in ways.items()} == starts


def test_the_lanes_told_of_the_street_stay_with_it() -> None:
    text = (
        "V1 was westbound on a five lane road, coming out of a parking lot. V2 was on the road as well. The front of "
        "V2 struck the right side of V1."
    )
    layout, ways = drawn(text)
    lanes = {leg.bearing: leg.lanes_in + leg.lanes_out for leg in layout.legs if leg.kind == "road"}
    assert lanes == {"N": 5, "S": 5}
    assert ways["V1"][0] == "E"


@pytest.mark.parametrize("text", [
    "V1 and V2 were traveling south on an off-ramp, V1 ahead of V2. V1 stopped and the front of V2 struck the back of "
    "V1.",
    "V1 was stopped on the southbound exit ramp. V2 came from the freeway onto the same southbound ramp. The front "
    "of V2 struck the back of V1.",
    "V1 was traveling south on a single lane entrance ramp to a freeway. The front of V1 struck a pole.",
])  # fmt: skip
def test_a_crash_on_a_ramp_is_drawn_on_a_one_way_ramp(text: str) -> None:
    layout, ways = drawn(text)
    assert [(leg.bearing, leg.lanes_in, leg.lanes_out, leg.kind) for leg in layout.legs] == [
        ("N", 1, 0, "ramp"), ("S", 0, 1, "ramp"),
    ]  # fmt: skip
    assert {road for road, _ in ways.values()} == {"N"}


def test_who_merges_from_a_ramp_has_the_road_to_merge_into() -> None:
    text = (
        "V1 was on the entrance ramp, merging onto the interstate heading east. V2 was eastbound on the interstate. "
        "The left side of V1 struck the right side of V2."
    )
    assert {leg.kind for leg in drawn(text)[0].legs} == {"road", "ramp"}
