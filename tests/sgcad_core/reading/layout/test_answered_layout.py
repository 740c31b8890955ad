"""What is taken of an answered layout, and what stays as the text has it."""

from dataclasses import replace

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.records.specs import Leg, RoadLayout

FACTS = read(
    "The crash occurred at a four-leg intersection. V1 was northbound on a four-lane, two-way road. V2 was eastbound "
    "on a two-lane, two-way road. The front of V1 struck the left side of V2."
).roads


def answer(*bearings: str, **fields: object) -> RoadLayout:
    given = {"lanes_in": 3, "lanes_out": 1, "turns_in": ("right", "through", "left"), "curve": "left"} | fields
    return RoadLayout(legs=tuple(Leg(bearing=b, **given) for b in bearings))  # type: ignore[arg-type]


def laid(layout: RoadLayout, *taken: str) -> dict[str, Leg]:
    facts: RoadFacts = replace(FACTS, answered=layout, taken=frozenset(taken))
    return {leg.bearing: leg for leg in layout_of_facts(facts).legs}


OURS = {leg.bearing: leg for leg in layout_of_facts(FACTS).legs}


def test_without_anything_taken_the_text_stands() -> None:
    assert laid(answer("N", "S", "E", "W")) == OURS


def test_lanes_come_with_their_uses_and_one_road_at_a_time() -> None:
    found = laid(answer("N", "S", "E", "W"), "lanes.E")
    assert (found["E"].lanes_in, found["E"].turns_in) == (3, ("right", "through", "left"))
    assert (found["N"], found["S"]) == (OURS["N"], OURS["S"])
    assert found["E"].curve == OURS["E"].curve


def test_turns_are_taken_where_there_are_as_many_lanes() -> None:
    assert laid(answer("N", "S", "E", "W"), "turns.N") == OURS, "three uses do not fit two lanes"
    two = answer("N", "S", "E", "W", lanes_in=2, turns_in=("through", "left"))
    assert laid(two, "turns.N")["N"].turns_in == ("through", "left")


def test_other_legs_keep_what_the_text_tells_of_those_that_both_have() -> None:
    found = laid(answer("N", "S", "NE"), "legs", "lanes.NE")
    assert set(found) == {"N", "S", "NE"}
    assert found["N"].lanes_in == OURS["N"].lanes_in
    assert found["NE"].lanes_in == 3


def test_a_bend_is_taken_alone() -> None:
    found = laid(answer("N", "S", "E", "W"), "curve.N")
    assert (found["N"].curve, found["N"].lanes_in) == ("left", OURS["N"].lanes_in)
