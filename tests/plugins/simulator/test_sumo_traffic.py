"""SUMO's drivers among the actors of a crash: they stop behind what stands in their lane, on every lane it reaches."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest

from plugins.simulator.kinematic import Kinematic
from plugins.simulator.libsumo import LibSumo, _worker
from sgcad_core.case.traffic import Entrant, Fixture, TrafficOrder
from sgcad_core.errors import ConfigError, SimulationFailed
from tests.sgcad_core.formats.xosc_samples import crossroads

ROWS = 300


def entrant(name, lane, at_m=20.0, depart_s=0.0):
    return Entrant(name, "car", 4.7, 1.8, ("S", "-N"), lane, at_m, depart_s)


def standing(x, y, heading, length=4.7, width=1.8):
    return Fixture("V1", length, width, np.tile([x, y, heading, 0.0], (ROWS, 1)))


def driven(fixture, *entrants, seed=1):
    order = TrafficOrder(crossroads().net_xml, (fixture,), entrants, {}, seed)
    return {one.id: one for one in LibSumo().drive_traffic(order)}


def test_a_wreck_across_two_lanes_stops_both():
    made = driven(standing(3.5, -50.0, 0.1, length=6.0), entrant("right", 0), entrant("left", 1))
    for one in made.values():
        assert one.poses[-1, 3] < 0.1
        assert -70.0 < one.poses[-1, 1] < -50.0


def test_a_wreck_off_the_lanes_stops_nobody():
    made = driven(standing(40.0, -50.0, 0.1), entrant("right", 0), entrant("left", 1))
    assert all(one.poses[:, 1].max() > 80.0 for one in made.values())


def test_traffic_follows_an_actor_at_its_speed():
    y = -95.0 + np.arange(ROWS) * 0.05 * 5.0
    slow = Fixture("V1", 4.7, 1.8, np.column_stack((np.full(ROWS, 1.6), y, np.full(ROWS, np.pi / 2), np.full(ROWS, 5))))
    (one,) = driven(slow, entrant("behind", 1, at_m=8.0)).values()
    rows = slice(one.first, one.first + len(one.poses))
    gap = y[rows] - one.poses[:, 1] - 4.7
    assert gap.min() > 0.5
    assert abs(one.poses[150, 3] - 5.0) < 1.5


def test_a_vehicle_comes_in_when_it_departs_and_in_equal_seeds_equally():
    made = driven(standing(40.0, 40.0, 0.0), entrant("late", 0, at_m=5.0, depart_s=3.0))
    again = driven(standing(40.0, 40.0, 0.0), entrant("late", 0, at_m=5.0, depart_s=3.0))
    assert made["late"].first == 60
    assert np.array_equal(made["late"].poses, again["late"].poses)


def test_a_vehicle_without_room_is_left_out():
    assert driven(standing(5.4, -100.0, np.pi / 2), entrant("inside", 0, at_m=20.0)) == {}


def test_a_route_that_is_none_is_told_with_sumos_words():
    order = TrafficOrder(crossroads().net_xml, (standing(0, 0, 0),), (entrant("x", 0)._replace(route=("Q",)),), {}, 1)
    with pytest.raises(SimulationFailed, match="SUMO cannot drive the traffic"):
        LibSumo().drive_traffic(order)


def _again_and_again(many):
    for seed in range(50):
        driven(standing(40.0, 40.0, 0.0), *many, seed=seed)


def test_the_death_of_its_process_is_an_error_and_the_next_call_works():
    worker = _worker("drive_traffic", "_sumo_traffic")
    driven(standing(40.0, 40.0, 0.0), entrant("a", 0))
    pid = worker._process.popen.pid
    killer = threading.Thread(target=lambda: (time.sleep(0.05), os.kill(pid, signal.SIGKILL)))
    many = [entrant(f"v{k}", k % 2, depart_s=k * 0.5) for k in range(60)]
    killer.start()
    with pytest.raises(SimulationFailed, match="SIGKILL"):
        _again_and_again(many)
    killer.join()
    assert driven(standing(40.0, 40.0, 0.0), entrant("a", 0))


def test_a_simulator_without_drivers_says_so():
    assert not Kinematic().drives_traffic
    assert LibSumo().drives_traffic
    with pytest.raises(ConfigError, match="simulator Kinematic drives no traffic: take libsumo, or traffic: none"):
        Kinematic().drive_traffic(TrafficOrder("", (), (), {}, 1))
