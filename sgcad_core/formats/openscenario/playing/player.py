"""The OpenSCENARIO player: scenario files to trajectories of box centers.

What it plays, accepts with a note and refuses by name stands in docs/conformance.md. The clock counts steps
(t = k dt), so that nothing drifts. A row tells poses as they are before what is triggered at that step acts, and
speeds as they are from then on. Knows no simulator and no file system.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sgcad_core.case.records import Finding, Floats, Trajectory
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.actions.running import control
from sgcad_core.formats.openscenario.playing.body import Body, place_trailers
from sgcad_core.formats.openscenario.playing.entity import bodies_of, selections_of
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.signal_phases import SignalPlan
from sgcad_core.formats.openscenario.playing.story import Storyboard
from sgcad_core.formats.openscenario.playing.storyboard_init import initialize
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON, MAX_S, BoxShape
from sgcad_core.formats.openscenario.reading.elements import XmlNode, read_root
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads, roads_of

DT_S = 0.05
Rows = dict[str, "array[float]"]
"""Of every body x, y, heading, speed and roll in a row, step by step."""
_NOWHERE = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Played:
    """What was played: trajectories in file order, what each entity is, and what was played otherwise than meant."""

    trajectories: tuple[Trajectory, ...]
    bodies: Mapping[str, Body]
    presence: Mapping[str, tuple[float, float]]
    """From when to when an entity was there, seconds; its rows before and behind repeat the nearest one."""
    notes: tuple[Finding, ...]


@lru_cache(maxsize=8)
def play(xosc: str, xodr: str | None = None, dt_s: float = DT_S) -> tuple[Trajectory, ...]:
    """Trajectories of all entities in file order, from t = 0 to the end of the scenario.

    It ends when its stop trigger fires or, without one, when all of its stories are complete. Speeds
    of timed trajectories are those of their segments, never negative; headings are continuous. The last few
    files are remembered (validators and simulators play the same one), so the arrays are read-only. Raises
    InvalidOutput; Unsupported, which is one, for what the player lacks.
    """
    return play_scenario(read_root(xosc), None if xodr is None else roads_of(xodr), dt_s).trajectories


def play_scenario(
    root: XmlNode, roads: XodrRoads | None, dt_s: float = DT_S, until_s: float | None = None, no_map: str = ""
) -> Played:
    """Play a file that was read. `until_s`: where one that does not end by itself is cut, with a note; `no_map`: why
    there are no roads. Raises InvalidOutput, Unsupported."""
    bodies = bodies_of(root)
    scene = Scene(dt_s, bodies, roads, parameters=dict(root.scope), selections=selections_of(root, bodies))
    scene.no_map = no_map or scene.no_map
    scene.variables = _variables(root)
    signals = SignalPlan(root)
    board = root.need("Storyboard")
    signals.step(scene)
    running = initialize(board, scene)
    story = Storyboard(board, scene, running)
    rows, seen = _run(story, scene, board, signals, until_s)
    story.close()
    played = {name: _filled(np.array(rows[name]).reshape(-1, 5), seen[name]) for name in scene.bodies if seen[name]}
    for name in scene.bodies.keys() - played.keys():
        board.note("entity is never there", name)
    presence = {name: (seen[name][0] * dt_s, seen[name][-1] * dt_s) for name in played}
    trajectories = tuple(_trajectory(name, dt_s, poses) for name, poses in played.items())
    return Played(trajectories, bodies, presence, tuple(root.book.notes))


def entity_boxes(xosc: str) -> Mapping[str, BoxShape]:
    """Bounding boxes by entity name, in file order. Raises InvalidOutput."""
    return {name: body.box for name, body in bodies_of(read_root(xosc)).items()}


def _variables(root: XmlNode) -> dict[str, str]:
    declared = root.find("VariableDeclarations")
    entries = declared.children("VariableDeclaration") if declared else []
    return {entry.text("name"): entry.text("value") for entry in entries}


def _run(
    story: Storyboard, scene: Scene, blame: XmlNode, signals: SignalPlan, until_s: float | None
) -> tuple[Rows, dict[str, array[int]]]:
    """The rows of every body, and the steps at which it is there."""
    rows: Rows = {name: array("d") for name in scene.bodies}
    seen: dict[str, array[int]] = {name: array("l") for name in scene.bodies}
    for step in _steps(scene, blame, signals, until_s):
        scene.step = step
        if step:
            _advance(scene, signals, step)
        poses = _poses(scene)
        end_s = story.step(scene)
        if not step:  # what is triggered at t = 0 is there from the start
            poses = _poses(scene)
        if end_s is None or scene.t_s <= end_s + EPSILON:
            for name, body in scene.bodies.items():
                rows[name].extend((*poses.get(name, _NOWHERE), body.center_speed(step), body.roll_rad))
                if name in poses:
                    seen[name].append(step)
        if end_s is not None:
            break
    if len(next(iter(rows.values()))) < 2 * 5:
        raise blame.fault("ends as soon as it begins", remedy="let the <StopTrigger> wait longer")
    return rows, seen


def _poses(scene: Scene) -> dict[str, Pose]:
    """Box centers of the present entities."""
    return {name: body.center() for name, body in scene.bodies.items() if body.present and body.pose is not None}


def _steps(scene: Scene, blame: XmlNode, signals: SignalPlan, until_s: float | None) -> Iterator[int]:
    """The clock, as long as a scenario may last and as much as it may cost."""
    tests = sum(1 for _ in blame.element.iter("Condition", "Event")) + signals.phases
    for step in range(int((until_s or MAX_S) / scene.dt_s) + 1):
        blame.spend("steps of entities", len(scene.bodies))
        blame.spend("tests of conditions", tests)
        yield step
    if until_s is None:
        raise blame.fault(f"does not end within {MAX_S:g} s", remedy="add a <StopTrigger>")
    blame.note("does not end by itself", f"cut at {until_s:g} s", "add a <StopTrigger>")


def _advance(scene: Scene, signals: SignalPlan, step: int) -> None:
    """Move everything to a step: first what controls bodies, with the clock of the step before."""
    scene.step = step - 1
    control(scene)
    scene.step = step
    signals.step(scene)
    for body in scene.bodies.values():
        if body.tow is None:
            body.advance(step, scene.dt_s, scene.course_for)
    place_trailers(scene.bodies)


def _filled(rows: Floats, seen: array[int]) -> Floats:
    """Rows in which the entity is not there repeat the nearest one in which it is."""
    steps = np.arange(len(rows))
    nearest = np.clip(np.searchsorted(seen, steps, side="right") - 1, 0, len(seen) - 1)
    filled: Floats = rows[np.array(seen)[nearest]]
    return filled


def _trajectory(name: str, dt_s: float, rows: Floats) -> Trajectory:
    heading = np.unwrap(rows[:, 2])
    t_s = np.arange(len(rows)) * dt_s
    for values in (rows, heading, t_s):
        values.setflags(write=False)
    return Trajectory(
        actor=name, t_s=t_s, x_m=rows[:, 0], y_m=rows[:, 1], heading_rad=heading, speed_mps=rows[:, 3],
        roll_rad=rows[:, 4] if rows[:, 4].any() else None,
    )  # fmt: skip
