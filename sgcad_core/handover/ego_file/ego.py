"""The ego in its file: entity with a controller slot, start, route. Knows what three players ask for.

esmini reads the property esminiController, scenario_simulator_v2 isEgo, CARLA's scenario_runner the vehicle's type
and the controller's module.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.openscenario.roads.way import LanePlace
from sgcad_core.formats.openscenario.writing.entities import entity
from sgcad_core.formats.openscenario.writing.writer import origin_motion
from sgcad_core.handover.ego_file.elements import in_lane, lane_place, node, position, private, properties, speed
from sgcad_core.handover.ego_file.others import motion_of
from sgcad_core.handover.script import Staging

SPEED = "EgoSpeed"
CONTROLLER = "EgoController"
EXTERNAL = "ExternalController"
"""esmini's controller that waits for poses from outside."""
BEYOND_S = 6.0
"""The goal lies so far behind the conflict on the way of the report's driver."""
_OVERRIDES = ("Throttle", "Brake", "Clutch", "ParkingBrake", "SteeringWheel")
_OTHERS_IN_CARLA = "vehicle_velocity_control"


def scenario_object(actor: ActorInfo, minor: int, ego: bool) -> ET.Element:
    """An actor as an entity; the ego with a slot for the tester's controller."""
    body = entity(actor, minor).get_element()
    inside = [body]
    if ego:
        told = body.find("Properties")
        if told is not None:
            told.append(node("Property", name="type", value="ego_vehicle"))
        inside.append(node("ObjectController", _controller(minor)))
    return node("ScenarioObject", *inside, name=actor.id)


def _controller(minor: int) -> ET.Element:
    told = {"isEgo": "true", "module": "external_control", "esminiController": f"${CONTROLLER}"}
    inside = [node("ParameterDeclarations")] if minor == 0 else []
    return node("Controller", *inside, properties(told), name="ego_controller")


def ego_motion(staging: Staging, contact_s: float) -> Trajectory:
    """The origin's motion of the report's driver, up to some time behind the conflict."""
    center = motion_of(staging, staging.ego, contact_s, BEYOND_S)
    return origin_motion(staging.script.info(staging.ego), center)


def start_actions(move: Trajectory, roads: XodrRoads | None, minor: int) -> ET.Element:
    """The ego at the beginning: its place, its speed, its route, and that it waits for its driver."""
    actions = [node("TeleportAction", position(_pose(move, 0), roads)), speed(f"${SPEED}")]
    if minor and (route := route_of(move, roads)):
        actions.append(_route(f"{move.actor}_route", route))
    actions.append(_activated(minor))
    return private(move.actor, actions)


def route_of(move: Trajectory, roads: XodrRoads | None) -> tuple[LanePlace, ...]:
    """Start and goal in lanes, where roads lead from one to the other; else empty."""
    if roads is None or (start := lane_place(_pose(move, 0), roads)) is None:
        return ()
    goal = next((place for row in _backwards(move) if (place := _held(move, row, roads))), None)
    if goal is None or _same(start, goal):
        return ()
    try:
        roads.route([start, goal])
    except ValueError:
        return ()
    return start, goal._replace(offset_m=0.0)


def _backwards(move: Trajectory) -> range:
    """Rows from the last one on, a second apart."""
    return range(len(move.t_s) - 1, 0, -round(1 / STEP_S))


def _held(move: Trajectory, row: int, roads: XodrRoads) -> LanePlace | None:
    """The lane of a road, not of a junction, at a row."""
    place = roads.nearest(_pose(move, row)) if roads.covers(_pose(move, row)) else None
    return place if place and roads.road(place.road).junction == "-1" else None


def _same(start: LanePlace, goal: LanePlace) -> bool:
    return start.road == goal.road and abs(start.s_m - goal.s_m) < 1.0


def _pose(move: Trajectory, row: int) -> Pose:
    return Pose(float(move.x_m[row]), float(move.y_m[row]), float(np.float64(move.heading_rad[row])))


def _route(name: str, places: Sequence[LanePlace]) -> ET.Element:
    points = [node("Waypoint", node("Position", in_lane(place)), routeStrategy="shortest") for place in places]
    return node("RoutingAction", node("AssignRouteAction", node("Route", *points, name=name, closed=False)))


def _activated(minor: int) -> ET.Element:
    """The controller takes over; in version 1.0 it is assigned anew, as its schema wants."""
    if minor:
        return node("ControllerAction", node("ActivateControllerAction", longitudinal=True, lateral=True))
    return carla_controller("external_control")


def carla_controller(module: str = _OTHERS_IN_CARLA) -> ET.Element:
    """The controller by which CARLA's scenario_runner moves an actor, in version 1.0."""
    named = node("Controller", node("ParameterDeclarations"), properties({"module": module}), name=module)
    idle = [node(name, value=0.0, active=False) for name in _OVERRIDES]
    override = node("OverrideControllerValueAction", *idle, node("Gear", number=0.0, active=False))
    return node("ControllerAction", node("AssignControllerAction", named), override)
