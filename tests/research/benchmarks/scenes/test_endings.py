"""The table of endings counts what is told of them, and what no body does."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from research.benchmarks.scenes import endings
from research.benchmarks.scenes.endings import Ended, Place, faults, told_parts
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.metrics.labels.observed_crash import Crash
from sgcad_core.records.course import CourseTold, RestTold
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

SPEC = road_spec(RoadLayout(legs=tuple(
    Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1}) for b in "SN")))  # fmt: skip
NET = compile_network(plain_xml(SPEC), SPEC).net_xml or ""
HIT = 20


def ending(after: np.ndarray, turned_rad: float = 0.0) -> Ended:
    """A vehicle that drives north at 15 m/s, touches O1 at its 20th sample, and then has `after` m/s at each sample."""
    speed = np.concatenate((np.full(HIT, 15.0), after))
    y = np.concatenate(([0.0], np.cumsum(speed) * 0.05))
    heading = np.full(len(y), math.pi / 2)
    heading[HIT:] += turned_rad * np.linspace(0.0, 1.0, len(y) - HIT)
    return Ended(np.column_stack((np.full(len(y), 1.6), y, heading)), (HIT,), ("O1",))


def braked(mps2: float, steps: int = 200) -> np.ndarray:
    return np.maximum(15.0 - mps2 * 0.05 * np.arange(steps), 0.0)


CRASH = Crash({}, parse_net(NET))
POLE = Place(CRASH, frozenset({"O1"}))


def test_a_body_that_brakes_to_rest_has_no_fault() -> None:
    assert list(faults(ending(braked(5.0), 1.0), POLE)) == []


def test_who_hardly_slows_crawls_unless_it_rolls_over() -> None:
    assert list(faults(ending(braked(1.0, 300)), POLE)) == ["crawls"]
    assert list(faults(ending(braked(1.0, 300)), POLE, rolls=True)) == []
    assert list(faults(ending(braked(1.5, 300)), POLE)) == []
    assert list(faults(ending(braked(1.0, 300)), POLE._replace(least_mps2=0.7))) == []  # on ice


def test_who_stands_at_once_and_unturned_at_a_pole_stops_dead() -> None:
    assert list(faults(ending(np.zeros(100)), POLE)) == ["dead stops"]
    assert list(faults(ending(np.zeros(100)), Place(CRASH, frozenset()))) == []  # a wall
    assert list(faults(ending(np.zeros(100), turned_rad=0.6), POLE)) == []


def test_a_way_that_turns_far_behind_the_contact_bends() -> None:
    angle = np.linspace(0.0, 2.0, 120)
    loop = np.column_stack((8 * np.sin(angle), 8 - 8 * np.cos(angle), angle))
    assert "bends" in faults(Ended(loop, (2,), ("V2",)), POLE)


def test_told_parts_are_held_against_the_last_pose() -> None:
    crash, one = Crash({}, parse_net(NET)), ending(braked(5.0), turned_rad=math.pi / 2)
    told = CourseTold(spin="counterclockwise", spin_deg=90.0, rest=RestTold(270.0, "road", distance_m=22.0))
    assert {seen.part: seen.met for seen in told_parts(one, told, crash)} == dict.fromkeys(
        ("zone and side", "facing", "distance", "spin"), True
    )
    told = CourseTold(spin="clockwise", rest=RestTold(0.0, "off_road", "right", distance_m=60.0))
    assert not any(seen.met for seen in told_parts(one, told, crash))


def test_a_spin_of_the_told_sense_but_half_the_told_angle_is_none() -> None:
    crash, one = Crash({}, parse_net(NET)), ending(braked(5.0), turned_rad=math.pi / 2)
    (seen,) = told_parts(one, CourseTold(spin="counterclockwise", spin_deg=180.0), crash)
    assert not seen.met
    assert "90 degrees counterclockwise, told 180.0" in seen.words


def test_a_table_of_a_runs_folder(tmp_path: Path) -> None:
    case = tmp_path / "template" / "a"
    case.mkdir(parents=True)
    one = ending(np.zeros(60))
    thing = np.tile([1.6, float(one.pose[HIT, 1]) + 2.4, 0.0], (len(one.pose), 1))
    rows = [
        f"{0.05 * k:.2f},{name},{p[0]:.4f},{p[1]:.4f},{p[2]:.6f},0.0"
        for name, poses in (("V1", one.pose), ("O1", thing)) for k, p in enumerate(poses)
    ]  # fmt: skip
    (case / "trajectories.csv").write_text("\n".join(["t_s,actor,x_m,y_m,heading_rad,speed_mps", *rows]) + "\n")
    (case / "road.net.xml").write_text(NET)
    (case / "report.txt").write_text(
        "Vehicle #1 was a 2001 Ford Taurus traveling north. Vehicle #1 struck a pole with its front and came to rest "
        "in the northbound lane facing east."
    )
    actors = [
        {"id": "V1", "type": "car", "length_m": 4.7, "width_m": 1.8, "maneuver": "straight"},
        {"id": "O1", "type": "object", "length_m": 0.3, "width_m": 0.3, "maneuver": "stopped"},
    ]
    (case / "result.json").write_text(json.dumps({"status": "generated", "actors": actors}))
    text = endings.table(tmp_path, [], cases=True)
    assert "| template | 1 | 1 | 1 of 1 | 1 of 1 | 0 of 1 | 0 of 0 | 0 of 0 | 0 | 0 | 1 |" in text
    assert "facing: a V1: off by 90" in text
    assert "dead stops: a V1: O1" in text


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="nowhere: no such folder"):
        endings.main([str(tmp_path / "nowhere")])
