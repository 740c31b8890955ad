"""A junction in words: legs, lanes, shape and control, the same words for a real junction and for a layout.

Full-text search compares words, so equal junctions must read alike: `describe` gives the indexed text of a real
junction and the query for the layout of a report. Knows no file format and no database.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from sgcad_core.records.specs import RoadLayout
from sgcad_core.roads.layout import bearing_rad, hub_control

_COUNTS = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven", 8: "eight"}
_CONTROLS = {
    "signal": "traffic signal (traffic light)", "flashing": "flashing signal", "stop": "stop signs on the minor road",
    "all_way_stop": "all-way stop", "yield": "yield signs on the minor road", "none": "no signs known",
}  # fmt: skip
_OPPOSITE = math.radians(30)
_SQUARE = math.radians(25)


class JunctionLeg(NamedTuple):
    """A road at a junction: its direction (radians counter-clockwise from east, seen from the hub) and its lanes."""

    angle_rad: float
    lanes_in: int
    lanes_out: int


def layout_legs(layout: RoadLayout) -> tuple[JunctionLeg, ...]:
    """The legs of a layout as `describe` takes them."""
    return tuple(JunctionLeg(bearing_rad(leg.bearing), leg.lanes_in, leg.lanes_out) for leg in layout.legs)


def describe_layout(layout: RoadLayout) -> str:
    """The query for a real junction like the hub of a layout: words, then `marks`."""
    legs = layout_legs(layout)
    return f"{describe(legs, hub_control(layout.legs))}\n{marks(legs)}"


def describe(legs: Sequence[JunctionLeg], control: str) -> str:
    """A sentence on the junction and one on each kind of leg, independent of the directions of the legs."""
    count = _COUNTS.get(len(legs), str(len(legs)))
    roads: dict[tuple[int, int], int] = {}
    for leg in sorted(legs, key=lambda leg: (-leg.lanes_in - leg.lanes_out, leg.lanes_in)):
        roads[leg.lanes_in, leg.lanes_out] = roads.get((leg.lanes_in, leg.lanes_out), 0) + 1
    parts = [f"{count}-leg junction ({shape(legs)}), {_CONTROLS.get(control, control)}"]
    parts += [f"{number} x {_leg(*lanes)}" for lanes, number in roads.items()]
    return "; ".join(parts)


def shape(legs: Sequence[JunctionLeg]) -> str:
    """The form in which the legs meet, in a reader's words."""
    angles = sorted(leg.angle_rad % math.tau for leg in legs)
    gaps = [(b - a) % math.tau for a, b in zip(angles, angles[1:] + angles[:1], strict=True)]
    if len(legs) == 3:
        if max(gaps) < math.pi + _OPPOSITE and max(gaps) > math.pi - _OPPOSITE:
            square = min(abs(g - math.pi / 2) for g in gaps) < _SQUARE
            return "T-intersection, side road" if square else "T-intersection, skewed side road"
        return "merge or fork" if max(gaps) > math.pi else "Y-intersection"
    if len(legs) == 4:
        square = all(abs(gap - math.pi / 2) < _SQUARE for gap in gaps)
        return "crossroads, four-way intersection" if square else "four-way intersection, skewed"
    return "multi-leg intersection" if len(legs) > 4 else "road"


def marks(legs: Sequence[JunctionLeg]) -> str:
    """Words that only junctions of equal legs and lanes share: "legs3 leg1in1out sig3n11n11n22"."""
    pairs = sorted((leg.lanes_in, leg.lanes_out) for leg in legs)
    signature = "".join(f"n{i}{o}" for i, o in pairs)
    each = [f"leg{i}in{o}out{k}" for k, (i, o) in enumerate(pairs)]
    plain = [f"leg{i}in{o}out" for i, o in dict.fromkeys(pairs)]
    return " ".join((f"legs{len(legs)}", *plain, *each, f"sig{len(legs)}{signature}"))


def _leg(lanes_in: int, lanes_out: int) -> str:
    total = lanes_in + lanes_out
    if not lanes_in or not lanes_out:
        way = "towards it" if lanes_in else "away from it"
        return f"one-way leg, {total} lane{'s' if total > 1 else ''} {way}"
    return f"leg of {total} lanes, {lanes_in} in and {lanes_out} out"
