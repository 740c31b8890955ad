"""Facts that one word tells: the side a lane is counted from, a stop before a start, where a backing vehicle "
"comes from."""

from __future__ import annotations

import pytest

from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.behavior.exit_assignment import assign
from sgcad_core.reading.behavior.lane_choice import lane_of
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.roads.layout import road_spec

STRUCK = " The front of V2 struck the rear of V1."


@pytest.mark.parametrize(
    ("told", "lane"),
    [
        ("V1 was northbound on a four-lane one-way street, in the second lane from the left.", 3),
        ("V1 was northbound on a four-lane one-way street, in the second from the left lane.", 3),
        ("V1 was northbound on a four-lane one-way street, in the third lane from the left.", 2),
        ("V1 was northbound on a four-lane one-way street, in the third lane from the right.", 3),
        ("V1 was northbound on a four-lane one-way street, in the second from the right lane.", 2),
        ("V1 was northbound on a four-lane one-way street, in the third lane.", 3),
    ],
)
def test_a_lane_is_counted_from_the_side_that_is_told(told: str, lane: int) -> None:
    facts = read(told + STRUCK).roads
    spec = road_spec(layout_of_facts(facts))
    placed = assign(facts.crash, spec)
    assert lane_of(facts.crash.vehicles[0], placed, facts.crash) == lane


@pytest.mark.parametrize(
    "told",
    [
        "V2 was northbound at 35 mph, stopped at the stop sign, then pulled out into the path of V1.",
        "V2 was traveling north at 40 mph and stopped for the stop sign. V2 then proceeded into the intersection.",
        "V2, northbound at 35 mph, came to a stop at the sign, waited, and started across the road.",
    ],
)
def test_who_pulled_out_from_a_stop_does_not_cross_at_the_speed_of_its_approach(told: str) -> None:
    facts = read(f"V1 was eastbound at 45 mph. {told} The front of V1 struck the left side of V2.").roads
    behavior = behavior_of_facts(facts.crash, road_spec(layout_of_facts(facts)))
    speeds = {actor.id: actor.speed_mph for actor in behavior.actors}
    assert speeds["V1"] == 45
    assert speeds["V2"] is None
    assert facts.crash.driven["V2"].from_rest  # the planner lets it start at its line


def test_a_speed_that_is_told_behind_the_stop_is_kept() -> None:
    facts = read(
        "V1 was eastbound. V2, northbound, stopped at the stop sign. V2 then accelerated to 25 mph. The front of V1 "
        "struck the left side of V2."
    ).crash
    assert facts.vehicles[1].speed_mph == 25


@pytest.mark.parametrize(
    ("told", "headings"),
    [
        ("V1 was traveling north. V2 was backing out of a driveway on the right. The rear of V2 struck the "
         "right side of "
         "V1.", "E"),
        ("V1 was traveling north. V2 backed out of a private driveway and its rear hit the left side of V1.", "W"),
        ("V1 was southbound. V2 was reversing from a driveway on the east side when the front of V1 struck its left "
         "side.", "E"),
        ("V1 was traveling east when V2 backed out of a driveway. The front of V1 struck the left side of V2.", "N"),
    ],
)  # fmt: skip
def test_who_backs_out_of_a_driveway_comes_across_the_road(told: str, headings: str) -> None:
    vehicle = read(told).crash.vehicles[1]
    assert (vehicle.maneuver, vehicle.origin, vehicle.heading) == ("backing", "driveway", headings)


@pytest.mark.parametrize(
    "told",
    [
        "The Acme AV was traveling north when a pedestrian stepped off the sidewalk in front of it and the "
        "front of the "
        "Acme AV struck the pedestrian.",
        "The Acme AV was northbound. A pedestrian ran into the street and was struck by the front of the Acme AV.",
        "A jogger stepped off the curb. The front of the Acme AV, which was traveling north, hit the jogger.",
    ],
)
def test_who_steps_off_the_sidewalk_is_met_from_the_side(told: str) -> None:
    facts = read(told).crash
    contact = facts.contacts[0]
    assert (contact.striker, contact.struck, contact.striker_area) == ("V1", "P1", "front")
    assert contact.struck_area in ("left", "right")


@pytest.mark.parametrize(
    ("told", "pair"),
    [
        ("V1 was eastbound when a pedestrian stepped off the curb in front of V1 and was struck by the front of V1.",
         ("V1", "P1")),
        ("V1 was eastbound. A cyclist came out of an alley and was then hit by V1.", ("V1", "B1")),
    ],
)  # fmt: skip
def test_who_did_something_and_was_struck_is_struck(told: str, pair: tuple[str, str]) -> None:
    contact = read(told).crash.contacts[0]
    assert (contact.striker, contact.struck) == pair


@pytest.mark.parametrize(
    ("told", "kind", "area"),
    [
        (
            "V1 was traveling north. V1 drifted to the right and its front struck the rear of a parked car.",
            "car",
            "back",
        ),
        ("V1 was traveling north and struck the left side of a legally parked pickup truck.", "pickup", "left"),
        ("V1, northbound, left its lane and ran into an unoccupied van.", "van", "back"),
    ],
)
def test_a_parked_vehicle_without_a_number_is_an_actor_of_its_own(told: str, kind: str, area: str) -> None:
    facts = read(told).crash
    assert facts.gap is None
    assert [(v.id, v.kind, v.maneuver) for v in facts.vehicles][1] == ("O1", kind, "parked")
    assert (facts.contacts[0].striker, facts.contacts[0].struck, facts.contacts[0].struck_area) == ("V1", "O1", area)


