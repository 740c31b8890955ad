"""Trajectories to OpenSCENARIO 1.0 to 1.3: timed world polylines for every actor, the same motion in every player.

Lane following, routes and time-to-collision triggers differ between players by metres; absolute times,
`position` following and condition edge `none` do not. Knows no planner and no road geometry.
"""

from __future__ import annotations

import datetime
import re
import threading
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import Literal

import numpy as np
from scenariogeneration import xosc
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.entities import center_ahead_m, entity, environment
from sgcad_core.formats.openscenario.vertices import vertex_rows
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.records import ActorInfo, Floats, Trajectory
from sgcad_core.specs import BehaviorSpec

Version = Literal["1.0", "1.1", "1.2", "1.3"]
DEFAULT_VERSION: Version = "1.2"
END = "EndTime"
"""The file's parameter for people who cut a scenario short: when it stops, seconds."""
_WRITING = threading.Lock()
"""scenariogeneration keeps its version in a class: one file at a time."""
DATE = datetime.datetime(2000, 1, 1, tzinfo=datetime.UTC)
"""Fixed, so that equal scenarios are equal files."""
_NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_xosc(
    actors: Sequence[ActorInfo],
    trajectories: Sequence[Trajectory],
    behavior: BehaviorSpec | None,
    road_file: str = "road.xodr",
    name: str = "crash",
    version: Version = DEFAULT_VERSION,
) -> str:
    """An .xosc that moves each actor's box center along its trajectory (positions to 1e-6 m, headings 1e-8 rad).

    What the file holds are the entities' origins, for vehicles the rear axle; trajectories are those of box centers.
    One trajectory an actor, at least two rows, times rising from 0. Raises InvalidOutput otherwise. The versions
    differ in names and in what surroundings they can tell; the motion is the same.
    """
    moves = [_origin(actor, t) for actor, t in zip(actors, _paired(actors, trajectories), strict=True)]
    minor, reaches = int(version[-1]), [center_ahead_m(actor) for actor in actors]
    with _WRITING:
        VersionBase().setVersion(minor=minor)
        scenario = xosc.Scenario(
            _NOT_XML.sub("?", name),
            "SG-CADVLM",
            _parameters(moves),
            _entities(actors, minor),
            _storyboard(moves, reaches, environment(behavior, minor)),
            xosc.RoadNetwork(road_file),
            xosc.Catalog(),
            osc_minor_version=minor,
            creation_date=DATE,
        )
        root = scenario.get_element()
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _parameters(moves: Sequence[Trajectory]) -> xosc.ParameterDeclarations:
    end = _number(max(t.t_s[-1] for t in moves))
    declared = xosc.ParameterDeclarations()
    declared.add_parameter(xosc.Parameter(END, xosc.ParameterType.double, str(end)))
    return declared


def _paired(actors: Sequence[ActorInfo], trajectories: Sequence[Trajectory]) -> list[Trajectory]:
    by_actor = {t.actor: t for t in trajectories}
    ids = [a.id for a in actors]
    if not ids or len(set(ids)) != len(ids) or sorted(by_actor) != sorted(ids) or len(trajectories) != len(ids):
        raise InvalidOutput(f"actors {ids} and trajectories {[t.actor for t in trajectories]}: give each actor one")
    for t in by_actor.values():
        rows = np.column_stack((t.t_s, t.x_m, t.y_m, t.heading_rad))
        if len(rows) < 2 or not np.isfinite(rows).all() or t.t_s[0] < 0 or (np.diff(t.t_s) <= 0).any():
            raise InvalidOutput(f"trajectory of {t.actor}: needs two or more finite rows with rising times from 0")
    return [by_actor[i] for i in ids]


def _origin(actor: ActorInfo, center: Trajectory) -> Trajectory:
    """The motion of the entity's origin, which lies behind the box center."""
    ahead, heading = center_ahead_m(actor), center.heading_rad
    x, y = center.x_m - ahead * np.cos(heading), center.y_m - ahead * np.sin(heading)
    return center.model_copy(update={"x_m": x, "y_m": y})


