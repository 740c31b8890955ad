"""Lines that no words tell and that told places and sides imply: to a parked vehicle, over the middle of the road."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.execution.plan_score import ODD_FROM
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.plane import Floats
from sgcad_core.planner import Plan, plan
from sgcad_core.planner.encounter.maneuver_choices import HEAD_ON, PARKED_THERE, UNTOLD
from sgcad_core.planner.lines.departures import side_of
from sgcad_core.planner.lines.turning import WIDE
from sgcad_core.records.specs import Actor, BehaviorSpec, Beside, Contact, RoadLayout
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.layout import road_spec
from tests.sgcad_core.planner.crash_scenes import compile_network, leg, network, plain_xml
from tests.sgcad_core.planner.test_plan_rules import actor, at_contact, contact, track

LANE_M = 3.6


def _street(*beside: Beside, lanes: int = 1) -> LaneGraph:
    """A road from south to north whose middle lies at x = 0."""
    spec = road_spec(RoadLayout(legs=tuple(leg(way, lanes, beside=beside) for way in ("N", "S"))))
    made = compile_network(plain_xml(spec), spec)
    assert made.net_xml is not None, made.log
    return parse_net(made.net_xml)


def _made(graph: LaneGraph, first: dict[str, object], second: dict[str, object], *areas: str) -> Plan:
    base = {"kind": "car", "direction": "forward", "maneuver": "straight"}
    actors = [Actor.model_validate(base | one) for one in (first, second)]
    contact = Contact.model_validate(
        {"striker": "V1", "striker_area": areas[0], "struck": "V2", "struck_area": areas[1]}
    )
    return plan(BehaviorSpec(actors=tuple(actors), contacts=(contact,)), graph)


def _at_contact(made: Plan, name: str) -> Floats:
    assert made.contact is not None
    track = next(t for t in made.trajectories if t.actor == name)
    return np.asarray(track.pose[round(made.contact.t_s / 0.05)])


@settings(max_examples=6, deadline=None)
@given(st.sampled_from([("parking",), ("shoulder",), ("parking", "sidewalk")]), st.sampled_from([None, 25, 45]))
def test_a_parked_vehicle_stands_where_people_park_and_the_other_one_drives_there(
    beside: tuple[Beside, ...], mph: int | None
) -> None:
    made = _made(
        _street(*beside), {"id": "V1", "road": "S", "speed_mph": mph},
        {"id": "V2", "road": "S", "maneuver": "parked"}, "front", "back",
    )  # fmt: skip
    assert made.realised
    assert made.oddity < ODD_FROM
    assert _at_contact(made, "V2")[0] > LANE_M, "the middle of the parked vehicle lies beside its lane"
    assert _at_contact(made, "V1")[0] > 0.75 * LANE_M
    assert any(note.endswith(PARKED_THERE) for note in made.notes)


def test_a_parked_vehicle_for_which_no_place_is_drawn_stands_in_the_lane() -> None:
    made = _made(_street(), {"id": "V1", "road": "S"}, {"id": "V2", "road": "S", "maneuver": "parked"}, "front", "back")
    assert made.realised
    assert _at_contact(made, "V2")[0] < LANE_M


def test_fronts_of_two_that_keep_their_lanes_meet_over_the_middle_and_that_is_an_implied_line() -> None:
    made = _made(network("straight"), {"id": "V1", "road": "S"}, {"id": "V2", "road": "N"}, "front", "front")
    assert made.realised
    assert made.oddity < ODD_FROM
    assert any(note.endswith(HEAD_ON) for note in made.notes)
    assert HEAD_ON not in UNTOLD


def test_one_that_crosses_meets_the_other_in_the_far_lane_where_that_one_drives_as_told() -> None:
    made = _made(
        _street(lanes=2), {"id": "V1", "road": "N", "lane": 2, "maneuver": "crossing_centerline"},
        {"id": "V2", "road": "S", "lane": 1, "speed_mph": 35}, "front", "front",
    )  # fmt: skip
    assert made.realised
    met = _at_contact(made, "V2")
    assert met[0] == pytest.approx(1.5 * LANE_M, abs=0.3)
    track = next(t for t in made.trajectories if t.actor == "V2")
    assert made.contact is not None
    assert track.speed_mps[: round(made.contact.t_s / 0.05)].min() > 14.0, "it neither brakes nor steers"


@pytest.mark.parametrize(("maneuver", "told", "side"), [
    ("departing_road_left", "either", "left"), ("departing_road_left", None, "left"),
    ("departing_road_left", "right", "right"), ("straight", "either", "either"), ("straight", None, None),
])  # fmt: skip
def test_the_side_of_a_departure_is_that_of_the_maneuver_where_no_side_is_told(
    maneuver: str, told: str | None, side: str | None
) -> None:
    assert side_of(maneuver, told) == side  # type: ignore[arg-type]


@pytest.mark.parametrize(("way", "hit"), [("N", "V2 left V1 left"), ("S", "V2 right V1 left")])
def test_a_flank_that_passes_one_that_stands_brushes_it_along_its_flank(way: str, hit: str) -> None:
    behavior = BehaviorSpec(
        actors=(actor("V1", "stopped", "S", "N"), actor("V2", "straight", way, {"N": "S", "S": "N"}[way])),
        contacts=(contact(hit),),
    )
    made = plan(behavior, network("four_leg"))
    one, two = (track(made, who).heading_rad[at_contact(made)] for who in ("V1", "V2"))
    assert made.realised
    assert abs(math.remainder(float(one) - math.pi / 2, math.pi)) < 0.01
    assert abs(math.remainder(float(two) - float(one), math.pi)) < math.radians(16)
    assert not [note for note in made.notes if "askew" in note or "swerves" in note]


@pytest.mark.parametrize(("lanes", "lane"), [(2, 2), (3, 3)])
def test_a_right_turn_that_meets_oncoming_fronts_swings_wide_and_stays_in_its_lane_until_it_turns(lanes, lane):
    spec = road_spec(RoadLayout(legs=(leg("E", lanes), leg("W", lanes), leg("N", 1))))
    graph = parse_net(compile_network(plain_xml(spec), spec).net_xml or "")
    made = _made(
        graph, {"id": "V1", "road": "N", "lane": 1, "maneuver": "turn_right", "exit_road": "W"},
        {"id": "V2", "road": "W", "lane": lane, "exit_road": "E"}, "front", "front",
    )  # fmt: skip
    assert made.realised
    assert made.oddity < ODD_FROM
    assert f"V1 {WIDE}" in made.notes
    car = next(t for t in made.trajectories if t.actor == "V1").pose
    still = np.abs(car[:, 2] - car[0, 2]) < math.radians(3.0)
    assert (np.abs(car[still, 0] - car[0, 0]) < LANE_M / 2).all(), "it leaves its lane before it turns"


def test_a_right_turn_that_meets_a_flank_in_its_lanes_swings_no_wider():
    made = _made(
        network("four_leg"), {"id": "V1", "road": "N", "maneuver": "turn_right", "exit_road": "W"},
        {"id": "V2", "road": "E", "exit_road": "W"}, "left", "front",
    )  # fmt: skip
    assert made.realised
    assert not any(WIDE in note for note in made.notes)
