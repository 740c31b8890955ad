"""Lane markings: as stated, else those of U.S. roads (MUTCD 2009, part 3B). Knows no XML."""

from __future__ import annotations

from typing import NamedTuple

from sgcad_core.formats.opendrive.streets import RoadLane, Street
from sgcad_core.formats.sumo.parameters import CENTER_LINE, KIND, MEDIAN
from sgcad_core.kinds import UNPAINTED

LINE_M = 0.12
"""Width of one normal line (4 to 6 in)."""


class Mark(NamedTuple):
    """A marking along a lane's outer border (of lane 0: along the center)."""

    type: str
    color: str = "standard"

    @property
    def lane_change(self) -> str:
        """Whether it may be crossed, as OpenDRIVE says it."""
        return {"broken": "both", "broken broken": "both", "none": "both"}.get(self.type, "none")


NONE = Mark("none")
EDGE = Mark("solid", "white")
LANE = Mark("broken", "white")
DOUBLE = Mark("solid solid", "yellow")
LEFT_EDGE = Mark("solid", "yellow")
INTO_CENTER_LANE, OUT_OF_CENTER_LANE = Mark("solid broken", "yellow"), Mark("broken solid", "yellow")
"""At a two-way left-turn lane: the broken line on its side. Lane 0 is read from left to right, others outwards."""
TOLD = {
    "double_yellow": DOUBLE, "broken_yellow": Mark("broken", "yellow"), "solid_yellow": Mark("solid", "yellow"),
    "broken_white": LANE, "none": NONE,
}  # fmt: skip


def center_mark(street: Street) -> Mark:
    """The marking along lane 0."""
    if _unmarked(street):
        return NONE
    if street.backward is None:
        return LEFT_EDGE
    if any(s.type == "median" for s in (*street.left, *street.right)):
        return NONE
    if any(s.type == "bidirectional" for s in street.right):
        return INTO_CENTER_LANE
    return TOLD.get(street.forward.parameters.get(CENTER_LINE, ""), DOUBLE)


def outer_mark(street: Street, strip: RoadLane) -> Mark:
    """The marking along a lane's outer border."""
    if _unmarked(street) or strip.type in ("shoulder", "sidewalk", "curb", "border", "parking"):
        return NONE
    if strip.type == "median":
        return DOUBLE if street.forward.parameters.get(MEDIAN) == "painted" else LEFT_EDGE
    if strip.type == "bidirectional":
        return OUT_OF_CENTER_LANE
    side = street.strips("right" if strip.id < 0 else "left")
    outside = next((s for s in side if abs(s.id) == abs(strip.id) + 1), None)
    if strip.type == "biking" and (outside is None or outside.type == "curb"):
        return NONE
    return LANE if outside is not None and outside.type == "driving" else EDGE


def _unmarked(street: Street) -> bool:
    """Driveways and alleys carry no paint."""
    return street.forward.parameters.get(KIND) in UNPAINTED
