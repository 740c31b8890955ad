"""Other readings of a crash: one weak fact away, cheapest first; what is stated stays. All texts are made up."""

from __future__ import annotations

from sgcad_core.reading.inference.hypotheses import ONWARD, hypotheses
from sgcad_core.reading.reading import read

INTRO = "Vehicle #1 was a 2001 Ford Taurus traveling north. Vehicle #2 was a 1999 Honda Civic traveling east. "


def words(text: str) -> list[str]:
    return [one.words for one in hypotheses(read(INTRO + text).crash)]


def test_the_other_side_of_a_corner_comes_first() -> None:
    found = words("The front of Vehicle #1 struck the left front of Vehicle #2.")
    assert found[0] in ("the left of V2 instead of the front", "the front of V2 instead of the left")


def test_stated_sides_stay() -> None:
    found = words("The front of Vehicle #1 struck the left side of Vehicle #2.")
    assert not any("instead" in one or "strikes" in one for one in found)


def test_a_turn_is_given_to_the_other_at_a_price() -> None:
    text = "Vehicle #2 turned left. The front of Vehicle #1 struck the left side of Vehicle #2."
    found = hypotheses(read(INTRO + text).crash)
    turn = next(one for one in found if one.words == "V1 makes the turn, not V2")
    assert {v.id: v.maneuver for v in turn.facts.vehicles} == {"V1": "turn_left", "V2": "straight"}
    assert turn.price == max(one.price for one in found)


def test_a_lone_vehicle_has_no_other_reading() -> None:
    assert hypotheses(read("Vehicle #1 was traveling north and struck a tree with its front.").crash) == []


def test_each_reading_differs_in_one_thing() -> None:
    facts = read(INTRO + "The left front of Vehicle #1 contacted the right rear of Vehicle #2.").crash
    for other in hypotheses(facts):
        changed = sum(a != b for a, b in zip(facts.vehicles, other.facts.vehicles, strict=True))
        assert changed + (facts.contacts != other.facts.contacts) == 1


def test_slowing_gives_way_to_driving_on() -> None:
    found = words("Vehicle #1 slowed for a bus. The front of Vehicle #2 struck the left side of Vehicle #1.")
    assert f"V1 {ONWARD}" in found


def test_a_corner_is_open_only_where_a_report_numbers_nobody() -> None:
    numbered = read(INTRO + "The front of Vehicle #1 struck the left front corner of Vehicle #2.").crash
    assert not any(one.corner for one in hypotheses(numbered))
    text = "The AV was going north. The front of a van going east hit the left front corner of the AV."
    assert any(one.corner for one in hypotheses(read(text).crash))


def test_in_a_near_crash_without_directions_the_second_one_heads_otherwise_first() -> None:
    text = (
        "The subject driver is driving on a two lane road when another vehicle starts to enter the intersection. The "
        "subject driver brakes to avoid hitting the other vehicle."
    )
    found = [one.words for one in hypotheses(read(text).crash)]
    assert found[:3] == ["V2 heads W", "V2 heads E", "V2 heads N"]
    assert not any(one.startswith("V1 heads") for one in found)
