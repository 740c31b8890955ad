"""The sides on which actors touch after the first contact, and whether the two that touched first do so again.

Knows poses on one clock and told sides; no report and no roads.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.plane import SIDES, Box, Floats, Size, contact_area, gaps_where_near, overlap_centers, sides_at
from sgcad_core.planner.scene import Scene, Track
from sgcad_core.records.specs import Area, Contact

MISSED = 1.5
"""Cost of a stated contact behind the first one that does not happen."""
NOT_AGAIN, WRONG_SIDE = 2.4, 1.0
"""The same of a second contact of the first two, and of each side on which it happens otherwise than stated: any second
contact is better than none."""
_APART = 3
"""Samples for which two are apart before they touch anew."""
_OVERLAP_M = 1e-6
"""Boxes that overlap less share no polygon."""
Sides = tuple[Area | None, Area | None]


def missed_again(scene: Scene, pair: frozenset[str]) -> float:
    """Cost of how a second contact of a pair comes about in a settled scene: 0 as stated."""
    names = sorted(pair)
    told = tuple(scene.sides.get(pair, {}).get(name) for name in names)
    one, other = (scene.tracks[name] for name in names)
    seen = _touches(one.poses, other.poses, one.size, other.size)
    return min((WRONG_SIDE * _differing(told, sides) for sides in seen[1:]), default=NOT_AGAIN)


def sides_missed(scene: Scene, contact: Contact) -> int:
    """The number of stated sides on which the first touch of two in a settled scene is another one, of a second contact
    the further ones; 0 where they do not touch."""
    one, other = scene.tracks[contact.striker], scene.tracks[contact.struck]
    told = contact.striker_area, contact.struck_area
    seen = _touches(one.poses, other.poses, one.size, other.size)
    again = scene.sides.get(frozenset((contact.striker, contact.struck)))
    further = again == {contact.striker: told[0], contact.struck: told[1]}
    return min((_differing(told, sides) for sides in (seen[1:] if further else seen[:1])), default=0)


def first_sides(one: Track, other: Track) -> tuple[Area, Area] | None:
    """The sides on which two tracks touch first; None where they never do."""
    return next(iter(_touches(one.poses, other.poses, one.size, other.size)), None)


def _differing(told: tuple[Area | None, ...], seen: tuple[Area, ...]) -> int:
    return sum(one is not None and one != other for one, other in zip(told, seen, strict=True))


def _touches(a: Floats, b: Floats, size: Size, other: Size) -> list[tuple[Area, Area]]:
    """The sides on which two tracks touch, each time anew."""
    met = np.flatnonzero(gaps_where_near(a, size, b, other) <= 0.0)
    begins = met[np.diff(met, prepend=-_APART - 1) > _APART]
    boxes = [(Box.at(a[k], size), Box.at(b[k], other)) for k in begins]
    return [(contact_area(one, two), contact_area(two, one)) for one, two in boxes]


def wrong_sides(first: tuple[Floats, Size], second: tuple[Floats, Size], told: Sides) -> NDArray[np.int_]:
    """(n,) number of sides other than told on which boxes in (n, 3) poses of a size overlap; 0 where they do not."""
    wrong = np.zeros(len(first[0]), int)
    at = np.flatnonzero(gaps_where_near(*first, *second) < -_OVERLAP_M)
    if len(at):
        centers = overlap_centers(first[0][at], first[1], second[0][at], second[1])
        for (poses, size), side in zip((first, second), told, strict=True):
            if side is not None:
                wrong[at] += sides_at(poses[at], size, centers)[0] != SIDES.index(side)
    return wrong
