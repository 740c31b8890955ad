"""The table of motions counts what is over a limit, once a vehicle, and names it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from research.benchmarks.run_tables import by_config
from research.benchmarks.scenes import motion
from research.benchmarks.scenes.motion import Figures, count, table

TEXT = (
    "V1 was traveling north at 20 mph. V2 was traveling north. The front of V1 struck the back of V2. It was dry and "
    "daylight."
)


def write_case(root: Path, name: str, *, speed: float = 20 * 0.44704, spin: float = 0.0, ends_m: float = 24.0) -> None:
    """V1 drives up to V2, which stands with its back at 26.36 m; `spin`: V1's box is turned for half a second."""
    case = root / "template" / name
    case.mkdir(parents=True)
    t = 0.05 * np.arange(100)
    y = np.minimum(speed * t, ends_m)
    rows = ["t_s,actor,x_m,y_m,heading_rad,speed_mps"]
    for i, at in enumerate(t):
        turned = np.pi / 2 + (spin if 10 < i < 20 else 0.0)
        rows.append(f"{at:.2f},V1,0,{y[i]:.4f},{turned:.5f},{speed if y[i] < 20 else 0.0:.3f}")
        rows.append(f"{at:.2f},V2,0,28.71,1.5708,0.0")
    (case / "trajectories.csv").write_text("\n".join(rows) + "\n")
    (case / "report.txt").write_text(TEXT)
    actors = [{"id": v, "type": "car", "length_m": 4.7, "width_m": 1.8, "maneuver": "straight"} for v in ("V1", "V2")]
    collision = {"declared": {"striker": "V1"}, "realised": True}
    (case / "result.json").write_text(json.dumps({"actors": actors, "collision": collision}))


def test_a_calm_case_counts_nothing(tmp_path: Path) -> None:
    write_case(tmp_path, "calm")
    f = by_config(tmp_path, ["template"], Figures, count)["template"]
    assert (f.cases, f.moving, f.realised, f.declared) == (1, 1, 1, 1)
    assert (f.lateral, f.yaw, f.slip, f.rest, f.deep, f.unrested) == (0,) * 6
    assert (f.reached, f.stated) == (1, 1)
    assert f.lines == []


def test_each_fault_is_counted_once_and_named(tmp_path: Path) -> None:
    write_case(tmp_path, "a", spin=0.5)
    write_case(tmp_path, "b", ends_m=27.0)
    write_case(tmp_path, "c", speed=12.0)
    f = by_config(tmp_path, ["template"], Figures, count)["template"]
    assert (f.yaw, f.slip, f.lateral) == (1, 1, 0)
    assert (f.rest, f.deep) == (1, 1)
    assert (f.reached, f.stated) == (2, 3)
    text = table(tmp_path, ["template"], cases=True)
    assert "template: a V1 (straight): yaw rate 10.0 of 1.5 rad/s; slip angle 61.8 of 10 degrees" in text
    assert "template: b: V1 and V2 overlap by 1.80 m at rest" in text
    assert "template: c V1: told 8.9 m/s, drives up to 12.0" in text


def test_a_case_without_motion_is_a_case(tmp_path: Path) -> None:
    write_case(tmp_path, "calm")
    (tmp_path / "template" / "calm" / "trajectories.csv").unlink()
    f = by_config(tmp_path, ["template"], Figures, count)["template"]
    assert (f.cases, f.moving) == (1, 0)


def test_a_folder_that_is_not_there_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["motion", str(tmp_path / "none")])
    with pytest.raises(SystemExit, match="no such folder"):
        motion.main()