@pytest.mark.parametrize(
    "told",
    [
        "V1 struck V2, a parked 2002 Ford Taurus, in the rear.",
        "V1 struck a parked car (V2) in the rear.",
        "V1, northbound, passed a parked car and the front of V1 struck the rear of V2.",
    ],
)
def test_a_parked_vehicle_that_has_a_number_or_is_not_hit_gets_none(told: str) -> None:
    assert [v.id for v in read(told).crash.vehicles] == ["V1", "V2"]


def test_beside_a_parked_vehicle_the_other_of_two_is_the_numbered_one() -> None:
    facts = read(
        "V1 was northbound and V2 was southbound. V2 crossed the centerline and sideswiped the other vehicle. "
        "V1 then hit "
        "a parked pickup truck. The parked pickup truck was pushed onto the sidewalk."
    ).crash
    assert [(c.striker, c.struck) for c in facts.contacts] == [("V2", "V1"), ("V1", "O1")]


STAND_BESIDE = [
    ("As the Acme AV passed a truck parked at the curb, a van entered the road and the front of the van made "
     "contact with "
     "the right side of the Acme AV.", "V1", "straight"),
    ("The Acme AV maneuvered around a bus stopped in the lane and turned left. The front of a van struck the "
     "right side of "
     "the Acme AV.", "V1", "turn_left"),
    ("The Acme AV was parked at the curb when an SUV parallel parking in front of the Acme AV reversed, and the "
     "rear of the "
     "SUV made contact with the front of the Acme AV.", "V2", "backing"),
    ("The Acme AV was stopped. A van to its right began to reverse. The rear of the van made contact with the "
     "right side of "
     "the Acme AV.", "V2", "backing"),
    ("The Acme AV was turning left. A van in the adjacent right lane, proceeded straight and the front of the van made "
     "contact with the left side of the Acme AV.", "V2", "straight"),
    ("A flatbed pickup truck that was stopped in a driveway reversed out of it, and the rear of the flatbed "
     "made contact with "
     "the left side of the parked Acme AV.", "V2", "backing"),
    ("The Acme AV was driving with vehicles parked at the curb. The front of a van hit the rear of the Acme AV.", "V1",
     "straight"),
]  # fmt: skip


@pytest.mark.parametrize(("told", "who", "maneuver"), STAND_BESIDE)
def test_what_is_said_of_somebody_beside_is_not_the_subjects(told: str, who: str, maneuver: str) -> None:
    vehicle = read(told).crash.vehicle(who)
    assert vehicle is not None
    assert vehicle.maneuver == maneuver


DONE_AND_MEANT = [
    ("The Acme AV made a right turn onto Oak. It was traveling in the right lane when a van entered from a "
     "driveway and the "
     "front of the van struck the right side of the Acme AV.", "V1", "straight"),
    ("The Acme AV initiated the right turn and then came to a stop. It then began to proceed forward, and the "
     "front of a van "
     "struck the rear of the Acme AV.", "V1", "turn_right"),
    ("The Acme AV was waiting to proceed straight. A van struck the rear of the Acme AV.", "V1", "stopped"),
    ("The Acme AV waited for the traffic in its lane to begin to move. A van that had been stopped behind it "
     "struck its "
     "rear.", "V1", "stopped"),
    ("The Acme AV proceeded a short distance before stopping again to yield. A van struck the rear of the Acme "
     "AV.", "V1",
     "stopped"),
    ("The Acme AV was parallel parked along the curb when the front of a van struck the rear of the Acme AV.", "V1",
     "parked"),
    ("The Acme AV had pulled over for a passenger. The front of a van struck the rear of the Acme "
     "AV.", "V1", "stopped"),
    ("A van pulled out of its parked position and the front of the van struck the left side of the Acme AV, which was "
     "traveling north.", "V2", "straight"),
]  # fmt: skip


@pytest.mark.parametrize(("told", "who", "maneuver"), DONE_AND_MEANT)
def test_what_was_over_or_only_waited_for_is_no_maneuver(told: str, who: str, maneuver: str) -> None:
    facts = read(told).crash
    vehicle = facts.vehicle(who) or next(v for v in facts.vehicles if v.id != "V1")
    assert vehicle.maneuver == maneuver


def test_a_summary_says_nothing_of_when() -> None:
    reading = read(
        "The Acme AV was in a collision involving a van. The Acme AV was stopped facing south while yielding. The van "
        "approached."
    )
    assert reading.crash.vehicles[0].maneuver == "stopped"
    assert reading.crash.vehicles[0].heading == "S"


def test_a_yield_sign_stands_at_a_junction() -> None:
    text = "The AV came to a stop at a yield sign in the right-turn lane, and a sedan behind it rear-ended the AV."
    assert read(text).roads.junction.kind != "none"


def test_what_those_do_to_whom_a_vehicle_yields_is_not_its_own_deed() -> None:
    behind = " A taxi behind the AV did not stop and struck the rear of the AV."
    for waits, maneuver in (
        ("The AV was stopped at the gate, yielding to pedestrians crossing in front of it.", "stopped"),
        ("The AV slowed to yield to a van in the bus lane attempting to merge into its lane.", "slowing"),
        ("The AV began to slow as it came near a queue of traffic that was stopped for a light.", "slowing"),
        ("The AV was traveling north and was slowing to a stop for a red light.", "slowing"),
    ):
        me = read(waits + behind).crash.vehicle("V1")
        assert me is not None
        assert me.maneuver in (maneuver, "straight" if maneuver == "slowing" else maneuver)
