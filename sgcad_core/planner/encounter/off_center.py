"""A narrow thing that a vehicle strikes stands before one half of the side that strikes it, so that the blow turns it.

A blow at the very middle of a side stops a vehicle where it is, and is as rare as any other single place. The half is
that which turns the vehicle as the report tells. Knows encounters; no scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats, Size, sides_at
from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.aftermath.struck_objects import GLANCES
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.lines.departures import comes_back, side_of
from sgcad_core.planner.motion import Motion
from sgcad_core.records.specs import Actor, Area, size_m

NARROW_M = 1.2
"""A wider thing has no side of its own."""
SHARES = (0.45, 0.72, 0.25)
"""Of half the side: how far beside its middle the thing stands where the report tells a rotation or a facing."""
USUAL, STAYS_AT = 0.5, 0.2
"""The same where it tells neither, and where it tells that the vehicle comes to rest at the thing: hardly turned, it
stops there."""


def beside_middle(found: Encounter) -> list[Encounter]:
    """The encounter with the thing at several places along the side that strikes it, the likeliest first; [] where no
    narrow thing is struck."""
    return list(_beside_middle(found))


def at_corner(found: Encounter) -> Encounter | None:
    """The encounter with the thing at the corner of the vehicle that glances off it; None where none does so."""
    pair = (found.first.role, found.second.role), (found.second.role, found.first.role)
    if any(role.actor.record.thing and by.actor.record.wheeled and _glances(by, role) for role, by in pair):
        return next(_beside_middle(found), None)
    return None


def _beside_middle(found: Encounter) -> Iterator[Encounter]:
    meeting = found.meeting
    for thing, by in ((found.first, found.second), (found.second, found.first)):
        if not thing.role.actor.record.thing or max(thing.role.size) > NARROW_M or not by.role.actor.record.wheeled:
            continue
        first = thing is found.first
        motions = (meeting.first, meeting.first_s), (meeting.second, meeting.second_s)
        (here, at_s), (driven, by_s) = motions if first else motions[::-1]
        if not here.standing:
            continue
        for share in _shares(by.role, thing.role):
            moved = _moved(here, at_s, (driven.poses([by_s])[0], by.role.size), share)
            both = (moved, meeting.second) if first else (meeting.first, moved)
            yield found._replace(meeting=meeting._replace(first=both[0], second=both[1]))


def _shares(role: Role, thing: Role) -> tuple[float, ...]:
    """Signed shares of half a side: positive turns the vehicle counter-clockwise.

    A firm thing off which the vehicle glances stands as near the middle as lets it pass: on the outer side where it
    throws the vehicle back to the road.
    """
    if _glances(role, thing):
        back = comes_back(role.actor.maneuver, role.told)  # hardly held up first, so that it reaches the road
        turned = 0.0 if back else role.spins
        to_left = turned > 0 if turned else side_of(role.actor.maneuver, role.told.departs) == "left"
        shares = (1.0 + thing.size[1] / role.size[1] - 2 * overlap for overlap in (GLANCES[::-1] if back else GLANCES))
        return tuple(share if to_left else -share for share in shares)
    if role.spins:
        return tuple(math.copysign(share, role.spins) for share in SHARES)
    if role.skids_as_told:  # it turns already, and is not told to turn on
        return (-role.skids_as_told * SHARES[-1],)
    share = USUAL if role.told.rest.against is None else STAYS_AT
    return (share if side_of(role.actor.maneuver, role.told.departs) == "left" else -share,)


def _glances(role: Role, thing: Role) -> bool:
    """Whether a vehicle goes on past a firm, narrow thing that its front or back strikes."""
    return role.goes_on and is_passed(thing.actor, role.side)


def is_passed(thing: Actor, side: Area | None) -> bool:
    """Whether a vehicle that strikes a thing with a side and goes on glances off it: one that is firm and narrow."""
    return thing.firm and side in ("front", "back") and max(size_m(thing)) <= NARROW_M


def _moved(thing: Motion, at_s: float, striking: tuple[Floats, Size], share: float) -> Motion:
    """The thing moved along the side at which a vehicle, in a pose and of a size, strikes it."""
    by, size = striking
    center = thing.poses([at_s])[:, :2]
    (side,), _ = sides_at(by[None], size, center)
    out = float(by[2]) + side * math.pi / 2
    along = np.array([-math.sin(out), math.cos(out)])
    half = size[1 - side % 2] / 2
    is_at = float((center[0] - by[:2]) @ along)
    return replace(
        thing, path=thing.path.displaced(np.repeat([(share * half - is_at) * along], len(thing.path.points), 0))
    )
