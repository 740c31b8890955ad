"""Actions on speed alone: SpeedAction and SpeedProfileAction."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sgcad_core.formats.openscenario.actions.running import (
    PRIVATE,
    ActionStart,
    RunningAction,
    dynamics,
    nested,
    relative_speed,
)
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON, STEEPEST, Transition
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.geometry.plane import Floats

LONGITUDINAL: Family[ActionStart] = Family("longitudinal action")
PRIVATE.plays("LongitudinalAction")(lambda node: nested(LONGITUDINAL, node))
_EAGER = 1e6
"""m/s²: an entity without a limit."""


@LONGITUDINAL.plays("SpeedAction")
def _speed(node: XmlNode) -> ActionStart:
    """The speed of a transition over time; a relative target may be followed for good (`continuous`)."""
    over = dynamics(node.need("SpeedActionDynamics"))
    holder = node.need("SpeedActionTarget").only()
    target, follows = _target(holder)

    def begin(scene: Scene, actor: str) -> RunningAction:
        body = scene.body(actor, node)
        last = _capped(body, target(scene))
        if body.timed:
            body.release("path")
        first = body.speed_mps
        span = _feasible(body, over.shape, last - first, over.seconds(first, last))
        pace = Transition(first, last, over.shape if span else "step", span, scene.t_s)
        body.pace, body.speed_mps = pace.at, pace.at(scene.t_s)
        running = RunningAction(body, ("speed",), lambda scene: pace.over(scene.t_s), release_when_over=False)
        if follows:
            running = RunningAction(body, ("speed",), lambda scene: False, control=_keep(body, target, pace))
        return running.claim()

    return begin


def _feasible(body: Body, shape: str, change: float, span_s: float) -> float:
    """A span that is long enough for the entity's limits of acceleration; a step of speed is taken as it is."""
    limit = body.limits.acceleration if change > 0 else body.limits.deceleration
    return max(span_s, STEEPEST[shape] * abs(change) / max(limit, EPSILON)) if span_s else 0.0


def _keep(body: Body, target: Callable[[Scene], float], pace: Transition) -> Callable[[Scene], None]:
    """Behind the transition, the other's speed as it changes, within what the entity can do."""

    def control(scene: Scene) -> None:
        if pace.over(scene.t_s):
            change = _capped(body, target(scene)) - body.speed_mps
            most, least = body.limits.acceleration * scene.dt_s, -body.limits.deceleration * scene.dt_s
            body.next_mps = body.speed_mps + min(max(change, least), most)

    return control


def _capped(body: Body, speed_mps: float) -> float:
    return math.copysign(min(abs(speed_mps), body.limits.speed_mps), speed_mps)


def _target(node: XmlNode) -> tuple[Callable[[Scene], float], bool]:
    """The speed to reach, and whether it is followed for good."""
    if node.tag == "AbsoluteTargetSpeed":
        value = node.number("value")
        return (lambda scene: value), False
    if node.tag != "RelativeTargetSpeed":
        raise node.unsupported()
    told = relative_speed(node, node.text("entityRef"), node.number("value"), "speedTargetValueType")
    return told, node.flag("continuous", False)


@LONGITUDINAL.plays("SpeedProfileAction", remark="limits of acceleration are kept; jerk is not limited")
def _profile(node: XmlNode) -> ActionStart:
    """Straight pieces of speed over time: entries say how long each takes; without a time, as fast as allowed."""
    entries = [(e.number("time", -1.0), e.number("speed")) for e in node.children("SpeedProfileEntry")]
    if not 1 <= len(entries) <= 10_000:
        raise node.fault("needs 1 to 10000 <SpeedProfileEntry>", str(len(entries)))
    if node.choice("followingMode", ("position", "follow"), "position") == "follow":
        node.note("speed profiles are followed without a limit of jerk")
    limits = node.find("DynamicConstraints")
    up, down = (limits.limit(k) if limits else math.inf for k in ("maxAcceleration", "maxDeceleration"))
    other = node.text("entityRef", "")

    def begin(scene: Scene, actor: str) -> RunningAction:
        body = scene.body(actor, node)
        base = scene.body(other, node).speed_mps if other else 0.0
        up_to, down_to = min(up, body.limits.acceleration), min(down, body.limits.deceleration)
        times, speeds = _pieces(entries, base, body.speed_mps, (up_to, down_to))
        times += scene.t_s
        body.pace = lambda t_s: float(np.interp(t_s, times, speeds))
        body.speed_mps = body.pace(scene.t_s)
        end_s = float(times[-1])
        over = RunningAction(body, ("speed",), lambda scene: scene.t_s >= end_s - EPSILON, release_when_over=False)
        return over.claim()

    return begin


def _pieces(
    entries: list[tuple[float, float]], base: float, now: float, limits: tuple[float, float]
) -> tuple[Floats, Floats]:
    times, speeds = [0.0], [now]
    for i, (span, told) in enumerate(entries):
        speed = told + base
        if i == 0 and span == 0:
            speeds[0] = speed
            continue
        change = speed - speeds[-1]
        limit = min(limits[0] if change > 0 else limits[1], _EAGER)
        times.append(times[-1] + max(span, abs(change) / max(limit, EPSILON), 0.0))
        speeds.append(speed)
    return np.array(times), np.array(speeds)
