"""Actions across the road: LaneChangeAction, LaneOffsetAction and LateralDistanceAction."""

from __future__ import annotations

import math
from collections.abc import Callable

from sgcad_core.formats.openscenario.actions.running import (
    PRIVATE,
    ActionStart,
    Dynamics,
    RunningAction,
    at_once,
    dynamics,
    nested,
)
from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.offset_course import OffsetCourse, beside
from sgcad_core.formats.openscenario.playing.positions import shifted
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON, STEEPEST, Transition
from sgcad_core.formats.openscenario.reading.elements import XmlNode
from sgcad_core.formats.openscenario.roads.way import LanePlace, Way

LATERAL: Family[ActionStart] = Family("lateral action")
PRIVATE.plays("LateralAction")(lambda node: nested(LATERAL, node))
_CURVES = {"step": 0.0, "linear": 6.0, "sinusoidal": math.pi**2 / 2, "cubic": 6.0}
"""Largest second derivative of each shape over u in [0, 1]; that of a line, which has none, is taken from the cubic."""


@LATERAL.plays("LaneChangeAction")
def _lane_change(node: XmlNode) -> ActionStart:
    over = dynamics(node.need("LaneChangeActionDynamics"))
    target, offset = _target_lane(node.need("LaneChangeTarget").only()), node.number("targetLaneOffset", 0.0)

    def begin(scene: Scene, actor: str) -> RunningAction:
        body, place = _in_lane(scene, actor, node)
        if place is None:
            return at_once(body)
        sense = scene.sense(body, place)
        lane = target(scene, actor)
        way = _way(scene, body, LanePlace(place.road, lane, place.s_m, 0.0), sense, node)
        return _shift(scene, body, way, offset * sense, over)

    return begin


def _in_lane(scene: Scene, actor: str, node: XmlNode) -> tuple[Body, LanePlace | None]:
    """The entity and its lane; without one a third-party file's action is skipped (a note), an own file is at fault."""
    body = scene.body(actor, node)
    scene.pose(actor, node)
    scene.road_map(node)
    if (place := scene.lane_place(body)) is None:
        node.doubt("the entity is in no lane", actor, "place it in a lane first")
    return body, place


def _way(scene: Scene, body: Body, place: LanePlace, sense: int, node: XmlNode) -> Way:
    try:
        way = scene.road_map(node).drive(place, sense, body.route)
    except ValueError as fault:
        raise node.fault(str(fault)) from fault
    if len(way.points) < 2:
        raise node.fault("the lane ends where the entity is", f"road {place.road}, lane {place.lane}")
    return way


def _shift(scene: Scene, body: Body, way: Way, last: float, over: Dynamics, aside_counts: bool = True) -> RunningAction:
    """Run a transition of the lateral offset along a way, from where the entity is."""
    assert body.pose is not None  # noqa: S101 - the caller checks it
    ahead, first = beside(way.points, body.pose)
    by_time = over.dimension != "distance"
    shape, span = over.shape, over.value
    if over.dimension == "rate":
        span = STEEPEST[shape] * abs(last - first) / over.value if over.value else 0.0
    shift = Transition(first, last, shape if span else "step", span, scene.t_s if by_time else 0.0)
    body.timed = None
    body.course = course = OffsetCourse(way.points, ahead, shift, by_time, way, aside_counts=aside_counts)

    def ended(scene: Scene) -> bool:
        mine = body.course or course
        return shift.over(scene.t_s if by_time else mine.passed_m) or body.at_end

    return RunningAction(body, ("path",), ended, release_when_over=False).claim()


def _target_lane(node: XmlNode) -> Callable[[Scene, str], int]:
    """The lane id to change to; a relative one counts to the left of the reference entity's driving direction."""
    if node.tag == "AbsoluteTargetLane":
        lane = node.whole("value")
        return lambda scene, actor: lane
    if node.tag != "RelativeTargetLane":
        raise node.unsupported()
    name, by = node.text("entityRef"), node.whole("value")

    def lane_of(scene: Scene, actor: str) -> int:
        scene.pose(name, node)
        other = scene.body(name, node)
        if (place := scene.lane_place(other)) is None:
            raise node.fault("the reference entity is in no lane", name)
        return shifted(place.lane, by * scene.sense(other, place))

    return lane_of


