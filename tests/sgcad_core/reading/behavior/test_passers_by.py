"""Traffic that is yielded to passes on its own way; what is waited for ahead does not."""

from __future__ import annotations

import pytest

from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.behavior.passers_by import with_parked_rows, with_passers_by
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.roads.layout import road_spec

_STRUCK = "A taxi traveling behind the van contacted the rear of the van."


def joined(text: str) -> list[tuple[str, str, str | None]]:
    """(kind, road, exit) of those who join in."""
    reading = read(text)
    spec = road_spec(layout_of_facts(reading.roads))
    behavior = behavior_of_facts(reading.crash, spec)
    found = with_passers_by(behavior, reading, spec)
    return [(a.kind, a.road, a.exit_road) for a in found.actors[len(behavior.actors) :]]


@pytest.mark.parametrize(("told", "expected"), [
    ("The van was northbound, stopped at a stop sign at the intersection to yield to westbound traffic.",
     [("car", "E", "W")]),
    ("The van was northbound, stopped at a red light at the intersection to yield to traffic traveling east.",
     [("car", "W", "E")]),
    ("The van was northbound at the intersection and stopped to yield to oncoming traffic before a left turn.",
     [("car", "N", "S")]),
    ("The van was northbound, stopped at a stop sign at the intersection and waited for cross-traffic.",
     [("car", "W", "E")]),
    ("The van was northbound, stopped at a stop sign at the intersection to yield to northbound traffic.", []),
    ("The van was northbound and stopped at a stop sign at the intersection.", []),
])  # fmt: skip
def test_who_is_yielded_to_passes(told: str, expected: list[tuple[str, str, str | None]]) -> None:
    assert joined(f"{told} {_STRUCK}") == expected


def test_the_other_one_of_the_crash_is_there_already() -> None:
    text = (
        "The van was northbound at the intersection and stopped to yield to oncoming traffic. A taxi that was "
        "southbound turned left and contacted the front of the van."
    )
    assert joined(text) == []


@pytest.mark.parametrize(("words", "sides"), [
    ("vehicles parked on both sides", ["own", "own", "against", "against"]),
    ("parked cars along the right side", ["own", "own"]),
    ("a parking lot on the right side", []),
])  # fmt: skip
def test_rows_of_parked_vehicles_stand_on_their_sides(words: str, sides: list[str]) -> None:
    text = f"The AV was northbound on Elm Street, a street with {words}, and stopped. A van rear-ended the AV."
    reading = read(text)
    spec = road_spec(layout_of_facts(reading.roads))
    behavior = behavior_of_facts(reading.crash, spec)
    parked = [a for a in with_parked_rows(behavior, reading, spec).actors if a.maneuver == "parked"]
    ways = {(behavior.actors[0].road, behavior.actors[0].direction): "own"}
    assert [ways.get((a.road, a.direction), "against") for a in parked] == sides


@pytest.mark.parametrize(("thing", "flat"), [("manhole cover", True), ("speed bump", True), ("tree", False)])
def test_what_lies_in_the_road_is_driven_over(thing: str, flat: bool) -> None:
    reading = read(f"The AV was northbound on Elm Street and made contact with a {thing}.")
    behavior = behavior_of_facts(reading.crash, road_spec(layout_of_facts(reading.roads)))
    assert next(a for a in behavior.actors if a.id == "O1").flat is flat
