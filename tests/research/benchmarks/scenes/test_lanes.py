"""The table of lanes counts who drives out of them untold, told lanes, lane changes and turns, and names the wrong."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from research.benchmarks.scenes import lanes
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

LANE_M = 3.5
TEXT = "V1 was traveling north in the left lane. V2 was stopped ahead. The front of V1 struck the back of V2."
SPEC = road_spec(RoadLayout(legs=tuple(
    Leg.model_validate({"bearing": b, "lanes_in": 2, "lanes_out": 2}) for b in "SN")))  # fmt: skip
NET = compile_network(plain_xml(SPEC), SPEC).net_xml


def write_case(root: Path, name: str, x_m: float, maneuver: str = "straight", verdict: str = "whole") -> None:
    """V1 drives north for 5 s, x_m east of the middle of a road with two lanes each way, and meets nobody."""
    case = root / "template" / name
    case.mkdir(parents=True)
    rows = [f"{0.05 * k:.2f},V1,{x_m},{-150 + 0.75 * k:.2f},{np.pi / 2:.6f},15.0" for k in range(100)]
    (case / "trajectories.csv").write_text("\n".join(["t_s,actor,x_m,y_m,heading_rad,speed_mps", *rows]) + "\n")
    (case / "report.txt").write_text(TEXT)
    (case / "road.net.xml").write_text(NET or "")
    actor = {"id": "V1", "type": "car", "length_m": 4.7, "width_m": 1.8, "maneuver": maneuver}
    (case / "result.json").write_text(json.dumps({"actors": [actor], "account": {"verdict": verdict}}))


def test_who_is_in_the_told_lane_counts_for_all(tmp_path: Path) -> None:
    write_case(tmp_path, "right", 0.5 * LANE_M)
    assert lanes.table(tmp_path, []).splitlines()[-1] == (
        "| template | 1 | 1 | 0 | 0.0 % | 0 | 1 of 1 | 0 of 0 | 0 of 0 | 0 of 0 |"
    )


def test_each_wrong_vehicle_is_counted_and_named(tmp_path: Path) -> None:
    write_case(tmp_path, "a", -0.5 * LANE_M, "lane_change_left")
    write_case(tmp_path, "b", 1.5 * LANE_M, verdict="lacking")
    text = lanes.table(tmp_path, ["template"], cases=True)
    assert "| template | 2 | 2 | 1 | 50.0 % | 1 | 0 of 2 | 0 of 0 | 1 of 1 | 0 of 0 |" in text
    assert "place: a V1 (lane_change_left, whole): 5.0 s on the wrong side of the road before its contact" in text
    assert "told lane: b V1 (straight): the left lane is told, it is first in S_0, last in S_0" in text


def test_a_folder_that_is_missing_is_named(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="no such folder"):
        lanes.main([str(tmp_path / "runs")])
