"""Trajectories to OpenSCENARIO 1.0 to 1.3: timed world polylines for every actor, the same motion in every player.

Lane following, routes and time-to-collision triggers differ between players by metres; absolute times,
`position` following and condition edge `none` do not. Knows no planner and no road geometry.
"""

from __future__ import annotations

import datetime
import re
import threading
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from scenariogeneration import xosc
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.opendrive.signals import Controller
from sgcad_core.formats.openscenario.roads.lane_motion import start_place
from sgcad_core.formats.openscenario.roads.road_network import roads_of
from sgcad_core.formats.openscenario.writing.entities import center_ahead_m, entity, environment
from sgcad_core.formats.openscenario.writing.events import EventActor, EventOptions, event_actors
from sgcad_core.formats.openscenario.writing.parts import (
    CrossSection,
    PlannedEvent,
    at_once,
    at_time,
    group,
    lane_position,
    positions,
    rounded,
)
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_VERSION, Version
from sgcad_core.formats.openscenario.writing.vertices import held_at_standstill, vertex_rows
from sgcad_core.records.specs import BehaviorSpec, Contact

END, FRICTION, AFTER = "EndTime", "Friction", "TimeAfterContact"
"""Parameters of the file: when it stops, s; the friction of the road; how long it goes on behind the contact, s."""
FACES_RAD = 0.5
"""An actor that is turned further against its lane begins at a place in the world."""
_WRITING = threading.Lock()
DATE = datetime.datetime(2000, 1, 1, tzinfo=datetime.UTC)
"""Fixed, so that equal scenarios are equal files."""
_NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True)
class Handles:
    """Parameters by which people change a written scenario, at the values at which it is what was planned.

    `<actor>_TimeScale` (its motion slower above 1) and `<actor>_TimeOffset` (later, seconds) of timed polylines,
    `<actor>_Speed` (at the start, m/s) of events, `Friction` where the surface is stated, `TimeAfterContact` where a
    contact is declared (as long as the file: at 0 it stops there). With `xodr` actors begin at places in lanes, where
    lanes hold them to the millimetre.
    """

    xodr: str | None = None


@contextmanager
def library_version(minor: int) -> Iterator[None]:
    """Within it scenariogeneration writes version 1.`minor`; it keeps its version in a class, so one file at a time."""
    base = VersionBase()
    with _WRITING:
        before = base.version_minor
        base.setVersion(minor=minor)
        try:
            yield
        finally:
            base.setVersion(minor=before)


def write_xosc(
    actors: Sequence[ActorInfo],
    trajectories: Sequence[Trajectory],
    behavior: BehaviorSpec | None,
    road_file: str = "road.xodr",
    name: str = "crash",
    version: Version = DEFAULT_VERSION,
    handover: EventOptions | None = None,
    signals: Sequence[Controller] = (),
    handles: Handles | None = None,
) -> str:
    """An .xosc that moves each actor's box center along its trajectory (positions to 1e-6 m, headings 1e-8 rad).

    What the file holds are the entities' origins, for vehicles the rear axle; trajectories are those of box centers.
    One trajectory per actor, at least two rows, times rising from 0. Raises InvalidOutput otherwise. The versions
    differ in names and in the surroundings they can express; the motion is the same. With a `handover` the plan is
    written as maneuver events (`events`): near the trajectories until the contact, free after it. `signals`: the states
    of the map's controllers in turn, from the start on.
    `handles`: parameters and lane places, which leave the motion as it is.
    """
    moves = [origin_motion(actor, t) for actor, t in zip(actors, _paired(actors, trajectories), strict=True)]
    minor, reaches = int(version[-1]), [center_ahead_m(actor) for actor in actors]
    sizes = [(actor.width_m, actor.record.height_m) for actor in actors]
    timed = [
        _Timed(held_at_standstill(m), ahead, size, handles)
        for m, ahead, size in zip(moves, reaches, sizes, strict=True)
    ]
    told = timed if handover is None else None
    parts = told or event_actors(moves, reaches, handover or EventOptions())
    with library_version(minor):
        surroundings = environment(behavior, minor)
        declared = {END: rounded(max(t.t_s[-1] for t in moves))} | _handles(parts, surroundings, handles)
        contact = behavior.contacts[0] if handles and behavior and behavior.contacts and told else None
        declared |= {AFTER: declared[END]} if contact else {}
        scenario = xosc.Scenario(
            _NOT_XML.sub("?", name),
            "SG-CADVLM",
            _parameters(declared),
            _entities(actors, minor),
            _storyboard(parts, surroundings, _stop(contact), speeds=bool(handles) and told is None),
            _road_network(road_file, signals),
            xosc.Catalog(),
            osc_minor_version=minor,
            creation_date=DATE,
        )
        root = scenario.get_element()
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _road_network(road_file: str, signals: Sequence[Controller]) -> xosc.RoadNetwork:
    """The map, and the phases of its signals by the ids of its controllers."""
    network = xosc.RoadNetwork(road_file)
    for controller in signals:
        told = xosc.TrafficSignalController(controller.id)
        for k, shown in enumerate(controller.phases, 1):
            phase = xosc.Phase(f"{k} {next(iter(shown.states.values()), 'off')}", rounded(shown.duration_s))
            for head, state in shown.states.items():
                phase.add_signal_state(head, state)
            told.add_phase(phase)
        network.add_traffic_signal_controller(told)
    return network


