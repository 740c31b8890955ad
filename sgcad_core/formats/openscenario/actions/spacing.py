"""Actions that keep or meet another entity: LongitudinalDistanceAction and SynchronizeAction."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.actions.running import PRIVATE, ActionStart, RunningAction, relative_speed
from sgcad_core.formats.openscenario.actions.speed import LONGITUDINAL
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.distances import ahead_of
from sgcad_core.formats.openscenario.playing.offset_course import OffsetCourse
from sgcad_core.formats.openscenario.playing.positions import PositionFunction, position
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode

STIFFNESS = 0.4
"""Of the spring that keeps a distance, 1/m per unit of the acceleration limit: esmini's value, since the standard
leaves the control open."""
REACHED_M = 0.1
ON_LINE_MPS = 0.1


# ------------------------------------------------------------------ distance
@LONGITUDINAL.plays(
    "LongitudinalDistanceAction",
    remark="held exactly without limits, else by a critically damped spring within them and what the entity can do",
)
def _distance(node: XmlNode) -> ActionStart:
    other, freespace = node.text("entityRef"), node.flag("freespace")
    continuous = node.flag("continuous")
    wanted = _wanted(node, other)
    constraints = _constraints(node)
    system = node.choice("coordinateSystem", ("entity", "lane", "road", "trajectory"), "entity")

    def begin(scene: Scene, actor: str) -> RunningAction:
        body, state = scene.body(actor, node), {"over": False}
        limits = constraints(body)
        spring = _Spring(limits)
        side = _side(node, ahead_of(scene, body, scene.body(other, node), system, freespace, node))

        def control(scene: Scene) -> None:
            lead = scene.body(other, node)
            error = ahead_of(scene, body, lead, system, freespace, node) - side * wanted(scene)
            if not continuous and abs(error) < REACHED_M:
                state["over"] = True
            if math.isinf(limits.up) and math.isinf(limits.down):
                _hold(scene, body, lead, error)
            else:
                body.next_mps = spring.speed(body.speed_mps, lead.speed_mps, error, scene.dt_s)

        running = RunningAction(body, ("speed",), lambda scene: state["over"], control=control).claim()
        if math.isinf(limits.up) and math.isinf(limits.down):  # held exactly from the first moment
            control(scene)
        return running

    return begin


def _wanted(node: XmlNode, other: str) -> Callable[[Scene], float]:
    """The distance to keep, metres; a time gap counts at the other's speed."""
    if node.has("distance"):
        distance = node.number("distance")
        return lambda scene: abs(distance)
    gap = node.number("timeGap")
    return lambda scene: abs(gap * scene.body(other, node).speed_mps)


def _side(node: XmlNode, ahead_m: float) -> int:
    """1 where the other is to be ahead, -1 where behind; undecided: as it is now."""
    words = {"trailingReferencedEntity": 1, "leadingReferencedEntity": -1, "any": 1 if ahead_m >= 0 else -1}
    return words[node.choice("displacement", words, "any" if node.has("displacement") else "trailingReferencedEntity")]


def _hold(scene: Scene, body: Body, lead: Body, error_m: float) -> None:
    """At the distance at once, with the other's speed."""
    assert body.pose is not None  # noqa: S101 - distances are told of placed entities only
    course = body.course or scene.course_for(body)
    body.course, body.pose = course, course.move(error_m)
    found = course.place()
    body.place = found[0] if found else None
    body.speed_mps = body.next_mps = lead.speed_mps


class _Limits(NamedTuple):
    """Most acceleration and deceleration (m/s²), their rates (m/s³), speed (m/s)."""

    up: float = math.inf
    down: float = math.inf
    up_rate: float = math.inf
    down_rate: float = math.inf
    top: float = math.inf


def _constraints(node: XmlNode) -> Callable[[Body], _Limits]:
    """Of the action, and no more than the entity's own performance; none at all without <DynamicConstraints>."""
    if (told := node.find("DynamicConstraints")) is None:
        return lambda body: _Limits()
    names = ("maxAcceleration", "maxDeceleration", "maxAccelerationRate", "maxDecelerationRate", "maxSpeed")
    up, down, up_rate, down_rate, top = (told.limit(name) for name in names)
    return lambda body: _Limits(
        min(up, body.limits.acceleration), min(down, body.limits.deceleration), up_rate, down_rate,
        min(top, body.limits.speed_mps),
    )  # fmt: skip


