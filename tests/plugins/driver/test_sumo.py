"""SUMO in the ego's seat: it follows, gives way, drives on where nobody is, and may die without harm."""

import os
import signal

import numpy as np
import pytest

from plugins.driver.sumo import Sumo, _worker
from sgcad_core.case.driver_io import Task, View, Way
from sgcad_core.errors import SimulationFailed
from tests.plugins.driver.seats import user
from tests.sgcad_core.formats.xosc_samples import crossroads

RIGHT_LANE_Y = -4.8  # eastbound, the lane at the edge of two


def eastbound(speed=12.0, y=RIGHT_LANE_Y, start=-100.0):
    t = np.arange(0.0, 15.0, 0.05)
    x = start + t * speed
    way = Way(t, np.column_stack((x, 0 * t + y, 0 * t)), t * speed, np.full(len(t), speed))
    return Task(user("V1", x=start, y=y, speed=speed), way, 8.34, 25.0, None, crossroads().net_xml, "made")


def ride(say, task, others_at, seconds):
    """Rows of time, x and speed of the ego on its way."""
    seat, x, speed, rows = say.take_over(task), task.ego.x_m, task.ego.speed_mps, []
    for k in range(round(seconds / 0.05)):
        t, start = k * 0.05, task.ego.x_m
        at = View(
            t, task.ego._replace(x_m=x, speed_mps=speed), x - start, (x - start) / task.ego.speed_mps, others_at(t)
        )
        rows.append((t, x, speed))
        after = max(speed + seat.act(at).acceleration_mps2 * 0.05, 0.0)
        x, speed = x + (speed + after) / 2 * 0.05, after
    seat.leave()
    return np.array(rows)


@pytest.mark.parametrize("model", ["IDM", "Krauss"])
def test_alone_it_keeps_the_report_drivers_speed(model):
    rows = ride(Sumo(model=model), eastbound(start=15.0), lambda t: (), 8.0)
    np.testing.assert_allclose(rows[:, 2], 12.0, atol=0.1)


@pytest.mark.parametrize("model", ["IDM", "Krauss"])
def test_it_stops_behind_a_standing_car(model):
    rows = ride(Sumo(model=model, gap_m=2.5), eastbound(), lambda t: (user(x=-30.0, y=RIGHT_LANE_Y),), 14.0)
    gap = -30.0 - 4.7 - rows[-1, 1]
    assert rows[-1, 2] < 0.3
    assert 1.5 < gap < 5.0


def test_it_sees_a_car_that_stands_across_its_lane():
    rows = ride(Sumo(), eastbound(), lambda t: (user(x=-30.0, y=RIGHT_LANE_Y, course=np.pi / 2),), 14.0)
    assert rows[-1, 2] < 0.3
    assert rows[-1, 1] < -30.0 - (4.7 + 1.8) / 2


def test_who_stands_beside_the_road_is_passed():
    waiting = user("P1", x=60.0, y=-11.0, kind="pedestrian", length=0.5, width=0.6)
    rows = ride(Sumo(), eastbound(start=15.0), lambda t: (waiting,), 8.0)
    np.testing.assert_allclose(rows[:, 2], 12.0, atol=0.1)


def test_it_lets_one_from_the_right_pass_at_equal_roads_and_goes_on():
    """Four legs without signs: SUMO gives the right of way to the right."""

    def northbound(t):
        return (user(x=4.8, y=-72.0 + 9.0 * t, speed=9.0, course=np.pi / 2),)

    rows = ride(Sumo(), eastbound(9.0, start=-80.0), northbound, 14.0)
    together = np.hypot(rows[:, 1] - 4.8, RIGHT_LANE_Y - (-72.0 + 9.0 * rows[:, 0]))
    assert together.min() > 4.0
    assert rows[:, 2].min() < 6.0
    assert rows[-1, 2] > 8.0


def test_behind_the_end_of_the_roads_it_drives_on():
    rows = ride(Sumo(), eastbound(20.0, start=60.0), lambda t: (), 6.0)
    assert rows[-1, 1] > 170
    np.testing.assert_allclose(rows[:, 2], 20.0, atol=0.2)


def test_a_way_on_no_lane_is_refused_with_a_remedy():
    with pytest.raises(SimulationFailed, match=r"SUMO drives on lanes, .* take another driver"):
        Sumo().take_over(eastbound(y=-60.0))


def test_a_killed_sumo_fails_one_drive_and_not_the_next():
    seat, task = Sumo().take_over(eastbound()), eastbound()
    os.kill(_worker()._process.popen.pid, signal.SIGKILL)
    with pytest.raises(SimulationFailed, match="died of SIGKILL"):
        seat.act(View(0.0, task.ego, 0.0, 0.0, ()))
    seat.leave()
    assert len(ride(Sumo(), task, lambda t: (), 1.0)) == 20
