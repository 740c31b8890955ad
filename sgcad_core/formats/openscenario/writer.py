"""Trajectories to OpenSCENARIO 1.2: timed world polylines for every actor, the same motion in every player.

Lane following, routes and time-to-collision triggers differ between players by metres; absolute times,
`position` following and condition edge `none` do not. Knows no planner and no road geometry.
"""

from __future__ import annotations

import datetime
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence

import numpy as np
from scenariogeneration import xosc
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.entities import center_ahead_m, entity, environment
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.records import ActorInfo, Floats, Trajectory
from sgcad_core.specs import BehaviorSpec

MINOR_VERSION = 2
DATE = datetime.datetime(2000, 1, 1, tzinfo=datetime.UTC)
"""Fixed, so that equal scenarios are equal files."""
_NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_xosc(
    actors: Sequence[ActorInfo],
    trajectories: Sequence[Trajectory],
    behavior: BehaviorSpec | None,
    road_file: str = "road.xodr",
    name: str = "crash",
) -> str:
    """An .xosc that moves each actor's box center along its trajectory (positions to 1e-6 m, headings 1e-8 rad).

    What the file holds are the entities' origins, for vehicles the rear axle; trajectories are those of box centers.
    One trajectory an actor, at least two rows, times rising from 0. Raises InvalidOutput otherwise.
    """
    VersionBase().setVersion(minor=MINOR_VERSION)  # scenariogeneration keeps its version in a class
    moves = [_origin(actor, t) for actor, t in zip(actors, _paired(actors, trajectories), strict=True)]
    scenario = xosc.Scenario(
        _NOT_XML.sub("?", name),
        "SG-CADVLM",
        xosc.ParameterDeclarations(),
        _entities(actors),
        _storyboard(moves, behavior),
        xosc.RoadNetwork(road_file),
        xosc.Catalog(),
        osc_minor_version=MINOR_VERSION,
        creation_date=DATE,
    )
    root = scenario.get_element()
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


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


def _entities(actors: Sequence[ActorInfo]) -> xosc.Entities:
    entities = xosc.Entities()
    for actor in actors:
        entities.add_scenario_object(actor.id, entity(actor))
    return entities


def _storyboard(moves: Sequence[Trajectory], behavior: BehaviorSpec | None) -> xosc.StoryBoard:
    end = _at("end", _number(max(t.t_s[-1] for t in moves)), xosc.Rule.greaterThan, "stop")
    board = xosc.StoryBoard(_init(moves, behavior), end)
    act = xosc.Act("act", _at("start", 0.0, xosc.Rule.greaterOrEqual, "start"))
    for move in moves:
        act.add_maneuver_group(_group(move))
    story = xosc.Story("crash", xosc.ParameterDeclarations())
    story.add_act(act)
    board.add_story(story)
    return board


def _init(moves: Sequence[Trajectory], behavior: BehaviorSpec | None) -> xosc.Init:
    init = xosc.Init()
    if surroundings := environment(behavior):
        init.add_global_action(xosc.EnvironmentAction(surroundings))
    at_once = xosc.TransitionDynamics(xosc.DynamicsShapes.step, xosc.DynamicsDimension.time, 0.0)
    for move in moves:
        place = _position(move.x_m[0], move.y_m[0], wrap_angle(move.heading_rad[0]))
        init.add_init_action(move.actor, xosc.TeleportAction(place))
        init.add_init_action(move.actor, xosc.AbsoluteSpeedAction(_number(move.speed_mps[0]), at_once))
    return init


def _group(move: Trajectory) -> xosc.ManeuverGroup:
    path = xosc.Trajectory(f"{move.actor}_path", False)
    path.add_shape(xosc.Polyline([_number(t) for t in move.t_s], _positions(move)))
    follow = xosc.FollowTrajectoryAction(path, xosc.FollowingMode.position, xosc.ReferenceContext.absolute, 1.0, 0.0)
    event = xosc.Event(f"{move.actor}_event", xosc.Priority.override)
    event.add_trigger(_at(f"{move.actor}_start", 0.0, xosc.Rule.greaterOrEqual, "start"))
    event.add_action(f"{move.actor}_follow", follow)
    maneuver = xosc.Maneuver(f"{move.actor}_maneuver")
    maneuver.add_event(event)
    group = xosc.ManeuverGroup(f"{move.actor}_group")
    group.add_actor(move.actor)
    group.add_maneuver(maneuver)
    return group


def _at(name: str, time_s: float, rule: xosc.Rule, point: str) -> xosc.ValueTrigger:
    condition = xosc.SimulationTimeCondition(time_s, rule)
    return xosc.ValueTrigger(name, 0.0, xosc.ConditionEdge.none, condition, triggeringpoint=point)


def _positions(move: Trajectory) -> list[xosc.WorldPosition]:
    return [_position(*row) for row in zip(move.x_m, move.y_m, wrap_angle(move.heading_rad), strict=True)]


def _position(x_m: float, y_m: float, heading_rad: float | Floats) -> xosc.WorldPosition:
    return xosc.WorldPosition(_number(x_m), _number(y_m), 0.0, _number(heading_rad, 8))


def _number(value: float | Floats, digits: int = 6) -> float:
    return round(float(value), digits) + 0.0  # never -0.0
