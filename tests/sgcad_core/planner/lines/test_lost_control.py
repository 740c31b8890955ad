"""A vehicle out of control slides into its contact while it turns as told; one that touches nothing sways and catches
itself, or spins to a stop."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.metrics.drivability import driving_peaks
from sgcad_core.metrics.thresholds import DRIVING
from sgcad_core.planner import plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import BehaviorSpec, Contact
from tests.sgcad_core.planner.crash_scenes import network
from tests.sgcad_core.planner.test_plan_rules import actor, track


def alone(surface=None, **told):
    behavior = BehaviorSpec(actors=(actor("V1", "straight", "S", lane=1),), surface=surface)
    made = plan(behavior, network("straight"), courses={"V1": CourseTold(lost_control=True, **told)}, may_skid=True)
    return track(made, "V1")


@pytest.mark.parametrize("surface", [None, "ice"])
def test_it_sways_to_both_hands_and_is_back_on_its_line(surface):
    mine = alone(surface)
    off = np.degrees(np.unwrap(mine.heading_rad) - mine.heading_rad[0])
    assert off.max() > 8.0
    assert off.min() < -8.0
    assert abs(off[-1]) < 3.0
    assert abs(mine.x_m[-1] - mine.x_m[0]) < 0.3
    assert np.ptp(mine.x_m) > 1.0


@pytest.mark.parametrize(("way", "sign"), [("clockwise", -1.0), ("counterclockwise", 1.0)])
def test_it_spins_as_far_as_told_and_stops(way, sign):
    mine = alone("snow", spin=way, spin_deg=180.0)
    assert sign * np.degrees(np.unwrap(mine.heading_rad)[-1] - mine.heading_rad[0]) == pytest.approx(180.0, abs=30.0)
    assert mine.speed_mps[-1] < 0.3


def test_without_a_loss_of_control_it_keeps_straight_on():
    behavior = BehaviorSpec(actors=(actor("V1", "straight", "S", lane=1),))
    mine = track(plan(behavior, network("straight")), "V1")
    assert np.ptp(mine.x_m) < 0.1


def thrown(yaws, departs, side, surface=None, size=(0.5, 0.5)):
    """(plan, track, sample of the contact) of a vehicle that turns out of control and strikes what stands beside the
    road."""
    thing = actor("O1", "stopped", "S").model_copy(
        update={"kind": "object", "length_m": size[0], "width_m": size[1], "firm": True, "speed_mph": None}
    )
    hits = Contact(striker="V1", struck="O1", striker_area=side, struck_area="front")
    behavior = BehaviorSpec(
        actors=(actor("V1", "straight", "S", "N", lane=1), thing), contacts=(hits,), surface=surface
    )
    told = {"V1": CourseTold(lost_control=True, yaws=yaws, departs=departs)}
    made = plan(behavior, network("straight"), courses=told, may_skid=True)
    assert made.realised
    assert made.contact is not None
    return made, track(made, "V1"), round(made.contact.t_s / 0.05)


def turned_deg(mine, hit):
    """Degrees by which the box has turned against its way, unwrapped, as it comes to the contact."""
    step = np.diff(np.column_stack((mine.x_m, mine.y_m))[: hit + 1], axis=0)
    slip = np.unwrap(np.unwrap(mine.heading_rad)[:hit] - np.unwrap(np.arctan2(step[:, 1], step[:, 0])))
    return math.degrees(slip[-1] - slip[0])


@pytest.mark.parametrize("departs", ["left", "right"])
@pytest.mark.parametrize(("yaws", "side", "low", "high"), [
    ("counterclockwise", "front", 8, 60), ("counterclockwise", "right", 40, 140), ("clockwise", "left", -140, -40),
    ("clockwise", "back", -230, -130),
])  # fmt: skip
def test_it_turns_as_told_until_the_told_side_strikes(departs, yaws, side, low, high):
    _, mine, hit = thrown(yaws, departs, side)
    assert low < turned_deg(mine, hit) < high
    assert mine.x_m[hit] * (1 if departs == "right" else -1) > 3.5, "it is off the road"


@pytest.mark.parametrize("surface", [None, "snow"])
def test_a_slide_keeps_to_friction_and_takes_speed(surface):
    _, mine, hit = thrown("counterclockwise", "right", "right", surface)
    peaks = driving_peaks(mine, 4.7, hit)
    assert peaks.lateral_mps2 <= DRIVING.friction_mps2(surface)
    assert peaks.yaw_radps <= DRIVING.yaw_radps
    slows = -np.diff(mine.speed_mps[:hit]) / 0.05
    assert slows.max() < 1.2 * DRIVING.friction_mps2(surface)
    assert mine.speed_mps[hit - 1] < 0.95 * mine.speed_mps[0]


def test_a_flank_that_slides_backward_meets_a_rail_along_the_road():
    made, mine, hit = thrown("counterclockwise", "left", "right", size=(0.4, 14.0))
    rail = track(made, "O1")
    assert abs(math.cos(rail.heading_rad[0])) > 0.99, "its front faces the road, which runs north"
    assert 130 < turned_deg(mine, hit) < 230


@pytest.mark.parametrize(("yaws", "side"), [("counterclockwise", "right"), ("clockwise", "left")])
def test_what_its_flank_strikes_stops_its_turn(yaws, side):
    _, mine, hit = thrown(yaws, "right", side)
    heading = np.degrees(np.unwrap(mine.heading_rad))
    assert abs(heading[-1] - heading[hit]) < 90.0
