"""Who is told ahead and touches nobody joins the behavior; who is told elsewhere does not."""

from __future__ import annotations

import pytest

from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.behavior.company import with_company
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.roads.layout import road_spec

BEHIND = "The front of V2, traveling behind V1, contacted the rear of V1."


def joined(text):
    """(id, kind, maneuver) of those who join in, and the actor ahead of whom."""
    reading = read(text)
    behavior = behavior_of_facts(reading.crash, road_spec(layout_of_facts(reading.roads)))
    found = with_company(behavior, reading)
    assert found.actors[: len(behavior.actors)] == behavior.actors
    return [(a.id, a.kind, a.maneuver) for a in found.actors[len(behavior.actors) :]], found


@pytest.mark.parametrize(("text", "expected"), [
    ("V1 was traveling north and slowed to a stop for a queue of traffic.",
     [("N1", "car", "stopped"), ("N2", "car", "stopped")]),
    ("V1 was traveling north and was stopped behind a school bus.", [("N1", "bus", "stopped")]),
    ("V1 was traveling north and slowed for another vehicle.", [("N1", "car", "stopped")]),
    ("V1 was traveling north and stopped for a pedestrian.", [("P1", "pedestrian", "straight")]),
    ("V1 was northbound, stopped behind a school bus in the northbound lane of the same road.",
     [("N1", "bus", "stopped")]),
    ("V1 was traveling north and braked to avoid stopped traffic.",
     [("N1", "car", "stopped"), ("N2", "car", "stopped")]),
    ("V1 was traveling north and swerved to avoid a deer.", [("A1", "pedestrian", "straight")]),
    ("V1 was traveling north. An animal ran into the road in front of V1.", [("A1", "pedestrian", "straight")]),
    ("V1 was traveling north and steered right to avoid a stopped truck.", [("N1", "truck", "stopped")]),
    ("V1 was traveling north and steered right to avoid an oncoming vehicle.", []),
    ("V1 was traveling north and slowed for a stack of stopped vehicles ahead.",
     [("N1", "car", "stopped"), ("N2", "car", "stopped")]),
    ("V1 was traveling north and braked for the traffic ahead.", [("N1", "car", "stopped"), ("N2", "car", "stopped")]),
    ("V1 was northbound, stopped in traffic in the left lane.",
     [("N1", "car", "stopped"), ("N2", "car", "stopped")]),
    ("V1 was traveling north and slowed.", []),
    ("V1 was traveling north and swerved to avoid stopped traffic.", []),
    ("V1 was traveling north past a queue of traffic and slowed.", []),
    ("V1 was traveling north and slowed. A line of vehicles stood in the left lane.", []),
    ("V1 was traveling north and slowed for an oncoming vehicle.", []),
])  # fmt: skip
def test_who_is_told_ahead_joins(text, expected):
    assert joined(f"{text} V2 was traveling north. {BEHIND}")[0] == expected


def test_a_pedestrian_who_is_yielded_to_is_no_vehicle_ahead():
    text = "The AV was northbound on Elm Street and yielded to a pedestrian in the crosswalk when a van rear-ended it."
    assert [(kind, maneuver) for _, kind, maneuver in joined(text)[0]] == [("pedestrian", "straight")]


def test_they_stand_in_the_lane_of_the_one_that_waits():
    found = joined(
        f"V1 was traveling north in lane two of three and slowed for stopped traffic. V2 was north. {BEHIND}"
    )[1]
    first, ahead = found.actors[0], found.actors[2:]
    assert {(a.road, a.direction, a.lane, a.exit_road) for a in ahead} == {
        (first.road, first.direction, first.lane, first.exit_road)
    }


def test_the_first_of_a_row_waits_for_one_without_a_number():
    text = f"V3, V1 and V2 were northbound. V3 slowed for another vehicle. {BEHIND} V1 struck the rear of V3."
    assert joined(text)[0] == [("N1", "car", "stopped")]


def test_a_queue_of_numbered_vehicles_is_not_drawn_twice():
    text = (
        f"V3, V1 and V2 were traveling north. V3 was ahead in stopped traffic. {BEHIND} V1 then struck the rear of V3."
    )
    assert joined(text)[0] == []


def test_one_that_leaves_the_road_to_avoid_an_animal_has_it_ahead_in_its_lane():
    text = "V1 was traveling north and swerved to avoid a deer. V1 departed the road to the right and struck a tree."
    (animal,), found = joined(text)
    assert animal == ("A1", "pedestrian", "straight")
    assert (found.actors[-1].road, found.actors[-1].direction) == (found.actors[0].road, found.actors[0].direction)


def test_an_animal_that_is_struck_is_not_drawn_twice():
    assert joined("V1 was traveling north when a deer ran into the road. The front of V1 struck the deer.")[0] == []


FROM_BEHIND = "The following vehicle nearly hits the subject vehicle in the rear."


@pytest.mark.parametrize(("text", "expected"), [
    ("Subject slows behind the lead vehicle, which slows.", [("V3", "car", "slowing")]),
    ("Subject slows because the lead truck is stopped.", [("V3", "truck", "stopped")]),
    ("Subject slows down for a light.", []),
])  # fmt: skip
def test_the_one_ahead_joins_where_the_subject_is_met_from_behind(text, expected):
    assert joined(f"{text} {FROM_BEHIND}")[0] == expected


def test_the_one_ahead_has_a_number_of_its_own_in_the_sentences():
    reading = read(f"Subject slows behind the lead vehicle. {FROM_BEHIND}")
    assert [reading.named_in(sentence) for sentence in reading.sentences] == [{"V1", "V3"}, {"V1", "V2"}]
