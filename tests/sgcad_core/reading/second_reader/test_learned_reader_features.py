"""Wordings of investigators: one sentence a row, written for the project, then what holds for any shuffle of them."""

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read

SCENE = (
    "V1, a 2002 Ford Taurus, was traveling north on a two-lane road and was approaching an intersection. V2, a 1999 "
    "Honda Civic, was traveling east on the intersecting road. "
)
CONTACTS = (
    ("This caused the front of V1 to contact the left side of V2.", "front", "left"),
    ("This caused the front of V1 to strike the left rear door of V2.", "front", "left"),
    ("V2 received an impact to its left side from the front of V1.", "front", "left"),
    ("V2 sustained a left side impact from the front of V1.", "front", "left"),
    ("The impact was to the front of V1 and the left side of V2.", "front", "left"),
    ("The first impact involved the front of V1 and the left side of V2.", "front", "left"),
    ("The vehicles came together, V1's front to V2's left side.", "front", "left"),
    ("The front of V1 was driven into the left side of V2.", "front", "left"),
    ("V2 was struck by V1, front to left side.", "front", "left"),
    ("V1 collided with V2 front to rear.", "front", "back"),
    ("The leading edge of V1 hit the trailing end of V2.", "front", "back"),
    ("The front of V1 struck V2, which was turning left, in the right side.", "front", "right"),
    ("The left doors of V2 were damaged when V1 contacted it with its front.", "front", "left"),
    ("V1 crossed the centerline and hit V2 head on.", "front", "front"),
)
CONDITIONS = (
    ("It was day time and the road was free of moisture.", ("day", None, "dry")),
    ("It was light out, dry and clear.", ("day", "clear", "dry")),
    ("The weather was good and there was no precipitation.", (None, "clear", None)),
    ("Weather conditions were fair and the road was wet from rain.", (None, "clear", "wet")),
    ("It was just before sunrise and the roadway was covered with ice.", ("dawn", None, "ice")),
    ("The sun was setting and the road had packed snow on it.", ("dusk", None, "snow")),
    ("It was nighttime with street lighting present.", ("dark_lit", None, None)),
    ("It was light rain and the road was wet.", (None, "rain", "wet")),
)
MANEUVERS = (
    ("The driver of V1 believed that there was enough time and turned left.", "turn_left"),
    ("The driver of V1 looked left, saw no traffic and turned right.", "turn_right"),
    ("V1 was executing a left turn.", "turn_left"),
    ("V1 moved from the left lane to the right lane.", "lane_change_right"),
    ("V1 drove off the right road edge.", "departing_road_right"),
    ("V1 steered left and departed the roadway.", "departing_road_left"),
    ("V1 was slowing because traffic had backed up.", "slowing"),
    ("V1 slid across the center line.", "crossing_centerline"),
)


@pytest.mark.parametrize(("told", "front", "side"), CONTACTS)
def test_a_contact_has_many_wordings(told: str, front: str, side: str) -> None:
    first = read(SCENE + told).crash.contacts[0]
    assert {first.striker: first.striker_area, first.struck: first.struck_area} == {"V1": front, "V2": side}
    assert first.stated


def test_an_object_may_be_the_subject_of_the_blow() -> None:
    facts = read("V1 was traveling north and left the road. A large tree was hit by the front end of V1.").crash
    assert [o.word for o in facts.others] == ["tree"]


@pytest.mark.parametrize(("told", "want"), CONDITIONS)
def test_conditions_have_many_wordings(told: str, want: tuple[str | None, str | None, str | None]) -> None:
    facts = read(SCENE + told).crash
    assert (facts.light, facts.weather) == want[:2]
    assert want[2] is None or facts.surface == want[2]


@pytest.mark.parametrize(("told", "want"), MANEUVERS)
def test_a_maneuver_has_many_wordings(told: str, want: str) -> None:
    vehicle = read("V1 was traveling north. V2 was on the same road. " + told).crash.vehicle("V1")
    assert vehicle is not None
    assert vehicle.maneuver == want


def test_lanes_listed_for_both_roads_stay_with_their_legs() -> None:
    facts = read(
        "The crash occurred at the four-leg intersection of a north/south street (two northbound lanes, two southbound "
        "lanes) with a five-lane east/west street (one westbound left-turn lane, one westbound lane, one eastbound "
        "left-turn lane, one eastbound through-lane, one eastbound right-turn lane). V1 was traveling north. V2 was "
        "traveling west."
    ).roads
    lanes = {leg.bearing: (leg.lanes_in, leg.lanes_out) for leg in layout_of_facts(facts).legs}
    assert lanes == {"S": (2, 2), "N": (2, 2), "E": (2, 1), "W": (3, 1)}


def test_lanes_and_a_turn_lane_in_each_direction_are_told_for_both() -> None:
    facts = read(
        "V1 was traveling north on a road with two through lanes and a left turn lane in each direction."
    ).roads
    assert facts.roads[0].lanes.each_way == 2
    assert facts.roads[0].lanes.turns["each"] == ("left",)


_SENTENCES = [row[0] for rows in (CONTACTS, CONDITIONS, MANEUVERS) for row in rows]
_CLAUSES = sorted({part for told in _SENTENCES for part in told.split(" ")} | set(_SENTENCES))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.sampled_from(_CLAUSES), max_size=60))
def test_any_shuffle_of_clauses_is_read_without_a_fault(clauses: list[str]) -> None:
    layout_of_facts(read(SCENE + " ".join(clauses)).roads)


def test_a_long_report_costs_a_fraction_of_a_second() -> None:
    report = SCENE + " ".join(_SENTENCES * 3)
    started = time.process_time()
    read(report)
    assert time.process_time() - started < 5.0


@pytest.mark.parametrize("end", [
    "V2 traveled east and stopped.", "Both vehicles spun and stopped in the road.",
    "V2 was shoved to the northeast and stopped 8 feet away.", "V2 ran into a wall and then stopped.",
    "V2 stopped facing northwest.",
])  # fmt: skip
def test_a_way_that_ends_behind_the_impact_is_no_stop_before_it(end: str) -> None:
    vehicle = read(f"{SCENE}The front of V1 struck the left side of V2. {end}").crash.vehicle("V2")
    assert vehicle is not None
    assert (vehicle.heading, vehicle.maneuver) == ("E", "straight")


@pytest.mark.parametrize(("told", "maneuver"), [
    ("V2 pulled up to the crossing and stopped.", "stopped"), ("V2 stopped, then was crossing.", "straight"),
])  # fmt: skip
def test_a_crossing_that_one_comes_to_is_no_movement(told: str, maneuver: str) -> None:
    facts = read(f"{SCENE}{told} The front of V1 struck the front of V2.").crash
    assert facts.vehicles[1].maneuver == maneuver


def test_a_stop_that_is_told_before_the_impact_stays_one() -> None:
    text = f"{SCENE}V2 came up to a line of cars and stopped. The front of V1 struck the front of V2."
    vehicle = read(text).crash.vehicle("V2")
    assert vehicle is not None
    assert vehicle.maneuver == "stopped"


def test_a_vehicle_that_was_thrown_and_stopped_did_not_stop_before_an_impact_that_nobody_told() -> None:
    facts = read(SCENE + "Both vehicles bounced apart and stopped off the road.").crash
    assert [v.maneuver for v in facts.vehicles] == ["straight", "straight"]