# ------------------------------------------------------------------ offsets
@LATERAL.plays(
    "LaneOffsetAction",
    remark="without maxLateralAcc the offset is taken at once; the speed counts along the lane, as in esmini",
)
def _lane_offset(node: XmlNode) -> ActionStart:
    """The time comes from the largest lateral acceleration; an offset counts to the left of the road's direction."""
    shaped = node.need("LaneOffsetActionDynamics")
    shape, limit = shaped.choice("dynamicsShape", STEEPEST), shaped.limit("maxLateralAcc")
    target = _target_offset(node.need("LaneOffsetTarget").only())
    continuous = node.flag("continuous", False)

    def begin(scene: Scene, actor: str) -> RunningAction:
        body, place = _in_lane(scene, actor, node)
        if place is None:
            return at_once(body)
        sense = scene.sense(body, place)
        way = _way(scene, body, place._replace(offset_m=0.0), sense, node)
        first, last = beside(way.points, scene.pose(actor, node))[1], target(scene, body, place) * sense
        span = math.sqrt(_CURVES[shape] * abs(last - first) / limit) if limit > EPSILON else 0.0
        running = _shift(scene, body, way, last, Dynamics(shape, "time", span), aside_counts=False)
        if continuous:
            return RunningAction(body, ("path",), lambda scene: False).claim()
        return running

    return begin


def _target_offset(node: XmlNode) -> Callable[[Scene, Body, LanePlace], float]:
    value = node.number("value")
    if node.tag == "AbsoluteTargetLaneOffset":
        return lambda scene, body, place: value
    if node.tag != "RelativeTargetLaneOffset":
        raise node.unsupported()
    name = node.text("entityRef")

    def offset(scene: Scene, body: Body, place: LanePlace) -> float:
        scene.pose(name, node)
        other, roads = scene.body(name, node), scene.road_map(node)
        if (there := scene.lane_place(other)) is None:
            raise node.fault("the reference entity is in no lane", name)
        aim = roads.t_of(there) + value * scene.sense(other, there)
        return aim - roads.t_of(place._replace(offset_m=0.0))

    return offset


@LATERAL.plays("LateralDistanceAction", remark="in the other entity's axes; reached at the rate that maxSpeed allows")
def _lateral_distance(node: XmlNode) -> ActionStart:
    """Beside another entity: the distance counts across its heading."""
    other, wanted, freespace = node.text("entityRef"), node.number("distance", 0.0), node.flag("freespace")
    continuous = node.flag("continuous")
    limits = node.find("DynamicConstraints")
    top = limits.limit("maxSpeed") if limits else math.inf
    left = node.choice("displacement", _SIDES, "any")

    def begin(scene: Scene, actor: str) -> RunningAction:
        body, lead, state = scene.body(actor, node), scene.body(other, node), {"over": False}
        scene.pose(other, node)
        reach = (body.box.width_m + lead.box.width_m) / 2 if freespace else 0.0
        side = _SIDES[left] or (1 if _aside(body, lead) >= 0 else -1)

        def control(scene: Scene) -> None:
            error = side * (abs(wanted) + reach) - _aside(body, lead)
            if abs(error) < 1e-3 and not continuous:
                state["over"] = True
            _slide(scene, body, lead, min(max(error, -top * scene.dt_s), top * scene.dt_s))

        return RunningAction(body, ("path",), lambda scene: state["over"], control=control).claim()

    return begin


_SIDES = {"any": 0, "leftToReferencedEntity": 1, "rightToReferencedEntity": -1}


def _aside(body: Body, lead: Body) -> float:
    """How far a body is to the left of another's axis."""
    assert body.pose is not None  # noqa: S101 - checked when the action begins
    assert lead.pose is not None  # noqa: S101 - as above
    h = lead.pose.heading_rad
    return (body.pose.y_m - lead.pose.y_m) * math.cos(h) - (body.pose.x_m - lead.pose.x_m) * math.sin(h)


def _slide(scene: Scene, body: Body, lead: Body, left_m: float) -> None:
    """Move sideways, keeping the course ahead."""
    assert body.pose is not None  # noqa: S101 - as above
    assert lead.pose is not None  # noqa: S101 - as above
    h = lead.pose.heading_rad
    body.pose = body.pose._replace(x_m=body.pose.x_m - left_m * math.sin(h), y_m=body.pose.y_m + left_m * math.cos(h))
    body.course = body.place = None
