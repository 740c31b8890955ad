"""Conditions on how an entity moves: speed, acceleration, standing, distance travelled, angle, end of its road."""

from __future__ import annotations

import math
from collections.abc import Callable

from sgcad_core.formats.openscenario.conditions.rules import BY_ENTITY, OfEntity, rule
from sgcad_core.formats.openscenario.playing.body import STILL_MPS, Body
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON, angle_between
from sgcad_core.formats.openscenario.reading.elements import XmlNode


@BY_ENTITY.plays("TraveledDistanceCondition")
def _travelled(node: XmlNode) -> OfEntity:
    value = node.number("value")
    return lambda scene, name: scene.body(name, node).travelled_m >= value - EPSILON


@BY_ENTITY.plays("SpeedCondition", remark="direction 'lateral' and 'vertical' are 0: wheels roll")
def _speed(node: XmlNode) -> OfEntity:
    holds, told = rule(node), _directed(node)
    return lambda scene, name: holds(told(scene.body(name, node).speed_mps))


@BY_ENTITY.plays("RelativeSpeedCondition")
def _relative_speed(node: XmlNode) -> OfEntity:
    holds, other, told = rule(node), node.text("entityRef"), _directed(node)
    return lambda scene, name: holds(told(scene.body(name, node).speed_mps - scene.body(other, node).speed_mps))


def _directed(node: XmlNode) -> Callable[[float], float]:
    known = ("longitudinal", "lateral", "vertical", "total")
    return (
        (lambda value: value)
        if node.choice("direction", known, "longitudinal") in ("longitudinal", "total")
        else (lambda value: 0.0)
    )


@BY_ENTITY.plays("AccelerationCondition")
def _acceleration(node: XmlNode) -> OfEntity:
    holds = rule(node)
    direction = node.choice("direction", ("longitudinal", "lateral", "vertical", "total"), "total")

    def test(scene: Scene, name: str) -> bool:
        along, across = scene.body(name, node).acceleration
        total = math.hypot(along, across)
        return holds({"longitudinal": along, "lateral": across, "vertical": 0.0}.get(direction, total))

    return test


def _lasting(node: XmlNode, state: Callable[[Scene, Body], bool]) -> OfEntity:
    """A state that must have lasted for `duration` seconds, counted in steps."""
    duration, since = node.number("duration"), dict[str, int]()

    def test(scene: Scene, name: str) -> bool:
        if not state(scene, scene.body(name, node)):
            since.pop(name, None)
            return False
        return (scene.step - since.setdefault(name, scene.step)) * scene.dt_s >= duration - EPSILON

    return test


@BY_ENTITY.plays("StandStillCondition")
def _stand_still(node: XmlNode) -> OfEntity:
    return _lasting(node, lambda scene, body: abs(body.speed_mps) < STILL_MPS)


@BY_ENTITY.plays("EndOfRoadCondition")
def _end_of_road(node: XmlNode) -> OfEntity:
    return _lasting(node, lambda scene, body: body.at_end)


@BY_ENTITY.plays("OffroadCondition", remark="by the entity's origin; every lane but those of type none is road")
def _offroad(node: XmlNode) -> OfEntity:
    return _lasting(node, lambda scene, body: not scene.road_map(node).on_road(scene.pose(body.name, node)))


@BY_ENTITY.plays("AngleCondition", remark="headings; pitch and roll are 0")
def _angle(node: XmlNode) -> OfEntity:
    angle, tolerance, reference = _angles(node)

    def test(scene: Scene, name: str) -> bool:
        here = scene.pose(name, node).heading_rad
        if reference == "road":
            body, roads = scene.body(name, node), scene.road_map(node)
            place = scene.lane_place(body)
            if place is None:
                return False
            here -= roads.road_pose(place.road, place.s_m, 0.0).heading_rad
        return angle_between(here, angle) <= tolerance + EPSILON

    return test


@BY_ENTITY.plays("RelativeAngleCondition", remark="headings; pitch and roll are 0")
def _relative_angle(node: XmlNode) -> OfEntity:
    angle, tolerance, _ = _angles(node)
    other = node.text("entityRef")

    def test(scene: Scene, name: str) -> bool:
        apart = scene.pose(other, node).heading_rad - scene.pose(name, node).heading_rad
        return angle_between(apart, angle) <= tolerance + EPSILON

    return test


def _angles(node: XmlNode) -> tuple[float, float, str]:
    if node.choice("angleType", ("heading", "pitch", "roll")) != "heading":
        raise node.unsupported("played motion is plane: pitch and roll are not known")
    system = node.choice("coordinateSystem", ("entity", "lane", "road", "trajectory", "world"), "entity")
    return node.number("angle"), node.number("angleTolerance"), "road" if system in ("lane", "road") else "world"