class _Spring:
    """A critically damped spring between two entities; keeps the acceleration, whose rate may be limited."""

    def __init__(self, limits: _Limits) -> None:
        self._limits, self._acceleration = limits, 0.0

    def speed(self, now_mps: float, lead_mps: float, error_m: float, dt_s: float) -> float:
        """At the end of the step."""
        most = self._limits
        stiffness = STIFFNESS * min(most.up if error_m < 0 else most.down, 1e3)
        wanted = error_m * stiffness - (now_mps - lead_mps) * 2 * math.sqrt(stiffness)
        wanted = min(max(wanted, -most.down), most.up)
        if wanted < 0:
            wanted = max(wanted, min(self._acceleration, self._acceleration - most.down_rate * dt_s))
        else:
            wanted = min(wanted, max(self._acceleration, self._acceleration + most.up_rate * dt_s))
        self._acceleration = wanted
        return min(max(now_mps + wanted * dt_s, -most.top), most.top)


# ------------------------------------------------------------------ synchronize
class _Steady(NamedTuple):
    """What the steady state in front of the target is: its length, metres."""

    distance_m: Callable[[Scene, float], float]


@PRIVATE.plays("SynchronizeAction", remark="two phases of equal acceleration, the second ending with the final speed")
def _synchronize(node: XmlNode) -> ActionStart:
    master = node.text("masterEntityRef" if node.has("masterEntityRef") else "entityRef")
    master_there, there = position(node.need("TargetPositionMaster")), position(node.need("TargetPosition"))
    near, master_near = node.number("targetTolerance", 0.0), node.number("targetToleranceMaster", 0.0)
    final, steady = _final(node, master, there)

    def begin(scene: Scene, actor: str) -> RunningAction:
        body = scene.body(actor, node)
        meeting = _Meeting(node, body, scene.body(master, node), (there, master_there), (near, master_near))
        meeting.final, meeting.steady = final, steady
        if body.timed:
            body.release("path")
        body.pace = None
        running = RunningAction(body, ("speed",), lambda scene: meeting.over, control=meeting.control)
        return running.claim()

    return begin


def _final(
    node: XmlNode, master: str, there: PositionFunction
) -> tuple[Callable[[Scene], float] | None, Callable[[Scene, float], float] | None]:
    """The final speed, and how long before the target it is held, metres."""
    holder = node.find("FinalSpeed")
    if holder is None:
        return None, None
    told = holder.only()
    value = told.number("value")
    speed = (lambda scene: value) if told.tag == "AbsoluteSpeed" else _of_master(told, master, value)
    for kind in told.children("TargetDistanceSteadyState", "TargetTimeSteadyState", "TargetPositionSteadyState"):
        return speed, _steady(kind, there)
    return speed, None


def _of_master(node: XmlNode, master: str, value: float) -> Callable[[Scene], float]:
    if node.tag != "RelativeSpeedToMaster":
        raise node.unsupported()
    return relative_speed(node, master, value, "speedTargetValueType")


def _steady(node: XmlNode, there: PositionFunction) -> Callable[[Scene, float], float]:
    if node.tag == "TargetTimeSteadyState":
        time = node.number("time" if node.has("time") else "steadyStateTime")
        return lambda scene, speed: time * speed
    if node.tag == "TargetPositionSteadyState":
        begin = position(node.need("Position"))
        return lambda scene, speed: math.dist(begin(scene).pose[:2], there(scene).pose[:2])
    distance = node.number("distance" if node.has("distance") else "steadyStateDistance")
    return lambda scene, speed: distance