def _parameters(told: Mapping[str, float]) -> xosc.ParameterDeclarations:
    declared = xosc.ParameterDeclarations()
    for name, value in told.items():
        declared.add_parameter(xosc.Parameter(name, xosc.ParameterType.double, f"{value:.9g}"))
    return declared


def _handles(
    parts: Sequence[_Timed] | Sequence[EventActor], surroundings: xosc.Environment | None, handles: Handles | None
) -> dict[str, float]:
    """Names and values of the parameters beside the end; puts the friction's in its place."""
    found: dict[str, float] = {}
    for part in parts if handles else ():
        name = part.move.actor
        found |= part.clock if isinstance(part, _Timed) else {f"{name}_Speed": rounded(part.first_mps)}
    if handles and surroundings and surroundings.roadcondition:
        found[FRICTION] = float(surroundings.roadcondition.friction_scale_factor)
        surroundings.roadcondition.friction_scale_factor = f"${FRICTION}"
    return found


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


def origin_motion(actor: ActorInfo, center: Trajectory) -> Trajectory:
    """The motion of the entity's origin, which lies behind the box center."""
    ahead, heading = center_ahead_m(actor), center.heading_rad
    x, y = center.x_m - ahead * np.cos(heading), center.y_m - ahead * np.sin(heading)
    return center.model_copy(update={"x_m": x, "y_m": y})


def _entities(actors: Sequence[ActorInfo], minor: int) -> xosc.Entities:
    entities = xosc.Entities()
    for actor in actors:
        entities.add_scenario_object(actor.id, entity(actor, minor))
    return entities


@dataclass(frozen=True)
class _Timed:
    """One actor whose origin's whole motion is a timed polyline."""

    move: Trajectory
    ahead_m: float
    size: CrossSection
    handles: Handles | None = None

    @property
    def first_mps(self) -> float:
        return float(self.move.speed_mps[0])

    @property
    def clock(self) -> dict[str, float]:
        """Parameters of its time with their values."""
        return {f"{self.move.actor}_TimeScale": 1.0, f"{self.move.actor}_TimeOffset": 0.0}

    def start(self) -> xosc.WorldPosition | xosc.LanePosition:
        roads = roads_of(self.handles.xodr) if self.handles and self.handles.xodr else None
        place, turn = start_place(self.move, roads) if roads else (None, 0.0)
        if place is None or abs(turn) > FACES_RAD:
            return positions(self.move, [0])[0]
        return lane_position(place, turn)

    def init_actions(self) -> tuple[object, ...]:
        return ()

    def group(self) -> xosc.ManeuverGroup:
        name, rows = self.move.actor, vertex_rows(self.move, self.ahead_m)
        path = xosc.Trajectory(f"{name}_path", False)
        path.add_shape(xosc.Polyline([rounded(self.move.t_s[k]) for k in rows], positions(self.move, rows, self.size)))
        absolute = xosc.ReferenceContext.absolute
        scale, offset = [f"${handle}" for handle in self.clock] if self.handles else (1.0, 0.0)
        follow = xosc.FollowTrajectoryAction(path, xosc.FollowingMode.position, absolute, scale, offset)
        event = PlannedEvent(f"{name}_event", f"{name}_follow", at_once(f"{name}_start"), follow)
        return group(name, {f"{name}_maneuver": [event]})


def _stop(contact: Contact | None) -> xosc.Trigger:
    """What ends the file: the clock, or a time behind the declared contact."""
    ends = [at_time("end", f"${END}", xosc.Rule.greaterThan, "stop")]
    if contact:
        touched = xosc.CollisionCondition(contact.struck)
        told = "after_contact", f"${AFTER}", xosc.ConditionEdge.none, touched, contact.striker
        ends.append(xosc.EntityTrigger(*told, triggeringpoint="stop"))
    stop = xosc.Trigger("stop")
    for end in ends:
        group_of_one = xosc.ConditionGroup("stop")
        group_of_one.add_condition(end)
        stop.add_conditiongroup(group_of_one)
    return stop


def _storyboard(
    actors: Sequence[_Timed] | Sequence[EventActor],
    surroundings: xosc.Environment | None,
    stop: xosc.Trigger,
    *,
    speeds: bool,
) -> xosc.StoryBoard:
    board = xosc.StoryBoard(_init(actors, surroundings, speeds=speeds), stop)
    act = xosc.Act("act", at_once("start"))
    for actor in actors:
        act.add_maneuver_group(actor.group())
    story = xosc.Story("crash", xosc.ParameterDeclarations())
    story.add_act(act)
    board.add_story(story)
    return board


def _init(
    actors: Sequence[_Timed] | Sequence[EventActor], surroundings: xosc.Environment | None, *, speeds: bool
) -> xosc.Init:
    init = xosc.Init()
    if surroundings:
        init.add_global_action(xosc.EnvironmentAction(surroundings))
    step = xosc.TransitionDynamics(xosc.DynamicsShapes.step, xosc.DynamicsDimension.time, 0.0)
    for actor in actors:
        init.add_init_action(actor.move.actor, xosc.TeleportAction(actor.start()))
        for action in actor.init_actions():
            init.add_init_action(actor.move.actor, action)
        first = f"${actor.move.actor}_Speed" if speeds else rounded(actor.first_mps)
        init.add_init_action(actor.move.actor, xosc.AbsoluteSpeedAction(first, step))
    return init
