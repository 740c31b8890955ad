"""A settled scene is looked up where nothing has changed, and settled anew where anything has."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.planner.aftermath.impact import Impact
from sgcad_core.planner.lines.path import Path
from sgcad_core.planner.motion import Motion, stand
from sgcad_core.planner.scene import Scene

CAR = (4.7, 1.8)


def scene() -> Scene:
    """Two standing cars that lie 2 m apart, and nobody who touches them."""
    made = Scene(60, 20)
    for name, x in (("V1", 0.0), ("V2", 6.7)):
        path = Path(np.array([[x, 0.0], [x + 0.01, 0.0]]), np.array([0.0, 0.01]), np.zeros(2))
        motion = Motion(path, *stand(path, 0.0), CAR, np.zeros(2), -math.inf, standing=True, fixed=False)
        made.add(name, "car", motion, 0.0, brakes=False)
    return made


def counted(made: Scene, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """As many entries as there are simulations."""
    runs, wreck = list[int](), Scene.wreck
    monkeypatch.setattr(Scene, "wreck", lambda self: runs.append(1) or wreck(self))
    made.settle()
    return runs


def test_a_scene_that_did_not_change_is_simulated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made = scene()
    runs = counted(made, monkeypatch)
    first = made.tracks["V1"].poses.copy()
    made.tracks["V1"].poses, made.touches = first + 1.0, []
    made.settle()
    assert len(runs) == 1
    assert np.array_equal(made.tracks["V1"].poses, first)


@pytest.mark.parametrize(
    "change",
    [
        lambda s: setattr(s, "impact", Impact(friction=0.2)),
        lambda s: setattr(s, "surface", "ice"),
        lambda s: setattr(s.tracks["V1"], "mass", 900.0),
        lambda s: s.hitches.append(("V1", "V2", 3.0)),
        lambda s: s.tracks.pop("V2"),
    ],
)
def test_whatever_changes_the_way_to_rest_is_simulated_anew(change, monkeypatch: pytest.MonkeyPatch) -> None:
    made = scene()
    runs = counted(made, monkeypatch)
    change(made)
    made.settle()
    assert len(runs) == 2
