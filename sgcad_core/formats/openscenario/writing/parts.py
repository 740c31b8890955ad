"""Parts that both encodings of a plan are made of: numbers, places, triggers by the clock, maneuver groups."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from scenariogeneration import xosc
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.case.records import Floats, Trajectory
from sgcad_core.formats.openscenario.roads.way import LanePlace
from sgcad_core.geometry.plane import wrap_angle

CrossSection = tuple[float, float]
"""Width and height of a body, metres."""


class PlannedEvent(NamedTuple):
    """One event: names, what starts it, what it does."""

    name: str
    action: str
    when: xosc.ValueTrigger | xosc.EntityTrigger
    does: object


def rounded(value: float | Floats, digits: int = 6) -> float:
    """A number as it is written; never -0.0."""
    return round(float(value), digits) + 0.0


def world_position(x_m: float, y_m: float, heading_rad: float | Floats) -> xosc.WorldPosition:
    """A pose on flat ground."""
    return xosc.WorldPosition(rounded(x_m), rounded(y_m), 0.0, rounded(heading_rad, 8))


def lane_position(place: LanePlace, turned_rad: float | None = None) -> xosc.LanePosition:
    """A place in a lane, and the heading against the lane's direction where it counts."""
    relative = xosc.ReferenceContext.relative
    facing = (
        xosc.Orientation() if turned_rad is None else xosc.Orientation(h=rounded(turned_rad, 8), reference=relative)
    )
    return xosc.LanePosition(rounded(place.s_m), rounded(place.offset_m), str(place.lane), place.road, facing)


def positions(move: Trajectory, rows: Sequence[int], size: CrossSection = (0.0, 0.0)) -> list[xosc.WorldPosition]:
    """Poses of some rows of a motion; of one that rolls over also roll and height, so that its lowest edge is on the
    ground. `size`: width and height, metres."""
    places = [world_position(move.x_m[k], move.y_m[k], wrap_angle(move.heading_rad[k])) for k in rows]
    if move.roll_rad is not None:
        for place, k in zip(places, rows, strict=True):
            roll = float(move.roll_rad[k])
            place.z, place.p, place.r = rounded(_lift_m(roll, size)), 0.0, rounded(roll, 8)
    return places


def _lift_m(roll_rad: float, size: CrossSection) -> float:
    """How far the origin, on the ground between the wheels, rises so that no edge of the body lies below the ground."""
    width, height = size
    edges = [(y, z) for y in (-width / 2, width / 2) for z in (0.0, height)]
    return -min(y * math.sin(roll_rad) + z * math.cos(roll_rad) for y, z in edges)


def at_once(name: str) -> xosc.ValueTrigger:
    """From t = 0 on; version 1.0 has no "or equal"."""
    return from_time(name, 0.0)


def from_time(name: str, time_s: float) -> xosc.ValueTrigger:
    """From a time on, that instant included; version 1.0 has no "or equal" and gets a little less (at 0: -1)."""
    if VersionBase().isVersion(minor=0):
        return at_time(name, rounded(time_s - 1e-3) if time_s else -1.0, xosc.Rule.greaterThan, "start")
    return at_time(name, rounded(time_s), xosc.Rule.greaterOrEqual, "start")


def at_time(name: str, time_s: float | str, rule: xosc.Rule, point: str) -> xosc.ValueTrigger:
    """A trigger by the clock alone."""
    condition = xosc.SimulationTimeCondition(time_s, rule)
    return xosc.ValueTrigger(name, 0.0, xosc.ConditionEdge.none, condition, triggeringpoint=point)


def group(actor: str, maneuvers: Mapping[str, Sequence[PlannedEvent]]) -> xosc.ManeuverGroup:
    """What one actor does: events by maneuver; within one maneuver a later event ends an earlier one."""
    before = VersionBase().isVersionEqLess(minor=1)
    made = xosc.ManeuverGroup(f"{actor}_group")
    made.add_actor(actor)
    for name, happenings in maneuvers.items():
        maneuver = xosc.Maneuver(name)
        for happening in happenings:
            event = xosc.Event(happening.name, xosc.Priority.overwrite if before else xosc.Priority.override)
            event.add_trigger(happening.when)
            event.add_action(happening.action, happening.does)
            maneuver.add_event(event)
        made.add_maneuver(maneuver)
    return made
