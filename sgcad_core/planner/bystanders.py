"""Actors outside the first contact: kept clear of it, or led into the later contact that is declared for them.

Works on a scene that already holds the first contact. Knows motion options and tracks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.encounter.encounter_search import find_meeting
from sgcad_core.planner.encounter.motion_options import Option, forced, in_path_of, options
from sgcad_core.planner.motion import STEP_S, Motion
from sgcad_core.planner.scene import CLEAR_M, Scene
from sgcad_core.records.specs import Area

_OWN_S = (-0.8, -1.6, -2.4, 0.8, -3.2, -4.0, 1.6, -5.0, 2.4, -6.0, 3.2, -7.5, 4.0, -9.0)
"""Own times at the first contact that are tried, in this order: a little behind its own place comes first."""
_FAR_S = (-11.0, 6.0, -13.0, 8.0, -15.0, 11.0, -18.0, -22.0, -27.0, 15.0)
_STANDING_S = (0.0, -1.3, -2.6, 1.3, -3.9, -5.2, 2.6, -6.5, -8.0, 4.0, -10.0, -12.5)
_WAYS = 6
_LATER_WAYS = 6
_LATER_S = ((0.7, 3.5), (0.1, 0.7))
"""Time spans after the first contact in which a later one is searched: the first pair has parted by then."""
_OUTSIDE = 20.0


def place_clear(scene: Scene, role: Role) -> str | None:
    """Places an actor outside the contacts. Returns a note where it could not be kept clear to the end."""
    best: tuple[int, Motion, float] | None = None
    for motion, own in _tries(role):
        poses = scene.poses(motion, own, brakes=True)
        free = scene.clear_until(poses, motion.size, CLEAR_M)
        if best is None or free > best[0]:
            best = (free, motion, own)
        if free == scene.count:
            break
    if best is None:
        return None
    scene.add(role.actor.id, role.actor.kind, best[1], best[2], brakes=True)
    return f"{role.actor.id} could not be kept clear of the others" if best[0] < scene.count else None


def _tries(role: Role) -> Iterator[tuple[Motion, float]]:
    ways = _plain(options(role))[:_WAYS]
    standing = ways[0].motion.standing
    for own in _STANDING_S if standing else _OWN_S:
        for way in ways[: 3 if standing else 1]:
            yield way.motion, own
    for way in ways[1:]:
        for own in _STANDING_S if standing else _OWN_S:
            yield way.motion, own
    for own in _FAR_S:
        yield ways[0].motion, own


def _plain(ways: Sequence[Option]) -> list[Option]:
    return [way for way in ways if not way.twist.angle_rad or way.role.actor.record.thing]


def place_for_later_contact(scene: Scene, role: Role, partner: str, sides: tuple[Area, Area]) -> bool:
    """Places an actor so that a partner in the scene touches it after the first contact. Returns whether it did.

    `sides`: of the partner and of the actor; any sides are taken where the wanted ones are not reached.
    """
    wanted: tuple[tuple[Area, Area] | None, ...] = (sides, None)
    ways = options(role)[:_LATER_WAYS] + forced(role)[:_LATER_WAYS]
    return any(
        _struck_by(scene, scene.replay(partner, *span), way, partner, (sides[0], want))
        for want in wanted
        for span in _LATER_S
        for way in ways
    )


def _struck_by(
    scene: Scene, replay: Motion, way: Option, partner: str, sides: tuple[Area, tuple[Area, Area] | None]
) -> bool:
    motion = in_path_of(way, replay, sides[0]) if way.role.actor.record.thing else way.motion
    if not motion.drivable:
        return False
    found = find_meeting(replay, replace(motion, penalty=0 * motion.penalty), sides[1])
    if found is None or found.cost > _OUTSIDE:
        return False
    return _placed(scene, way.role, motion, found.first_s, found.second_s)


def _placed(scene: Scene, role: Role, motion: Motion, partner_s: float, own_s: float) -> bool:
    """Adds the actor unless it touches another one earlier, and lets the two collide."""
    step = math.ceil(partner_s / STEP_S - 1e-6)
    at_contact = own_s if motion.standing else own_s - partner_s
    poses = scene.poses(motion, at_contact, brakes=False)
    k = scene.contact + step
    if not scene.contact < k < scene.count or scene.clear_until(poses, motion.size, 0.0) < k:
        return False
    scene.add(role.actor.id, role.actor.kind, motion, at_contact, brakes=False)
    scene.settle()
    return True
