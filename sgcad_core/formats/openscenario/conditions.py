"""OpenSCENARIO triggers as functions of the scene. Edges and delays are counted in steps of the clock.

Knows no action. What is not supported raises InvalidOutput when it is compiled, not when it is reached.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from sgcad_core.formats.openscenario.motion import EPSILON, Body, Pose
from sgcad_core.formats.openscenario.positions import position
from sgcad_core.formats.openscenario.read import Node
from sgcad_core.formats.openscenario.scene import TRANSITIONS, Scene
from sgcad_core.geometry.distances import box_distance
from sgcad_core.geometry.plane import Box, overlap

Test = Callable[[Scene], bool]
OfEntity = Callable[[Scene, str], bool]
_STATES = ("standbyState", "runningState", "completeState")
_RULES: dict[str, Callable[[float, float], bool]] = {
    "greaterThan": lambda a, b: a > b + EPSILON,
    "greaterOrEqual": lambda a, b: a >= b - EPSILON,
    "lessThan": lambda a, b: a < b - EPSILON,
    "lessOrEqual": lambda a, b: a <= b + EPSILON,
    "equalTo": lambda a, b: abs(a - b) <= EPSILON,
    "notEqualTo": lambda a, b: abs(a - b) > EPSILON,
}
_EDGES: dict[str, Callable[[bool, bool], bool]] = {
    "rising": lambda before, now: now and not before,
    "falling": lambda before, now: before and not now,
    "risingOrFalling": lambda before, now: before is not now,
}


class Trigger:
    """Condition groups, any of which fires when all of its conditions do. `missing`: what no trigger means."""

    def __init__(self, node: Node | None, missing: bool) -> None:
        groups = node.children("ConditionGroup") if node else []
        self._groups = [[_Condition(c) for c in g.children("Condition")] for g in groups]
        self._missing = missing

    def __bool__(self) -> bool:
        """Whether there is any condition at all."""
        return bool(self._groups)

    def fires(self, scene: Scene) -> bool:
        """Evaluate every condition once (their histories need it)."""
        return self.moment(scene) is not None if self._groups else self._missing

    def moment(self, scene: Scene) -> float | None:
        """When it fired, seconds: between steps if it waits for a time only, else now; None if it does not."""
        held = [[c.holds(scene) for c in group] for group in self._groups]  # all of them: edges need every step
        fired = [group for group, holds in zip(self._groups, held, strict=True) if all(holds)]
        return min((max(c.moment(scene) for c in group) for group in fired), default=None)


class _Condition:
    """One condition with its edge, delay and history."""

    def __init__(self, node: Node) -> None:
        self.edge = node.choice("conditionEdge", ("none", *_EDGES), "none")
        self.delay_s = node.number("delay", 0.0)
        if not 0 <= self.delay_s <= 3600:
            raise node.fault("attribute 'delay' must lie within 0 and 3600 s", f"{self.delay_s:g}")
        self.test = _test(node)
        self.time_s = _time_waited_for(node)
        self.before: bool | None = None
        self.fired: list[int] = []

    def moment(self, scene: Scene) -> float:
        """When it began to hold, as exactly as is known."""
        return scene.t_s if self.time_s is None else min(self.time_s + self.delay_s, scene.t_s)

    def holds(self, scene: Scene) -> bool:
        """Evaluate it at this step."""
        now = self.test(scene)
        fires = now if self.edge == "none" else self.before is not None and _EDGES[self.edge](self.before, now)
        self.before = now
        if fires:
            self.fired.append(scene.step)
        due = scene.step - math.ceil(self.delay_s / scene.dt_s - EPSILON)
        self.fired = [step for step in self.fired if step >= due]
        return due in self.fired


def _test(node: Node) -> Test:
    children = node.children("ByValueCondition", "ByEntityCondition")
    if len(children) != 1:
        raise node.fault("needs one <ByValueCondition> or <ByEntityCondition>", str(len(children)))
    if children[0].tag == "ByEntityCondition":
        return _by_entity(children[0])
    condition = children[0].only()
    if condition.tag not in _BY_VALUE:
        raise condition.unsupported()
    return _BY_VALUE[condition.tag](condition)


def _time_waited_for(node: Node) -> float | None:
    for time in (c.find("SimulationTimeCondition") for c in node.children("ByValueCondition")):
        if time and time.text("rule") in ("greaterThan", "greaterOrEqual"):
            return time.number("value")
    return None


def _by_entity(node: Node) -> Test:
    triggering = node.need("TriggeringEntities")
    names = [ref.text("entityRef") for ref in triggering.children("EntityRef")]
    if not names:
        raise triggering.fault("names no entity", remedy="add an <EntityRef>")
    quantifier = any if triggering.choice("triggeringEntitiesRule", ("any", "all")) == "any" else all
    condition = node.need("EntityCondition").only()
    if condition.tag not in _BY_ENTITY:
        raise condition.unsupported()
    test = _BY_ENTITY[condition.tag](condition)

    def tested(scene: Scene) -> bool:
        held = [test(scene, name) for name in names]  # all of them: standing still is timed
        return quantifier(held)

    return tested


def _rule(node: Node) -> Callable[[float], bool]:
    compare, value = _RULES[node.choice("rule", tuple(_RULES))], node.number("value")
    return lambda found: compare(found, value)


# ------------------------------------------------------------------ by value
def _simulation_time(node: Node) -> Test:
    rule = _rule(node)
    return lambda scene: rule(scene.t_s)


def _element_state(node: Node) -> Test:
    kind, ref = node.text("storyboardElementType"), node.text("storyboardElementRef")
    state = node.choice("state", (*_STATES, *TRANSITIONS))

    def test(scene: Scene) -> bool:
        stages = list(scene.named(kind, ref))
        if not stages:
            known = ", ".join(s.path for s in scene.stages if s.kind == kind) or "none"
            raise node.fault(f"no storyboard element of type {kind!r} has this name", ref, f"there are: {known}")
        if state in _STATES:
            return any(s.state == state for s in stages)
        return any(scene.step - s.moments.get(state, -9) <= 1 for s in stages)

    return test


# ------------------------------------------------------------------ by entity
def _travelled(node: Node) -> OfEntity:
    value = node.number("value")
    return lambda scene, name: scene.body(name, node).travelled_m >= value - EPSILON


def _speed(node: Node) -> OfEntity:
    rule = _rule(node)
    return lambda scene, name: rule(scene.body(name, node).speed_mps)


def _relative_speed(node: Node) -> OfEntity:
    rule, other = _rule(node), node.text("entityRef")
    return lambda scene, name: rule(scene.body(name, node).speed_mps - scene.body(other, node).speed_mps)


def _stand_still(node: Node) -> OfEntity:
    duration, since = node.number("duration"), dict[str, int]()

    def test(scene: Scene, name: str) -> bool:
        if abs(scene.body(name, node).speed_mps) > 1e-6:
            since.pop(name, None)
            return False
        return (scene.step - since.setdefault(name, scene.step)) * scene.dt_s >= duration - EPSILON

    return test


def _reach(node: Node) -> OfEntity:
    target, tolerance = position(node.need("Position")), node.number("tolerance")

    def test(scene: Scene, name: str) -> bool:
        there, here = target(scene), scene.pose(name, node)
        return math.hypot(there.x_m - here.x_m, there.y_m - here.y_m) <= tolerance + EPSILON

    return test


def _distance(node: Node) -> OfEntity:
    rule, target = _rule(node), position(node.need("Position"))
    node.choice("coordinateSystem", ("entity",), "entity")
    freespace = node.flag("freespace")

    def test(scene: Scene, name: str) -> bool:
        body, there = scene.body(name, node), target(scene)
        if freespace:
            return rule(box_distance(_box(body, body.center()), Box(*there, 0.0, 0.0)))
        here = scene.pose(name, node)
        return rule(math.hypot(there.x_m - here.x_m, there.y_m - here.y_m))

    return test


def _relative_distance(node: Node) -> OfEntity:
    rule, other, freespace = _rule(node), node.text("entityRef"), node.flag("freespace")
    node.choice("coordinateSystem", ("entity",), "entity")
    kinds = ("longitudinal", "lateral", "cartesianDistance", "euclidianDistance")
    kind = node.choice("relativeDistanceType", kinds)

    def test(scene: Scene, name: str) -> bool:
        scene.pose(name, node), scene.pose(other, node)
        first, second = scene.body(name, node), scene.body(other, node)
        return rule(_separation(first, second, kind, freespace))

    return test


def _collision(node: Node) -> OfEntity:
    other = node.need("EntityRef").text("entityRef")

    def test(scene: Scene, name: str) -> bool:
        scene.pose(name, node), scene.pose(other, node)
        first, second = scene.body(name, node), scene.body(other, node)
        return overlap(_box(first, first.center()), _box(second, second.center()))

    return test


def _separation(first: Body, second: Body, kind: str, freespace: bool) -> float:
    """Distance of two bodies, metres: in the first one's axes, or as the crow flies."""
    a, b = first.center() if freespace else first.pose, second.center() if freespace else second.pose
    assert a is not None and b is not None  # noqa: S101, PT018 - the caller checks both
    if kind in ("cartesianDistance", "euclidianDistance"):
        return box_distance(_box(first, a), _box(second, b)) if freespace else math.hypot(b.x_m - a.x_m, b.y_m - a.y_m)
    axis = a.heading_rad + (math.pi / 2 if kind == "lateral" else 0.0)
    apart = abs((b.x_m - a.x_m) * math.cos(axis) + (b.y_m - a.y_m) * math.sin(axis))
    return max(0.0, apart - _reach_of(first, a, axis) - _reach_of(second, b, axis)) if freespace else apart


def _reach_of(body: Body, pose: Pose, axis_rad: float) -> float:
    """How far a box reaches from its center along an axis."""
    turn = pose.heading_rad - axis_rad
    return body.box.length_m / 2 * abs(math.cos(turn)) + body.box.width_m / 2 * abs(math.sin(turn))


def _box(body: Body, center: Pose) -> Box:
    return Box(*center, body.box.length_m, body.box.width_m)


_BY_VALUE: dict[str, Callable[[Node], Test]] = {
    "SimulationTimeCondition": _simulation_time,
    "StoryboardElementStateCondition": _element_state,
}
_BY_ENTITY: dict[str, Callable[[Node], OfEntity]] = {
    "TraveledDistanceCondition": _travelled, "SpeedCondition": _speed, "RelativeSpeedCondition": _relative_speed,
    "StandStillCondition": _stand_still, "ReachPositionCondition": _reach, "DistanceCondition": _distance,
    "RelativeDistanceCondition": _relative_distance, "CollisionCondition": _collision,
}  # fmt: skip
