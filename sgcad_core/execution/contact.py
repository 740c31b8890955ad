"""The first contact in an execution (box overlap over all pairs of actors), and the closest approach of two.

Knows trajectories and sizes; not the declared contact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import cast

import numpy as np

from sgcad_core.case.records import ClosestApproach, ObservedContact, Trajectory
from sgcad_core.geometry.distances import box_distances
from sgcad_core.geometry.plane import Box, Size, contact_area, first_overlap
from sgcad_core.records.specs import Contact, NearCrash

STILL_M = 1e-3
"""An actor that stays within this distance of its start has not moved."""
CLEARANCE_TOLERANCE_M = 0.05
"""A near crash is as declared if its closest approach is off by no more."""
UNTOLD_CLEARANCE_M = (0.2, 1.5)
"""How near the two come in a near crash whose report does not tell it: "nearly hit" is less than the width of a car."""


def first_contact(trajectories: Sequence[Trajectory], sizes: Mapping[str, Size]) -> ObservedContact | None:
    """The earliest step at which any two boxes share a point; None if nothing touches.

    Pairs are ordered by actor id, since an overlap does not show the striker; of pairs that touch in the same step the
    first in that order counts. Pairs that overlap from the start and never move are parts of one object or scenery:
    skipped. Sizes are length and width, metres.
    """
    ordered = sorted(trajectories, key=lambda t: t.actor)
    hits = ((_first_hit(a, b, sizes), i, a, b) for i, (a, b) in enumerate(combinations(ordered, 2)))
    found = min((hit for hit in hits if hit[0] is not None), key=lambda hit: hit[:2], default=None)
    if found is None:
        return None
    k, _, a, b = found
    return observe(a, b, cast("int", k), sizes)


def first_with(mine: Trajectory, others: Sequence[Trajectory], sizes: Mapping[str, Size]) -> ObservedContact | None:
    """One actor's first contact with any of the others."""
    seen = [c for other in others if (c := first_contact((mine, other), sizes)) is not None]
    return min(seen, key=lambda c: c.t_s, default=None)


def realised(declared: Contact | None, observed: ObservedContact | None) -> bool:
    """Whether the first contact is the declared pair with the declared areas, in either order."""
    return declared is not None and observed is not None and observed.is_of(declared)


def closest_approach(
    trajectories: Sequence[Trajectory], sizes: Mapping[str, Size], pair: tuple[str, str]
) -> ClosestApproach | None:
    """The closest approach of two actors over the whole execution; None unless both take part."""
    found = {t.actor: t for t in trajectories}
    if not set(pair) <= set(found):
        return None
    a, b = (found[name] for name in pair)
    n = min(len(a.t_s), len(b.t_s))
    apart = box_distances(a.pose[:n], sizes[a.actor], b.pose[:n], sizes[b.actor])
    k = int(apart.argmin())
    return ClosestApproach(
        actor=a.actor, other=b.actor, clearance_m=round(float(apart[k]), 3), t_s=round(float(a.t_s[k]), 6)
    )


def avoided(near: NearCrash, contact: ObservedContact | None, closest: ClosestApproach | None) -> bool:
    """Whether a near crash is as declared: no contact, and the declared clearance of the pair."""
    if contact is not None or closest is None:
        return False
    if near.clearance_m is None:
        return UNTOLD_CLEARANCE_M[0] <= closest.clearance_m <= UNTOLD_CLEARANCE_M[1]
    return abs(closest.clearance_m - near.clearance_m) <= CLEARANCE_TOLERANCE_M


def observe(a: Trajectory, b: Trajectory, k: int, sizes: Mapping[str, Size]) -> ObservedContact:
    """The contact of two actors at step k, with the sides that touch."""
    one, two = (Box.at(t.pose[k], sizes[t.actor]) for t in (a, b))
    areas = {"actor_area": contact_area(one, two), "other_area": contact_area(two, one)}
    return ObservedContact(actor=a.actor, other=b.actor, t_s=round(float(a.t_s[k]), 6), **areas)


def moves(trajectory: Trajectory) -> bool:
    """Whether an actor leaves its place."""
    way = np.hypot(trajectory.x_m - trajectory.x_m[0], trajectory.y_m - trajectory.y_m[0])
    return bool(way.max() > STILL_M)


def _first_hit(a: Trajectory, b: Trajectory, sizes: Mapping[str, Size]) -> int | None:
    n = min(len(a.t_s), len(b.t_s))
    hit = first_overlap(a.pose[:n], sizes[a.actor], b.pose[:n], sizes[b.actor])
    return None if hit == 0 and not moves(a) and not moves(b) else hit