class _Meeting:
    """A body on its way to be at a place when another is at its own."""

    final: Callable[[Scene], float] | None = None
    steady: Callable[[Scene, float], float] | None = None

    def __init__(
        self,
        node: XmlNode,
        body: Body,
        master: Body,
        places: tuple[PositionFunction, PositionFunction],
        tolerances: tuple[float, float],
    ) -> None:
        self._node, self._body, self._master = node, body, master
        self._places, self._tolerances = places, tolerances
        self.over, self._linear, self._last = False, False, (math.inf, math.inf)

    def control(self, scene: Scene) -> None:
        """Choose this step's acceleration so that both arrive together."""
        rest = way_to(scene, self._body, self._places[0](scene).pose, self._node)
        masters = way_to(scene, self._master, self._places[1](scene).pose, self._node)
        near, master_near = self._tolerances
        time = (masters - master_near) / abs(self._master.speed_mps) if abs(self._master.speed_mps) > 1e-6 else math.inf
        passed = rest > self._last[0] + 1e-6 or masters > self._last[1] + 1e-6
        self._last = rest, masters
        last = self.final(scene) if self.final else None
        if rest <= near + 1e-6 or masters <= master_near + 1e-6 or passed or time < scene.dt_s:
            self.over = True
            self._body.next_mps = self._body.speed_mps = self._body.speed_mps if last is None else last
        elif math.isinf(time):
            self._body.speed_mps = self._body.next_mps = 0.0
        else:
            speed = self._speed(scene, max(rest - near, 1e-6), time, last)
            self._body.next_mps = speed if last is None else max(speed, 0.0)

    def _speed(self, scene: Scene, rest_m: float, time_s: float, last: float | None) -> float:
        """Speed at the end of this step."""
        now, dt = self._body.speed_mps, scene.dt_s
        if last is None:
            return now + 2 * (rest_m / time_s - now) / time_s * dt
        if self.steady and last > 0:
            hold = self.steady(scene, last)
            if rest_m - hold <= 1e-6 or time_s - hold / last <= 1e-6:
                return last
            rest_m, time_s = rest_m - hold, time_s - hold / last
        on_line = 2 * rest_m / time_s - last
        self._linear = self._linear or abs(now - on_line) < ON_LINE_MPS
        if self._linear:
            return max(0.0, on_line + (last - on_line) / time_s * dt)
        return max(0.0, now + _first_phase(now, max(last, 0.0), rest_m, time_s) * dt)


def _first_phase(now: float, last: float, rest_m: float, time_s: float) -> float:
    """Acceleration a of the first of two phases, a until the turn and -a behind it, that ends with `last` in time.

    With x the time of the turn: vx = now + a x = last + a (t - x), and the way is the area under both lines. Where
    the speed would fall below zero the entity brakes to a stand first, and waits.
    """
    change, short = last - now, rest_m - (now + last) / 2 * time_s
    if abs(change) < 1e-6:
        acceleration = 4 * short / time_s**2
        turn = now + acceleration * time_s / 2
    else:
        # short = a t²/4 - change²/(4 a): the larger root in the sense of `short`
        root = math.sqrt(4 * short**2 + change**2 * time_s**2)
        acceleration = (2 * short + math.copysign(root, short or change)) / time_s**2
        turn = (now + last + acceleration * time_s) / 2
    if turn >= 0:
        return acceleration
    stop = 2 * now * rest_m / max(now**2 + last**2, 1e-9)
    return -now / stop if stop > 1e-6 else 0.0


def way_to(scene: Scene, body: Body, there: Pose, node: XmlNode) -> float:
    """Distance that an entity has still to go: on its trajectory, along the roads, else as the crow flies."""
    pose = scene.pose(body.name, node)
    if body.course is not None and body.course.fixed:
        return max(0.0, _nearest_m(body.course, there) - body.course.s_m)
    place = scene.lane_place(body)
    target = scene.roads.nearest(there) if scene.roads else None
    if place and target and scene.roads:
        found = scene.roads.apart(place, scene.sense(body, place), target)
        if found is not None:
            return abs(found.ahead_m)
    return math.dist(pose[:2], there[:2])


def _nearest_m(course: OffsetCourse, there: Pose) -> float:
    """Where along a course a place lies."""
    import numpy as np

    a, b = course.points[:-1], course.points[1:]
    along = b - a
    share = np.clip(((np.array(there[:2]) - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-12), 0, 1)
    gap = np.hypot(*(a + share[:, None] * along - np.array(there[:2])).T)
    k = int(gap.argmin())
    return float(course.along[k] + share[k] * math.hypot(*along[k]))
