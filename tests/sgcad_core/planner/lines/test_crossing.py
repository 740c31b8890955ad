"""Steep changes of line by which an end meets a flank."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.execution.plan_score import ODD_FROM
from sgcad_core.planner import Plan, plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from sgcad_core.roads.lane_graph import LaneGraph
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_departures import roads


def _made(layout: str | LaneGraph, first: dict[str, object], second: dict[str, object], areas: tuple[str, str]) -> Plan:
    graph = network(layout) if isinstance(layout, str) else layout
    base = {"kind": "car", "direction": "forward", "maneuver": "straight"}
    actors = [Actor.model_validate(base | one) for one in (first, second)]
    contact = Contact.model_validate(
        {"striker": "V1", "striker_area": areas[0], "struck": "V2", "struck_area": areas[1]}
    )
    return plan(BehaviorSpec(actors=tuple(actors), contacts=(contact,)), graph)


def _turned_deg(made: Plan, name: str) -> float:
    """Largest turn against its first heading up to the contact."""
    track = next(t for t in made.trajectories if t.actor == name)
    assert made.contact is not None
    heading = np.unwrap(track.heading_rad[: round(made.contact.t_s / 0.05) + 1])
    return math.degrees(float(np.abs(heading - heading[0]).max()))


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(st.sampled_from([None, 25, 35, 45]), st.sampled_from([None, 30, 40]))
def test_a_front_that_crosses_the_centerline_meets_a_flank_and_only_it_turns(
    own_mph: int | None, other_mph: int | None
) -> None:
    made = _made(
        "straight",
        {"id": "V1", "road": "N", "maneuver": "crossing_centerline", "speed_mph": own_mph},
        {"id": "V2", "road": "S", "speed_mph": other_mph},
        ("front", "left"),
    )
    assert made.realised
    assert made.oddity < ODD_FROM
    assert _turned_deg(made, "V2") < 15.0 < _turned_deg(made, "V1")


@pytest.mark.parametrize(("maneuver", "lanes", "areas"), [
    ("lane_change_right", (2, 1), ("front", "left")), ("lane_change_left", (1, 2), ("front", "right")),
])  # fmt: skip
def test_one_that_stands_is_met_where_it_stands(maneuver: str, lanes: tuple[int, int], areas: tuple[str, str]) -> None:
    made = _made(
        "straight_wide",
        {"id": "V1", "road": "E", "lane": lanes[0], "maneuver": maneuver},
        {"id": "V2", "road": "E", "lane": lanes[1], "maneuver": "stopped"},
        areas,
    )
    assert made.realised
    standing = next(t for t in made.trajectories if t.actor == "V2")
    assert abs(math.degrees(standing.heading_rad[0]) % 180) == pytest.approx(0, abs=1) or abs(
        math.degrees(standing.heading_rad[0]) % 180
    ) == pytest.approx(180, abs=1)
    assert made.oddity < ODD_FROM


@pytest.mark.parametrize("kind", ["car", "bus"])
def test_a_rear_that_is_brushed_by_one_that_swings_out_stands_slightly_askew_at_most(kind: str) -> None:
    made = _made(
        "straight_wide",
        {"id": "V1", "road": "E", "lane": 1, "kind": kind, "maneuver": "overtaking"},
        {"id": "V2", "road": "E", "lane": 1, "maneuver": "stopped"},
        ("right", "back"),
    )
    assert made.realised
    standing = next(t for t in made.trajectories if t.actor == "V2")
    off = math.remainder(float(standing.heading_rad[0]), math.pi)
    assert abs(math.degrees(off)) < 25.0
    assert _turned_deg(made, "V1") > 5.0
    assert made.oddity < ODD_FROM


def test_one_that_comes_back_behind_one_that_it_passed_the_other_way_is_not_odd() -> None:
    made = _made(
        "straight", {"id": "V1", "road": "N"}, {"id": "V2", "road": "S", "maneuver": "stopped"}, ("left", "back")
    )
    assert made.realised
    assert made.oddity < ODD_FROM


@pytest.mark.parametrize(("hand", "sign"), [("left", 1.0), ("right", -1.0)])
def test_one_that_is_told_to_stand_over_a_line_stands_over_it(hand: str, sign: float) -> None:
    lane = 1 if hand == "left" else 2
    base = {"kind": "car", "direction": "forward", "road": "E", "lane": lane}
    actors = [
        Actor.model_validate(base | {"id": "V1", "maneuver": "straight"}),
        Actor.model_validate(base | {"id": "V2", "maneuver": "stopped"}),
    ]
    contact = Contact.model_validate({"striker": "V1", "striker_area": "front", "struck": "V2", "struck_area": "back"})
    behavior = BehaviorSpec(actors=tuple(actors), contacts=(contact,))
    places = []
    for told in ({}, {"V2": CourseTold(straddles=hand)}):  # type: ignore[arg-type]
        made = plan(behavior, network("straight_wide"), courses=told)
        assert made.realised
        places.append(next(t for t in made.trajectories if t.actor == "V2"))
    way = float(places[0].heading_rad[0])
    left = -math.sin(way) * (places[1].x_m[0] - places[0].x_m[0]) + math.cos(way) * (
        places[1].y_m[0] - places[0].y_m[0]
    )
    assert 0.9 < sign * left < 2.3


def test_a_lane_that_is_left_though_nobody_tells_it_is_noted() -> None:
    made = _made(
        "straight_wide",
        {"id": "V1", "road": "E", "lane": 1},
        {"id": "V2", "road": "E", "lane": 2, "maneuver": "stopped"},
        ("front", "right"),
    )
    assert made.realised
    assert any("leaves its lane" in note for note in made.notes)
    assert made.oddity < ODD_FROM


def test_a_way_into_oncoming_traffic_that_nobody_tells_is_odd() -> None:
    made = _made("straight", {"id": "V1", "road": "N"}, {"id": "V2", "road": "S"}, ("front", "left"))
    assert made.realised
    assert made.oddity >= ODD_FROM


@pytest.mark.parametrize("area", ["back", "front"])
def test_a_thing_turns_its_front_to_the_end_that_comes(area: str) -> None:
    driven = "backing" if area == "back" else "straight"
    made = _made(
        "straight",
        {"id": "V1", "road": "N", "maneuver": driven},
        {"id": "V2", "road": "N", "kind": "object", "maneuver": "stopped"},
        (area, "front"),
    )
    assert made.realised


@pytest.mark.parametrize("mph", [None, 25, 40])
def test_a_parked_vehicle_stays_in_its_row_where_a_front_meets_its_flank(mph: int | None) -> None:
    made = _made(
        roads(beside=("parking",)),
        {"id": "V1", "road": "N", "speed_mph": mph},
        {"id": "V2", "road": "N", "maneuver": "parked"},
        ("front", "left"),
    )
    parked = next(t for t in made.trajectories if t.actor == "V2")
    along = math.remainder(float(parked.heading_rad[0]) + math.pi / 2, 2 * math.pi)
    assert made.realised
    assert abs(math.degrees(along)) < 20.0 < _turned_deg(made, "V1")
