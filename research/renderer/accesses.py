"""Driveways and side streets off a leg: where they lie on the sheet, and how they are drawn with an open mouth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageChops, ImageDraw

from research.generator.crash.world import Access
from research.renderer.lines import Band, Ground, Points
from research.renderer.masks import rounded
from research.renderer.pen import Pen
from sgcad_core.kinds import DRIVEWAY, ROAD

REACH = 14.0
"""Metres of a closed stub beyond the curb."""
BEYOND = 8.0
"""Metres of pavement beyond a mouth, cut off again: where its rounded end lies."""
HALF = {DRIVEWAY: 3.0, ROAD: 3.8}
CLEAR = 3.0
"""Metres between an open access and the junction's corner."""


def place(pen: Pen, ground: Ground, access: Access) -> float:
    """Metres from the hub to the middle of an access; an open one moves towards the hub until the sheet shows it."""
    band, half = ground.bands[access.leg], HALF[access.kind]
    at = min(float(access.distance_m), band.length - 6)
    if access.mouth is None:
        return at
    least = ground.setback(access.leg, CLEAR + half)
    while at - 2 > least and not pen.shows(band.at(at + half, _curb(ground, access)), 0.02):
        at -= 2
    return at


def box(pen: Pen, ground: Ground, access: Access, near: float = 0.0, far: float = REACH, wider: float = 0.0) -> Points:
    """Corners of an access, (4, 2), from the center line or `near` metres beyond the curb to `far` metres beyond it."""
    band, sign = ground.bands[access.leg], 1 if access.side == "right" else -1
    at, half, curb = place(pen, ground, access), HALF[access.kind] + wider, _curb(ground, access)
    inner, outer = (curb + sign * near if near else 0.0), curb + sign * far
    places = ((at - half, inner), (at + half, inner), (at + half, outer), (at - half, outer))
    return np.array([band.at(s, lateral)[0] for s, lateral in places])


def opened(pen: Pen, ground: Ground, found: Sequence[Access], area: Image.Image, corner: float) -> Image.Image:
    """The mask of the pavement with the open ones of `found`; corners in metres, never so wide that a mouth closes."""
    for access in found:
        if access.mouth is None:
            continue
        with_it = area.copy()
        ImageDraw.Draw(with_it).polygon(
            [tuple(p) for p in pen.px(box(pen, ground, access, far=access.mouth + BEYOND))], fill=255
        )
        radius = min(0.6 * corner, 0.8 * HALF[access.kind]) * pen.scale
        area = ImageChops.lighter(area, rounded(with_it, radius))
    return area


def beside(pen: Pen, ground: Ground, found: Sequence[Access], band: Band, side: str, s: Points) -> list[Points]:
    """Runs of places `s` (metres from the hub) along one side of a leg, without those at open mouths."""
    clear = np.full(len(s), True)
    for access in found:
        if access.mouth is not None and (access.leg, access.side) == (band.leg.bearing, side):
            clear &= np.abs(s - place(pen, ground, access)) > HALF[access.kind] + 1.0
    runs = np.split(np.arange(len(s)), np.flatnonzero(np.diff(clear)) + 1)
    return [s[run] for run in runs if len(run) > 1 and clear[run[0]]]


def cut(pen: Pen, ground: Ground, found: Sequence[Access], wider: float) -> None:
    """White beyond the mouths, `wider` metres more on either side than they are, so that their edges end there."""
    for access in found:
        if access.mouth is not None:
            beyond = box(pen, ground, access, access.mouth, access.mouth + BEYOND + wider, wider)
            pen.draw.polygon([tuple(p) for p in pen.px(beyond)], fill="white")


def _curb(ground: Ground, access: Access) -> float:
    """Lateral place of the curb that an access opens."""
    band = ground.bands[access.leg]
    return band.right if access.side == "right" else band.left
