"""Near crashes: nobody touches, the pair comes as near as declared, and somebody does what is told."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.execution.contact import CLEARANCE_TOLERANCE_M, avoided, closest_approach, first_contact
from sgcad_core.metrics.drivability import driving_peaks
from sgcad_core.planner import Plan, plan
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import CLEARANCE_M, Actor, BehaviorSpec, Evasion, NearCrash, size_m
from tests.effort import spread
from tests.sgcad_core.planner.crash_scenes import draw_scene, network
from tests.sgcad_core.planner.test_plan_rules import actor, contact, track

AHEAD = actor("V2", "stopped", "S", lane=1)
BEHIND = actor("V1", "straight", "S", lane=1)
REAR = "V1 front V2 back"
CROSSING = (actor("V1", "straight", "S"), actor("V2", "straight", "E"))


def near(conflict: str, *evasions: tuple[str, str], clearance_m: float | None = None) -> NearCrash:
    told = tuple(Evasion.model_validate({"actor": who, "maneuver": how}) for who, how in evasions)
    return NearCrash(conflict=contact(conflict), evasions=told, clearance_m=clearance_m)


def planned(layout: str, told: NearCrash, *actors: Actor, **more: object) -> tuple[Plan, float]:
    """The plan, and how near the pair comes."""
    behavior = BehaviorSpec.model_validate({"actors": actors, "near_crash": told} | more)
    made = plan(behavior, network(layout))
    sizes = {a.id: size_m(a) for a in actors}
    closest = closest_approach(made.trajectories, sizes, (told.conflict.striker, told.conflict.struck))
    assert closest is not None
    assert first_contact(made.trajectories, sizes) is None
    return made, closest.clearance_m


@pytest.mark.parametrize("clearance_m", [None, 0.2, 1.5])
@pytest.mark.parametrize("how", ["braking", "steering_left", "braking_and_steering_right"])
def test_the_follower_comes_as_near_as_declared(how, clearance_m):
    made, closest = planned("straight_wide", near(REAR, ("V1", how), clearance_m=clearance_m),
                            actor("V1", "straight", "E", lane=1), actor("V2", "stopped", "E", lane=1))  # fmt: skip
    assert closest == pytest.approx(clearance_m or CLEARANCE_M, abs=0.03)
    assert any(note.startswith("V1 ") and "before the conflict" in note for note in made.notes)


def test_who_brakes_slows_down_and_keeps_its_line():
    made, _ = planned("straight", near(REAR, ("V1", "braking")), BEHIND, AHEAD)
    mine = track(made, "V1")
    assert mine.speed_mps[0] > 8.0
    assert mine.speed_mps[-1] < 0.1
    assert np.ptp(mine.x_m) < 0.1
    assert (np.diff(mine.speed_mps) / 0.05).min() > -0.85 * 9.81


@pytest.mark.parametrize(("how", "sign"), [("steering_left", 1.0), ("steering_right", -1.0)])
def test_who_steers_goes_to_the_told_side_and_does_not_brake(how, sign):
    made, _ = planned("straight_wide", near(REAR, ("V1", how)),
                      actor("V1", "straight", "E", lane=1), actor("V2", "stopped", "E", lane=1))  # fmt: skip
    mine = track(made, "V1")
    aside = -sign * (mine.y_m - mine.y_m[0])  # "E" forward runs west: left is south
    assert aside.max() > 1.5
    assert abs(aside[-1]) < 0.3, "it does not come back into its lane"
    assert mine.speed_mps[-1] > 0.8 * mine.speed_mps[0]


def test_who_follows_a_moving_one_goes_on_behind_it():
    made, closest = planned("straight", near(REAR, ("V1", "braking")),
                            BEHIND, actor("V2", "straight", "S", lane=1, speed_mph=15))  # fmt: skip
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    assert 1.0 < track(made, "V1").speed_mps[-1] < track(made, "V2").speed_mps[-1]


def test_who_slows_comes_to_a_stop_and_so_does_who_brakes_behind_it():
    made, closest = planned("straight", near(REAR, ("V1", "braking")),
                            BEHIND, actor("V2", "slowing", "S", lane=1))  # fmt: skip
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    for name in ("V1", "V2"):
        speed = track(made, name).speed_mps
        assert speed[0] > 5.0
        assert speed[-1] < 0.1


def test_the_struck_one_may_evade():
    made, closest = planned("four_leg", near("V1 front V2 left", ("V2", "accelerating")), *CROSSING)
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    assert track(made, "V2").speed_mps.max() > 1.05 * track(made, "V2").speed_mps[0]


def test_where_nobody_evades_one_comes_too_late_to_touch():
    made, closest = planned("four_leg", near("V1 front V2 left"), *CROSSING)
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    assert any(note.startswith("nobody evades") for note in made.notes)
    for name in ("V1", "V2"):
        speed = track(made, name).speed_mps
        assert speed.min() > 0.6 * speed.max()


def test_both_may_evade_at_once():
    made, closest = planned("straight_wide", near("V1 right V2 left", ("V1", "steering_left"), ("V2", "braking")),
                            actor("V1", "lane_change_right", "E", lane=2), actor("V2", "straight", "E", lane=1),
                            )  # fmt: skip
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    assert {note[:2] for note in made.notes if "before the conflict" in note} == {"V1", "V2"}


def test_an_evasion_that_cannot_help_is_replaced_and_noted():
    made, closest = planned("straight", near(REAR, ("V1", "accelerating")), BEHIND, AHEAD)
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    assert "V1 evades otherwise than told" in made.notes


def test_on_ice_one_brakes_earlier_and_more_gently():
    made, closest = planned("straight", near(REAR, ("V1", "braking")), BEHIND.model_copy(update={"speed_mph": 15}),
                            AHEAD, surface="snow")  # fmt: skip
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    assert (np.diff(track(made, "V1").speed_mps) / 0.05).min() > -0.2 * 9.81


def test_two_that_never_meet_are_noted():
    told = near("V1 front V2 front", ("V1", "braking"))
    behavior = BehaviorSpec(actors=(BEHIND, actor("V2", "parked", "N", direction="backward")), near_crash=told)
    made = plan(behavior, network("straight"))
    assert made.contact is None
    assert made.notes


def test_others_keep_out_of_it():
    *_, third = actors = BEHIND, AHEAD, actor("V3", "straight", "N")
    made, closest = planned("straight", near(REAR, ("V1", "braking")), *actors)
    assert closest == pytest.approx(CLEARANCE_M, abs=0.03)
    assert track(made, third.id).speed_mps.max() > 1.0


@pytest.mark.parametrize("seed", spread(range(24), 3))
def test_drawn_conflicts_are_parted_within_the_limits_of_driving(seed):
    _, layout, crash = draw_scene(seed)
    first = crash.contacts[0]
    evasion = Evasion(actor=first.striker, maneuver=("braking", "braking_and_steering", "none")[seed % 3])
    told = NearCrash(conflict=first, evasions=(evasion,), clearance_m=(None, 0.3, 1.0)[seed // 3 % 3])
    behavior = crash.model_copy(update={"contacts": (), "near_crash": told})
    made = plan(behavior, network(layout))
    sizes = {a.id: size_m(a) for a in behavior.actors}
    closest = closest_approach(made.trajectories, sizes, (first.striker, first.struck))
    assert avoided(told, first_contact(made.trajectories, sizes), closest), (closest, CLEARANCE_TOLERANCE_M)
    for a in behavior.actors:
        if a.record.wheeled:
            seen = driving_peaks(track(made, a.id), sizes[a.id][0], backing=a.maneuver == "backing")
            assert not seen.excesses(behavior.surface)


def test_who_cannot_come_near_from_rest_is_driving_and_a_note_says_so():
    told = near(REAR)
    behavior = BehaviorSpec(actors=(BEHIND, actor("V2", "slowing", "S", lane=1)), near_crash=told)
    made = plan(behavior, network("straight"), courses={"V1": CourseTold(from_rest=True)})
    sizes = {a.id: size_m(a) for a in behavior.actors}
    closest = closest_approach(made.trajectories, sizes, ("V1", "V2"))
    assert avoided(told, first_contact(made.trajectories, sizes), closest)
    assert "V1 is not seen starting from rest" in made.notes


@pytest.mark.parametrize(("maneuver", "lane", "beside", "back", "sign"), [
    ("lane_change_left", 1, 2, "steering_right", 1.0), ("lane_change_right", 2, 1, "steering_left", -1.0),
])  # fmt: skip
def test_who_steers_back_from_a_lane_change_ends_in_its_first_lane(maneuver, lane, beside, back, sign):
    side = "V1 left V2 right" if sign > 0 else "V1 right V2 left"
    pair = actor("V1", maneuver, "E", lane=lane), actor("V2", "straight", "E", lane=beside)
    made, closest = planned("straight_wide", near(side, ("V1", back)), *pair)
    mine = track(made, "V1")
    left_m = -(mine.y_m - mine.y_m[0])  # the road heads west: south is on the left
    assert closest == pytest.approx(CLEARANCE_M, abs=0.05)
    assert 0.5 < (sign * left_m).max() < 3.0
    assert abs(left_m[-1]) < 0.3


def test_who_crosses_the_middle_before_an_oncoming_one_comes_back_where_no_evasion_is_told():
    pair = actor("V1", "crossing_centerline", "S"), actor("V2", "straight", "N")
    made, closest = planned("straight", near("V1 front V2 front"), *pair)
    mine = track(made, "V1")
    assert closest == pytest.approx(CLEARANCE_M, abs=0.05)
    assert "V1 steers back, though nobody says so" in made.notes
    assert (mine.x_m[0] - mine.x_m).max() > 1.5
    assert abs(mine.x_m[-1] - mine.x_m[0]) < 0.5
    assert mine.speed_mps[-1] > 8.0
