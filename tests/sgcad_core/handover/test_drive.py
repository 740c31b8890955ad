"""The hand-over: relative triggers keep the conflict, and only until the release."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.driver.script import Script as ReportsDriver
from sgcad_core.case.driver_io import Command, Seat
from sgcad_core.errors import ConfigError, SimulationFailed
from sgcad_core.execution.contact import realised
from sgcad_core.handover.drive import drive, task_of
from sgcad_core.handover.outcome import judge_drive
from sgcad_core.handover.script import staging_for
from sgcad_core.interfaces import Driver
from tests.sgcad_core.handover.scenes import crossing, rear_end, turned


class Told(Driver):
    """Does from a time on what it is told, before it drives as the report's driver."""

    after_s: float = 0.0
    acceleration: float = 0.0
    steering: float | None = None

    def take_over(self, task):
        seat, me = ReportsDriver().take_over(task), self

        class _Seat(Seat):
            def act(self, view):
                onward = seat.act(view)
                return onward if view.t_s < me.after_s else Command(me.acceleration, me.steering)

        return _Seat()


@settings(max_examples=60, deadline=None)
@given(
    own=st.floats(4, 30), other=st.floats(2, 30), factor=st.floats(0.75, 1.3), ego=st.sampled_from(["V1", "V2"]),
    seconds=st.floats(4.2, 8),
)  # fmt: skip
def test_the_reports_driver_meets_the_same_crash_faster_or_slower(own, other, factor, ego, seconds):
    made = crossing(own, other, round(seconds / 0.05) * 0.05)
    driven = drive(staging_for(made, ego), ReportsDriver(), factor=factor)
    assert driven.contact is not None
    assert {driven.contact.actor, driven.contact.other} == {"V1", "V2"}
    first, then = apart(made.trajectories, made.contact_of(ego)), apart(driven.trajectories, driven.contact)
    step = (own + other) * max(factor, 1.0) * 0.05  # samples see a touch up to a step late
    assert np.hypot(*(first - then)) <= step + 0.3
    if max(own, other) * factor < 9:
        assert realised(made.declared, driven.contact)


def apart(tracks, contact):
    """From one to the other at a contact."""
    at = {t.actor: np.array([t.x_m[round(contact.t_s / 0.05)], t.y_m[round(contact.t_s / 0.05)]]) for t in tracks}
    return at["V2"] - at["V1"]


def test_speeds_of_the_others_are_in_proportion_to_the_egos():
    driven = drive(staging_for(crossing(10, 12), "V1"), ReportsDriver(), factor=0.8)
    other = next(t for t in driven.trajectories if t.actor == "V2")
    assert other.speed_mps[20] == pytest.approx(0.8 * 12, rel=0.02)
    assert driven.contact.t_s == pytest.approx(6.0 / 0.8, abs=0.15)


def test_before_the_release_the_others_wait_for_a_slow_ego_and_afterwards_for_nobody():
    early = drive(staging_for(crossing(), "V1"), Told(after_s=0.5, acceleration=-1.0), release_s=2.0)
    waits = np.diff(early.others_s) / 0.05
    assert waits.min() < 0.7
    late = drive(staging_for(crossing(), "V1"), Told(after_s=2.5, acceleration=-1.0), release_s=4.0)
    assert np.diff(late.others_s) == pytest.approx(0.05)


def test_an_ego_that_brakes_behind_the_release_avoids_and_has_it_credited():
    driven = drive(staging_for(crossing(), "V1"), Told(after_s=4.0, acceleration=-6.0))
    result = judge_drive(driven)
    assert (result.outcome, driven.contact) == ("avoided", None)
    assert result.braked_s is not None
    assert result.hardest_mps2 == pytest.approx(6.0)


def test_an_ego_that_never_comes_into_the_conflict_has_lost_it():
    assert judge_drive(drive(staging_for(crossing(), "V1"), Told(acceleration=-8.0))).outcome == "lost"
    assert judge_drive(drive(staging_for(crossing(), "V1"), Told(after_s=0.5, acceleration=-8.0))).outcome == "lost"


