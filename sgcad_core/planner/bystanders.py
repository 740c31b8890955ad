"""Actors outside the contacts, kept clear of them.

Works on a scene that already holds the contacts. Knows motion options and tracks.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.encounter.motion_options import Option, forced, options
from sgcad_core.planner.motion import Motion
from sgcad_core.planner.scene import CLEAR_M, Scene

_OWN_S = (-0.8, -1.6, -2.4, 0.8, -3.2, -4.0, 1.6, -5.0, 2.4, -6.0, 3.2, -7.5, 4.0, -9.0)
"""Own times at the first contact that are tried, in this order: a little behind its own place comes first."""
_FAR_S = (-11.0, 6.0, -13.0, 8.0, -15.0, 11.0, -18.0, -22.0, -27.0, 15.0)
_STANDING_S = (0.0, -1.3, -2.6, 1.3, -3.9, -5.2, 2.6, -6.5, -8.0, 4.0, -10.0, -12.5)
_WAYS = 6


def place_clear(scene: Scene, role: Role, *, passes: bool = False) -> str | None:
    """Places an actor outside the contacts; one that `passes` does not stop for them where its way stays free. Returns
    a note where it could not be kept clear to the end."""
    best: tuple[int, Motion, float] | None = None
    goes_on = False
    for motion, own in _tries(role):
        free = scene.clear_until(scene.poses(motion, own, brakes=True), motion.size, CLEAR_M)
        if best is None or free > best[0]:
            best = (free, motion, own)
        if free == scene.count:
            goes_on = (
                passes
                and scene.clear_until(scene.poses(motion, own, brakes=False), motion.size, CLEAR_M) == scene.count
            )
            break
    if best is None:
        return None
    scene.add(role.actor.id, role.actor.kind, best[1], best[2], brakes=not goes_on)
    return f"{role.actor.id} could not be kept clear of the others" if best[0] < scene.count else None


def _tries(role: Role) -> Iterator[tuple[Motion, float]]:
    found = options(role)
    ways = (_plain(found) or found or forced(role))[:_WAYS]
    if not ways:
        return
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
    return [way for way in ways if not way.twist.angle_rad or way.twist.told or way.role.actor.record.thing]
