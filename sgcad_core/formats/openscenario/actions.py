"""OpenSCENARIO actions as functions that set a body's path and speed.

Knows no trigger. What is not supported raises InvalidOutput when it is compiled, not when it is reached.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from sgcad_core.formats.openscenario.conditions import Test
from sgcad_core.formats.openscenario.motion import STEEPEST, Body, Course, Transition
from sgcad_core.formats.openscenario.positions import position, shifted
from sgcad_core.formats.openscenario.read import Node
from sgcad_core.formats.openscenario.scene import Scene, lateral_m
from sgcad_core.formats.openscenario.trajectory import trajectory


@dataclass(eq=False)
class Running:
    """An action under way. A newer action in the same domain of the same body ends it."""

    body: Body
    domains: tuple[str, ...]
    over: Test
    release_when_over: bool = True

    def done(self, scene: Scene) -> bool:
        """Whether it has ended; what it controlled is then free."""
        if not self._in_control():
            return True
        if over := self.over(scene):
            self.stop(self.release_when_over)
        return over

    def stop(self, release: bool = True) -> None:
        """End it."""
        for domain in self.domains:
            if self.body.owners.get(domain) is self:
                del self.body.owners[domain]
                if release:
                    self.body.release(domain)

    def claim(self) -> Running:
        """Take control."""
        for domain in self.domains:
            self.body.owners[domain] = self
        return self

    def _in_control(self) -> bool:
        return all(self.body.owners.get(domain) is self for domain in self.domains)


Begin = Callable[[Scene, str], Running]


def private_action(node: Node) -> Begin:
    """Compile a <PrivateAction>."""
    return _pick(node.only(), _PRIVATE)


def global_action(node: Node) -> None:
    """Check a <GlobalAction>; the supported ones move nobody."""
    if (child := node.only()).tag != "EnvironmentAction":
        raise child.unsupported()


def _pick(node: Node, known: dict[str, Callable[[Node], Begin]]) -> Begin:
    if node.tag not in known:
        raise node.unsupported()
    return known[node.tag](node)


def _at_once(body: Body) -> Running:
    return Running(body, (), lambda scene: True)


def _teleport(node: Node) -> Begin:
    where = position(node.need("Position"))

    def begin(scene: Scene, actor: str) -> Running:
        body = scene.body(actor, node)
        body.place(where(scene))
        body.owners.pop("path", None)
        return _at_once(body)

    return begin


def _nothing(node: Node) -> Begin:
    return lambda scene, actor: _at_once(scene.body(actor, node))


# ------------------------------------------------------------------ speed
def _speed(node: Node) -> Begin:
    dynamics = node.need("SpeedActionDynamics")
    shape, dimension, value = _dynamics(dynamics)
    target = _target_speed(node.need("SpeedActionTarget").only())

    def begin(scene: Scene, actor: str) -> Running:
        body, last = scene.body(actor, node), target(scene)
        if body.timed:
            body.release("path")
        first = body.speed_mps
        span = _seconds(dynamics, (shape, dimension, value), abs(last - first), (first + last) / 2)
        body.pace = pace = Transition(first, last, shape, span, scene.t_s)
        body.speed_mps = pace.at(scene.t_s)
        return Running(body, ("speed",), lambda scene: pace.over(scene.t_s), release_when_over=False).claim()

    return begin


def _dynamics(node: Node) -> tuple[str, str, float]:
    """Shape, dimension and value of a transition."""
    shape = node.choice("dynamicsShape", tuple(STEEPEST))
    value = node.number("value", 0.0 if shape == "step" else None)
    if value < 0 or (shape != "step" and value == 0):
        raise node.fault("attribute 'value' must be above 0", f"{value:g}", "or use dynamicsShape step")
    return shape, node.choice("dynamicsDimension", ("time", "rate", "distance"), "time"), value


def _seconds(node: Node, dynamics: tuple[str, str, float], change: float, mean_mps: float) -> float:
    """Duration of a change of speed; the shapes are symmetric, so a distance is covered at the mean speed."""
    shape, dimension, value = dynamics
    if dimension == "time" or shape == "step":
        return value
    if dimension == "rate":
        return STEEPEST[shape] * change / value
    if mean_mps <= 0:
        raise node.fault("a change of speed over a distance needs motion", f"mean speed {mean_mps:g} m/s")
    return value / mean_mps


def _target_speed(node: Node) -> Callable[[Scene], float]:
    if node.tag == "AbsoluteTargetSpeed":
        value = node.number("value")
        return lambda scene: value
    if node.tag != "RelativeTargetSpeed" or node.flag("continuous"):
        raise node.unsupported()
    name, value = node.text("entityRef"), node.number("value")
    factor = node.choice("speedTargetValueType", ("delta", "factor")) == "factor"
    return lambda scene: scene.body(name, node).speed_mps * (value if factor else 1) + (0 if factor else value)


# ------------------------------------------------------------------ path
def _lane_change(node: Node) -> Begin:
    dynamics = node.need("LaneChangeActionDynamics")
    shape, dimension, value = _dynamics(dynamics)
    target, offset = _target_lane(node.need("LaneChangeTarget").only()), node.number("targetLaneOffset", 0.0)

    def begin(scene: Scene, actor: str) -> Running:
        body, pose = scene.body(actor, node), scene.pose(actor, node)
        roads = scene.road_map(node)
        place = roads.nearest(pose)
        if place is None:
            raise node.fault("the entity is in no lane", actor, "place it in a lane first")
        try:
            points = roads.way(place.road, target(scene, actor), place.s_m)
        except ValueError as fault:
            raise node.fault(str(fault)) from fault
        first, by_time = lateral_m(points, pose), dimension != "distance"
        span = STEEPEST[shape] * abs(offset - first) / value if dimension == "rate" and value else value
        shift = Transition(first, offset, shape, span, scene.t_s if by_time else body.travelled_m)
        body.timed, body.course = None, Course(points, shift=shift, by_time=by_time)

        def over(scene: Scene) -> bool:
            return shift.over(scene.t_s if by_time else body.travelled_m)

        return Running(body, ("path",), over, release_when_over=False).claim()

    return begin


def _target_lane(node: Node) -> Callable[[Scene, str], int]:
    """The lane id to change to; a relative one counts to the left of the reference entity's driving direction."""
    if node.tag == "AbsoluteTargetLane":
        lane = int(node.number("value"))
        return lambda scene, actor: lane
    if node.tag != "RelativeTargetLane":
        raise node.unsupported()
    name, by = node.text("entityRef"), int(node.number("value"))

    def lane_of(scene: Scene, actor: str) -> int:
        place = scene.road_map(node).nearest(scene.pose(name, node))
        if place is None:
            raise node.fault("the reference entity is in no lane", name)
        return shifted(place.lane, by if place.lane < 0 else -by)

    return lane_of


def _follow(node: Node) -> Begin:
    make = trajectory(node)

    def begin(scene: Scene, actor: str) -> Running:
        body = scene.body(actor, node)
        made = make(scene)
        body.course = body.timed = None
        if isinstance(made, Course):
            body.course = course = made
            body.pose = course.advance(0.0, 0.0)
            return Running(body, ("path",), lambda scene: course.rest_m <= 1e-6).claim()
        body.timed = timed = made
        body.pose, body.speed_mps = timed.pose(scene.step), timed.speed(scene.step)
        return Running(body, ("path", "speed"), lambda scene: scene.t_s >= timed.end_s - 1e-9).claim()

    return begin


_PRIVATE: dict[str, Callable[[Node], Begin]] = {
    "TeleportAction": _teleport,
    "VisibilityAction": _nothing,
    "LongitudinalAction": lambda node: _pick(node.only(), {"SpeedAction": _speed}),
    "LateralAction": lambda node: _pick(node.only(), {"LaneChangeAction": _lane_change}),
    "RoutingAction": lambda node: _pick(node.only(), {"FollowTrajectoryAction": _follow}),
}
