"""Elements of OpenSCENARIO as the ego's file needs them: places, triggers, actions. Knows no plan."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from functools import lru_cache

from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace
from sgcad_core.geometry.plane import wrap_angle

SAME_M = 1e-3
"""A lane place is written where it is this near to the pose."""
TURNED_RAD = 0.5
"""Turned against its lane at most; what lies across a lane is told in the world's axes."""


def node(tag: str, *inside: ET.Element, **told: object) -> ET.Element:
    """An element with attributes and children; numbers are rounded to 1e-6, flags written as XML has them."""
    made = ET.Element(tag, {name: _text(value) for name, value in told.items()})
    made.extend(inside)
    return made


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{round(value, 6) + 0.0:g}" if isinstance(value, float) and abs(value) < 1e-3 else str(_rounded(value))


def _rounded(value: object) -> object:
    return round(value, 6) if isinstance(value, float) else value


@lru_cache(maxsize=64)
def lane_place(pose: Pose, roads: XodrRoads | None) -> LanePlace | None:
    """The place in a lane that a pose has, where one holds it to the millimetre; the last ones are remembered."""
    if roads is None or (place := roads.nearest(pose)) is None or not roads.covers(pose):
        return None
    there = roads.lane_pose(*place)
    near = abs(there.x_m - pose.x_m) + abs(there.y_m - pose.y_m) <= SAME_M
    return place if near and abs(float(wrap_angle(pose.heading_rad - there.heading_rad))) <= TURNED_RAD else None


def position(pose: Pose, roads: XodrRoads | None) -> ET.Element:
    """A pose as a place in its lane, else in the world."""
    place = lane_place(pose, roads)
    if place is None or roads is None:
        return node("Position", world(pose))
    turned = float(wrap_angle(pose.heading_rad - roads.lane_pose(*place).heading_rad))
    return node("Position", in_lane(place, turned))


def in_lane(place: LanePlace, turned_rad: float = 0.0) -> ET.Element:
    """A place in a lane, turned against its driving direction."""
    facing = node("Orientation", type="relative", h=round(turned_rad, 8) + 0.0)
    return node(
        "LanePosition", facing, roadId=place.road, laneId=place.lane, s=float(place.s_m), offset=float(place.offset_m)
    )


def world(pose: Pose) -> ET.Element:
    """A pose on flat ground."""
    x, y, heading = (round(float(v), 6) + 0.0 for v in (pose.x_m, pose.y_m, wrap_angle(pose.heading_rad)))
    return node("WorldPosition", x=x, y=y, z=0.0, h=heading)


# ------------------------------------------------------------------ triggers
def trigger(tag: str, groups: Sequence[Sequence[ET.Element]]) -> ET.Element:
    """A trigger that fires where all conditions of one group hold."""
    return node(tag, *(node("ConditionGroup", *group) for group in groups))


def of_entity(name: str, entity: str, condition: ET.Element) -> ET.Element:
    """A condition on one entity."""
    who = node("TriggeringEntities", node("EntityRef", entityRef=entity), triggeringEntitiesRule="any")
    return _condition(name, node("ByEntityCondition", who, node("EntityCondition", condition)))


def of_time(name: str, value: float | str, minor: int) -> ET.Element:
    """A condition on the clock: from a time on."""
    rule = "greaterOrEqual" if minor else "greaterThan"
    told = value if minor or value else -1.0
    return _condition(name, node("ByValueCondition", node("SimulationTimeCondition", value=told, rule=rule)))


def _condition(name: str, told: ET.Element) -> ET.Element:
    return node("Condition", told, name=name, delay=0.0, conditionEdge="none")


# ------------------------------------------------------------------ actions
def private(entity: str, actions: Sequence[ET.Element]) -> ET.Element:
    """What an entity does at the beginning."""
    return node("Private", *(node("PrivateAction", action) for action in actions), entityRef=entity)


def speed(value: float | str) -> ET.Element:
    """A speed at once."""
    how = node("SpeedActionDynamics", dynamicsShape="step", value=0.0, dynamicsDimension="time")
    target = node("SpeedActionTarget", node("AbsoluteTargetSpeed", value=value))
    return node("LongitudinalAction", node("SpeedAction", how, target))


def properties(told: dict[str, str]) -> ET.Element:
    """Names and values that a player may heed."""
    return node("Properties", *(node("Property", name=name, value=value) for name, value in told.items()))
