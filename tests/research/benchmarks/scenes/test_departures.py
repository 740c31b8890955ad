"""The table of departures counts who is off the road on the coded side at the first contact, and names the others."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from research.benchmarks.scenes import departures
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

SPEC = road_spec(RoadLayout(legs=tuple(
    Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1}) for b in "SN")))  # fmt: skip
NET = compile_network(plain_xml(SPEC), SPEC).net_xml


def codes(side: str, *more: str, other: str = "tree") -> dict[str, Any]:
    sequence = [f"Roadway departure- {side} side", *more]
    vehicle = {"crash_family": f"departure_{side}", "pre_harmful_sequence": sequence}
    return {"vehicles": [vehicle], "events": [{"other": other}]}


def write_case(root: Path, name: str, to_x_m: float, truth: dict[str, Any], verdict: str = "lacking") -> None:
    """V1 drives north in its lane and drifts to some distance east of the middle of the road, where it stops."""
    case = root / "runs" / "template" / name
    case.mkdir(parents=True)
    x = 1.6 + (to_x_m - 1.6) * np.clip((np.arange(100) - 40) / 50, 0, 1)
    rows = [f"{0.05 * k:.2f},V1,{x[k]:.3f},{-150 + 0.75 * k:.2f},{np.pi / 2:.6f},15.0" for k in range(100)]
    (case / "trajectories.csv").write_text("\n".join(["t_s,actor,x_m,y_m,heading_rad,speed_mps", *rows]) + "\n")
    (case / "road.net.xml").write_text(NET or "")
    actor = {"id": "V1", "type": "car", "length_m": 4.7, "width_m": 1.8, "maneuver": "straight"}
    result = {"status": "generated", "actors": [actor], "account": {"verdict": verdict}}
    (case / "result.json").write_text(json.dumps(result))
    (root / "truth").mkdir(exist_ok=True)
    (root / "truth" / f"{name}.json").write_text(json.dumps(truth))


def test_each_case_off_the_road_on_the_coded_side_counts_for(tmp_path: Path) -> None:
    write_case(tmp_path, "right", 8.0, codes("right"))
    write_case(tmp_path, "left", -8.0, codes("left"))
    last = departures.table(tmp_path / "runs", tmp_path / "truth", []).splitlines()[-1]
    assert last == "| template | 2 | 2 | 2 | 2 | 0 |"


def test_the_wrong_side_and_the_road_count_against_and_are_named(tmp_path: Path) -> None:
    write_case(tmp_path, "a", 8.0, codes("left"))
    write_case(tmp_path, "b", 1.8, codes("right"), verdict="whole")
    text = departures.table(tmp_path / "runs", tmp_path / "truth", ["template"], cases=True)
    assert "| template | 2 | 2 | 1 | 0 | 1 |" in text
    assert "a: right, coded left" in text
    assert "b: on the road, coded right, whole" in text


def test_both_sides_and_living_things_are_left_out() -> None:
    assert departures.coded_side(codes("right")) == "right"
    assert departures.coded_side(codes("right", "Roadway departure- left side")) is None
    assert departures.coded_side(codes("right", other="animal")) is None
    assert departures.coded_side({"vehicles": [{"crash_family": "rear_end"}]}) is None


def test_a_folder_that_is_missing_is_named(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="truth: no such folder"):
        departures.main([str(tmp_path), str(tmp_path / "truth")])