def test_braking_too_late_mitigates_and_speeding_up_worsens():
    softer = judge_drive(drive(staging_for(rear_end(), "V1"), Told(after_s=5.2, acceleration=-8.0)))
    assert softer.outcome == "mitigated"
    assert softer.severity.closing_mps < softer.scripted.closing_mps
    assert judge_drive(drive(staging_for(rear_end(), "V1"), Told(after_s=4.0, acceleration=4.0))).outcome == "worse"
    assert judge_drive(drive(staging_for(rear_end(), "V1"), ReportsDriver())).outcome == "unchanged"


def test_who_is_never_touched_goes_on_undisturbed_past_the_place_of_the_contact():
    driven = drive(staging_for(crossing(), "V1"), Told(after_s=4.0, acceleration=-6.0))
    other = next(t for t in driven.trajectories if t.actor == "V2")
    assert other.y_m[-1] > 30
    assert other.speed_mps[-2] == pytest.approx(10, abs=0.1)
    assert other.x_m == pytest.approx(0.0, abs=1e-6)


@settings(max_examples=15, deadline=None)
@given(angle=st.floats(-3.1, 3.1), dx=st.floats(-900, 900), dy=st.floats(-900, 900))
def test_turning_and_moving_the_world_changes_nothing(angle, dx, dy):
    told = Told(after_s=5.2, acceleration=-8.0)
    here, there = (
        judge_drive(drive(staging_for(m, "V1"), told)) for m in (crossing(), turned(crossing(), angle, dx, dy))
    )
    assert here.outcome == there.outcome
    assert here.closest_m == pytest.approx(there.closest_m, abs=1e-3)
    assert here.severity is None or here.severity.closing_mps == pytest.approx(there.severity.closing_mps, abs=1e-3)


def test_the_order_of_the_actors_changes_nothing():
    made = crossing()
    swapped = type(made)(made.case, made.actors[::-1], made.trajectories[::-1], made.graph, made.declared, made.roles)
    told = Told(after_s=5.4, acceleration=-8.0)
    first, second = (judge_drive(drive(staging_for(m, "V1"), told)) for m in (made, swapped))
    assert first == second


def test_steering_is_a_kinematic_bicycles_circle():
    """The rear axle goes in a circle of radius wheelbase / tan(angle), slow enough for friction."""
    made = crossing(own=4.0)
    driven = drive(staging_for(made, "V1"), Told(after_s=0.0, acceleration=0.0, steering=0.2))
    ego = driven.ego
    turned_by = ego.heading_rad[40] - ego.heading_rad[0]
    radius = 0.6 * 4.7 / np.tan(0.2)
    assert turned_by == pytest.approx(40 * 0.05 * 4.0 / radius, rel=1e-6)
    assert driven.steered


def test_friction_bounds_braking_and_bends():
    icy = drive(staging_for(crossing(surface="ice"), "V1"), Told(after_s=4.0, acceleration=-9.0))
    assert icy.accelerations.min() == pytest.approx(-0.1 * 9.81)
    fast = drive(staging_for(crossing(own=30.0), "V1"), Told(after_s=0.0, steering=0.6))
    yaw = np.diff(fast.ego.heading_rad) / 0.05
    assert np.abs(yaw * 30.0).max() <= 0.85 * 9.81 + 1e-6


def test_a_seat_is_left_even_if_its_driver_fails():
    left = []

    class Failing(Driver):
        """Fails at once."""

        def take_over(self, task):
            class _Seat(Seat):
                def act(self, view):
                    raise SimulationFailed("gone")

                def leave(self):
                    left.append(True)

            return _Seat()

    with pytest.raises(SimulationFailed, match="gone"):
        drive(staging_for(crossing(), "V1"), Failing())
    assert left == [True]


def test_only_motor_vehicles_are_handed_over():
    made = rear_end(kinds={"V1": "pedestrian"})
    with pytest.raises(ConfigError, match=r"V1 is a pedestrian, which no driver drives; drivable: V2"):
        staging_for(made, "V1")
    with pytest.raises(ConfigError, match=r"no actor 'V9'; it has V1, V2"):
        staging_for(made, "V9")


def test_a_task_tells_the_way_and_the_grip():
    task = task_of(staging_for(crossing(surface="wet"), "V1"))
    assert task.friction_mps2 == pytest.approx(0.6 * 9.81)
    assert task.way.pose_at(0.0)[:2] == pytest.approx((-63.23, 0.0))
    assert task.gives_way_m is None
