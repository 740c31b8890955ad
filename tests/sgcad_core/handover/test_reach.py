"""What an ego can do within a step: the motion of our own bicycle is always within it, leaps never are."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.case.driver_io import STEP_S, Command, RoadUser, Seat, Way
from sgcad_core.errors import PluginFault, SimulationFailed
from sgcad_core.handover.bicycle import Ego
from sgcad_core.handover.drive import drive, task_of
from sgcad_core.handover.reach import Reach
from sgcad_core.handover.script import staging_for
from sgcad_core.interfaces import Driver
from sgcad_core.kinds import ACTORS
from tests.sgcad_core.handover.scenes import rear_end

T = np.arange(200) * STEP_S
WAY = Way(T, np.column_stack((T * 10, T * 0, T * 0)), T * 10, np.full(200, 10.0))
DRIVEN = sorted(record.id for record in ACTORS.values() if record.driven)


def user(ego, kind, length):
    course = ego.heading_rad
    return RoadUser("V1", kind, length, 1.8, ego.x_m, ego.y_m, ego.heading_rad, ego.speed_mps, course)


@settings(max_examples=150, deadline=None)
@given(
    st.sampled_from(DRIVEN), st.floats(0, 14), st.sampled_from([1.0, 3.0, 6.9]),
    st.lists(st.tuples(st.floats(-20, 3.5), st.floats(-1, 1)), min_size=1, max_size=60),
)  # fmt: skip
def test_whatever_pedals_and_wheel_bring_about_is_within_reach_as_poses(kind, speed, friction, asked):
    """The bicycle that our own drivers move is the measure; places are rounded to millimetres as in files."""
    length = ACTORS[kind].length_m
    ego = Ego(0.0, 0.0, 0.3, speed, 0.0, free=True)
    reach = Reach(user(ego, kind, length), friction)
    for pedal, wheel in asked:
        seen = user(ego, kind, length)
        ego.move(Command(pedal, wheel), WAY, length, friction)
        pose = round(ego.x_m, 3), round(ego.y_m, 3), round(ego.heading_rad, 3), round(ego.speed_mps, 3)
        reach.check(seen, Command(pose=pose))


def at(speed, kind="car", friction=6.9, length=4.7):
    start = RoadUser("V1", kind, length, 1.8, 0.0, 0.0, 0.0, speed, 0.0)
    return Reach(start, friction), start


@pytest.mark.parametrize(
    ("pose", "told"),
    [
        ((500.0, 0.0, 0.0, 10.0), "500 m in a step"),
        ((0.0, 0.0, 0.0, 10.0), "0 m in a step"),
        ((0.5, 0.0, 0.0, 0.0), "from 10 to 0 m/s"),
        ((0.5, 0.0, 0.0, 12.0), "from 10 to 12 m/s"),
        ((0.0, 0.5, 0.0, 10.0), "its velocity changes"),
        ((0.499, 0.06, 0.0, 10.0), "sideways"),
        ((0.5, 0.0, 0.3, 10.0), "a turn by 0.3 rad"),
        ((1e300, 0.0, 0.0, 10.0), "a figure that is none"),
        ((math.nan, 0.0, 0.0, 10.0), "a figure that is none"),
        ((0.5, 0.0, math.inf, 10.0), "a figure that is none"),
    ],
)
def test_a_leap_is_beyond_it(pose, told):
    reach, start = at(10.0)
    with pytest.raises(ValueError, match=told):
        reach.check(start, Command(pose=pose))


@pytest.mark.parametrize("command", [Command(math.nan), Command(1e300), Command(0.0, math.nan), Command(-math.inf)])
def test_pedals_are_numbers(command):
    reach, start = at(10.0)
    with pytest.raises(ValueError, match="a figure that is none"):
        reach.check(start, command)


def _drive(reach, places):
    for here, there in itertools.pairwise(places):
        reach.check(here, Command(pose=(there.x_m, there.y_m, there.heading_rad, 10.0)))


def test_a_slow_drift_aside_is_beyond_it_too():
    """A metre a second to the side, with the nose ahead: no step is far, all of them are no rolling."""
    reach, start = at(10.0)
    places = [start._replace(x_m=0.5 * k, y_m=0.05 * k) for k in range(40)]
    with pytest.raises(ValueError, match="sideways"):
        _drive(reach, places)


def test_bounds_come_from_the_kind():
    """A truck brakes no harder than tires hold; a golf cart has 4 m/s2 and 15 m/s."""
    faster = Command(pose=((10.0 + 0.3 / 2) * STEP_S, 0.0, 0.0, 10.3))
    at(10.0)[0].check(at(10.0)[1], faster)
    reach, start = at(10.0, "golf_cart", length=2.4)
    with pytest.raises(ValueError, match=r"from 10 to 10\.3 m/s"):
        reach.check(start, faster)
    reach, start = at(14.95, "golf_cart", length=2.4)
    with pytest.raises(ValueError, match=r"15\.1 m/s, a golf cart has 15"):
        reach.check(start, Command(pose=(15.0 * STEP_S, 0.0, 0.0, 15.1)))


class Floors(Driver):
    """Gives all it has."""

    def take_over(self, task):
        seat = _Leap(())
        seat.act = lambda view: Command(1e3)
        return seat


def test_pedals_give_what_the_kind_has():
    driven = drive(staging_for(rear_end(own=8.0, other=30.0, kinds={"V1": "golf_cart"}), "V1"), Floors())
    assert np.diff(driven.ego.speed_mps).max() == pytest.approx(4.0 * STEP_S)
    assert driven.ego.speed_mps.max() == pytest.approx(15.0)


class Leaps(Driver):
    """A plugin that puts the ego elsewhere, or says what is no number."""

    command: tuple[float | str | None, ...] = ()

    def take_over(self, task):
        return _Leap(self.command)


class _Leap(Seat):
    def __init__(self, command):
        self._command = command

    def act(self, view):
        e = view.ego
        if len(self._command) == 1:
            return Command(*self._command)
        return Command(pose=(e.x_m, e.y_m + 50.0, e.heading_rad, e.speed_mps))


class Silent(Driver):
    """A plugin whose seat answers nothing."""

    def take_over(self, task):
        seat = _Leap(())
        seat.act = lambda view: None
        return seat


def test_a_seat_that_answers_no_command_is_its_plugins_fault():
    with pytest.raises(PluginFault, match="its seat's act returned NoneType, expected Command"):
        drive(staging_for(rear_end(own=15.0), "V1"), Silent())


@pytest.mark.parametrize("command", [(), (math.nan,), (math.inf,), ("fast",), (None,)])
def test_no_driver_is_credited_for_a_leap(command):
    with pytest.raises(SimulationFailed, match="the driver of V1 asks for"):
        drive(staging_for(rear_end(own=15.0), "V1"), Leaps(command=command))


def test_the_scripts_own_motion_is_within_reach_until_its_contact():
    staging = staging_for(rear_end(own=15.0), "V1")
    task = task_of(staging)
    reach, here = Reach(task.ego, task.friction_mps2), task.ego
    for k in range(1, 100):
        x, y, heading = task.way.pose[k]
        there = here._replace(x_m=float(x), y_m=float(y), heading_rad=float(heading))
        reach.check(here, Command(pose=(there.x_m, there.y_m, there.heading_rad, 15.0)))
        here = there
