"""Our own OpenSCENARIO player: scenario files to trajectories of box centers.

Plays inline entities; teleports to world, road, lane and relative positions; speed, lane-change and
trajectory actions; time, state, speed and distance conditions. All else raises InvalidOutput naming
element and line. The clock counts steps (t = k dt), so that nothing drifts. Knows no simulator.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from sgcad_core.formats.openscenario.actions import global_action, private_action
from sgcad_core.formats.openscenario.motion import EPSILON, MAX_S, Body, BoxShape
from sgcad_core.formats.openscenario.read import Node, read_root
from sgcad_core.formats.openscenario.roads import XodrRoads
from sgcad_core.formats.openscenario.scene import Scene
from sgcad_core.formats.openscenario.story import Storyboard
from sgcad_core.records import Floats, Trajectory

DT_S = 0.05
MAX_ENTITIES = 200
_KINDS = ("Vehicle", "Pedestrian", "MiscObject")


@lru_cache(maxsize=8)
def play(xosc: str, xodr: str | None = None, dt_s: float = DT_S) -> tuple[Trajectory, ...]:
    """Trajectories of all entities in file order, from t = 0 to the end of the scenario.

    It ends when its stop trigger fires or, without one, when all of its stories are complete. Speeds
    of timed trajectories are those of their segments, never negative; headings are continuous. The last few
    files are remembered (validators and simulators play the same one), so the arrays are read-only. Raises
    InvalidOutput.
    """
    root = read_root(xosc)
    bodies = {name: Body(name, box) for name, box in _boxes(root).items()}
    scene = Scene(dt_s, bodies, None if xodr is None else XodrRoads(xodr))
    board = root.need("Storyboard")
    _initialize(board.need("Init"), scene)
    rows = _run(Storyboard(board, scene), scene, board)
    played = {name: np.array(rows[name]) for name in scene.bodies}
    return tuple(_trajectory(name, dt_s, poses) for name, poses in played.items())


def entity_boxes(xosc: str) -> Mapping[str, BoxShape]:
    """Bounding boxes by entity name, in file order. Raises InvalidOutput."""
    return _boxes(read_root(xosc))


def _boxes(root: Node) -> dict[str, BoxShape]:
    holder = root.need("Entities")
    objects = holder.children("ScenarioObject")
    if other := next((c for c in holder.children() if c.tag != "ScenarioObject"), None):
        raise other.unsupported()
    if not 1 <= len(objects) <= MAX_ENTITIES:
        raise holder.fault(f"needs 1 to {MAX_ENTITIES} scenario objects", str(len(objects)))
    boxes: dict[str, BoxShape] = {}
    for node in objects:
        if (name := node.text("name")) in boxes:
            raise node.fault("two entities have this name", name, "rename one")
        boxes[name] = _box(node)
    return boxes


def _box(node: Node) -> BoxShape:
    entity = next(iter(node.children(*_KINDS)), None)
    if entity is None:
        raise node.unsupported("needs an inline <Vehicle>, <Pedestrian> or <MiscObject>")
    entity = entity.scoped()
    box = entity.need("BoundingBox")
    size, center = box.need("Dimensions"), box.need("Center")
    ahead = center.number("x") - _rear_axle_m(entity)
    return BoxShape(size.positive("length"), size.positive("width"), ahead, center.number("y"))


def _rear_axle_m(entity: Node) -> float:
    """Where a vehicle's rear axle stands in its own coordinates: 0, since it is their origin.

    A file that says otherwise contradicts itself; like other players this one believes that poses are the rear
    axle's, and moves box and front axle along. 0 for entities without axles.
    """
    axles = entity.find("Axles")
    rear = axles.find("RearAxle") if axles else None
    return rear.number("positionX") if rear else 0.0


def _initialize(node: Node, scene: Scene) -> None:
    """Run the Init actions: all teleports that others may refer to come first, in file order."""
    actions = node.need("Actions")
    for child in actions.children():
        if child.tag == "GlobalAction":
            global_action(child)
        elif child.tag != "Private":
            raise child.unsupported()
    begins = [
        (action.only().tag != "TeleportAction", private_action(action), private.text("entityRef"), private)
        for private in actions.children("Private")
        for action in private.children("PrivateAction")
    ]
    for _, begin, name, private in sorted(begins, key=lambda b: b[0]):
        scene.body(name, private)
        begin(scene, name)
    for name, body in scene.bodies.items():
        if body.pose is None:
            raise node.fault("entity has no initial place", name, "add a <TeleportAction> for it to <Init>")


def _run(story: Storyboard, scene: Scene, blame: Node) -> dict[str, list[tuple[float, ...]]]:
    """Rows of x, y, heading and speed of every body at every step."""
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in scene.bodies}
    for step in range(int(MAX_S / scene.dt_s) + 1):
        scene.step = step
        if step:
            for body in scene.bodies.values():
                body.advance(step, scene.dt_s, scene.course_from)
        end_s = story.step(scene)
        if end_s is None or scene.t_s <= end_s + EPSILON:
            for name, body in scene.bodies.items():
                rows[name].append((*body.center(), body.center_speed(step)))
        if end_s is not None:
            break
    else:
        raise blame.fault(f"does not end within {MAX_S:g} s", remedy="add a <StopTrigger>")
    if len(next(iter(rows.values()))) < 2:
        raise blame.fault("ends as soon as it begins", remedy="let the <StopTrigger> wait longer")
    return rows


def _trajectory(name: str, dt_s: float, rows: Floats) -> Trajectory:
    heading = np.unwrap(rows[:, 2])
    t_s = np.arange(len(rows)) * dt_s
    for values in (rows, heading, t_s):
        values.setflags(write=False)
    return Trajectory(actor=name, t_s=t_s, x_m=rows[:, 0], y_m=rows[:, 1], heading_rad=heading, speed_mps=rows[:, 3])