def _entities(actors: Sequence[ActorInfo], minor: int) -> xosc.Entities:
    entities = xosc.Entities()
    for actor in actors:
        entities.add_scenario_object(actor.id, entity(actor, minor))
    return entities


def _storyboard(
    moves: Sequence[Trajectory], ahead_m: Sequence[float], surroundings: xosc.Environment | None
) -> xosc.StoryBoard:
    end = _at("end", f"${END}", xosc.Rule.greaterThan, "stop")
    board = xosc.StoryBoard(_init(moves, surroundings), end)
    act = xosc.Act("act", _at_once("start"))
    for move, ahead in zip(moves, ahead_m, strict=True):
        act.add_maneuver_group(_group(move, vertex_rows(move, ahead)))
    story = xosc.Story("crash", xosc.ParameterDeclarations())
    story.add_act(act)
    board.add_story(story)
    return board


def _init(moves: Sequence[Trajectory], surroundings: xosc.Environment | None) -> xosc.Init:
    init = xosc.Init()
    if surroundings:
        init.add_global_action(xosc.EnvironmentAction(surroundings))
    at_once = xosc.TransitionDynamics(xosc.DynamicsShapes.step, xosc.DynamicsDimension.time, 0.0)
    for move in moves:
        place = _position(move.x_m[0], move.y_m[0], wrap_angle(move.heading_rad[0]))
        init.add_init_action(move.actor, xosc.TeleportAction(place))
        init.add_init_action(move.actor, xosc.AbsoluteSpeedAction(_number(move.speed_mps[0]), at_once))
    return init


def _group(move: Trajectory, rows: Sequence[int]) -> xosc.ManeuverGroup:
    path = xosc.Trajectory(f"{move.actor}_path", False)
    path.add_shape(xosc.Polyline([_number(move.t_s[k]) for k in rows], _positions(move, rows)))
    follow = xosc.FollowTrajectoryAction(path, xosc.FollowingMode.position, xosc.ReferenceContext.absolute, 1.0, 0.0)
    before = VersionBase().isVersionEqLess(minor=1)
    event = xosc.Event(f"{move.actor}_event", xosc.Priority.overwrite if before else xosc.Priority.override)
    event.add_trigger(_at_once(f"{move.actor}_start"))
    event.add_action(f"{move.actor}_follow", follow)
    maneuver = xosc.Maneuver(f"{move.actor}_maneuver")
    maneuver.add_event(event)
    group = xosc.ManeuverGroup(f"{move.actor}_group")
    group.add_actor(move.actor)
    group.add_maneuver(maneuver)
    return group


def _at_once(name: str) -> xosc.ValueTrigger:
    """From t = 0 on; version 1.0 has no "or equal"."""
    if VersionBase().isVersion(minor=0):
        return _at(name, -1.0, xosc.Rule.greaterThan, "start")
    return _at(name, 0.0, xosc.Rule.greaterOrEqual, "start")


def _at(name: str, time_s: float | str, rule: xosc.Rule, point: str) -> xosc.ValueTrigger:
    condition = xosc.SimulationTimeCondition(time_s, rule)
    return xosc.ValueTrigger(name, 0.0, xosc.ConditionEdge.none, condition, triggeringpoint=point)


def _positions(move: Trajectory, rows: Sequence[int]) -> list[xosc.WorldPosition]:
    return [_position(move.x_m[k], move.y_m[k], wrap_angle(move.heading_rad[k])) for k in rows]


def _position(x_m: float, y_m: float, heading_rad: float | Floats) -> xosc.WorldPosition:
    return xosc.WorldPosition(_number(x_m), _number(y_m), 0.0, _number(heading_rad, 8))


def _number(value: float | Floats, digits: int = 6) -> float:
    return round(float(value), digits) + 0.0  # never -0.0
