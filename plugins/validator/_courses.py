"""The starts and exits that an actor may take, as a finding holds them. Reads ways of a road spec; knows no report."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from sgcad_core.case.records import Hold
from sgcad_core.reading.layout.road_ways import Way, apart, degree, exits, turn_of
from sgcad_core.records.specs import Maneuver, RoadSpec
from sgcad_core.roads.layout import OUTER

_TURN_RAD = math.radians(30)
"""A larger change of heading is a turn."""
_NEAR_RAD = math.radians(50)
"""A way within this angle of a stated heading goes in that direction."""
SIDES: Mapping[Maneuver, int] = {"turn_left": 1, "turn_right": -1}
"""Signs of the change of heading that a turn to a side is, counterclockwise."""
_NUMBERS = range(1, 10)
UNNUMBERED = tuple(f"{letter}{n}" for letter in "PBTOA" for n in _NUMBERS)
"""Road users and objects that reports do not number as vehicles."""
_IDS = (*(f"V{n}" for n in _NUMBERS), *UNNUMBERED)
Course = Mapping[str, tuple[str, ...]]


def course(way: Way, ways: Sequence[Way], maneuver: Maneuver) -> dict[str, tuple[str, ...]]:
    """A start, with the exits that a turn may take; other maneuvers leave the exit open."""
    start: dict[str, tuple[str, ...]] = {"road": (way.road.id,), "direction": (way.direction,)}
    side = SIDES.get(maneuver)
    if side is None:
        return start
    onward = (w.road.id for w in exits(way, ways) if side * turn_of(way, w) > _TURN_RAD)
    return start | {"exit_road": tuple(onward)}


def straight_on(way: Way, ways: Sequence[Way]) -> str | None:
    """The road that goes on where a way ends; None on a stem, or where the road has no end."""
    onward = min(_onward(way, ways), key=lambda w: abs(turn_of(way, w)), default=None)
    return onward.road.id if onward else None


def _onward(way: Way, ways: Sequence[Way]) -> list[Way]:
    """Exits that are reached without a turn."""
    return [w for w in exits(way, ways) if abs(turn_of(way, w)) <= _TURN_RAD]


def heading(ways: Sequence[Way], wanted_rad: float) -> tuple[Way, ...]:
    """The ways that go in a stated direction of travel."""
    return tuple(w for w in ways if apart(w.heading_rad, wanted_rad) < _NEAR_RAD)


def approaches(ways: Sequence[Way], spec: RoadSpec) -> tuple[Way, ...]:
    """The ways on which a drive may start: a vehicle on any other way came through one of these.

    Leaves out ways that begin at a junction and lead away, and ways that another one leads straight into; all ways if
    none is left. A leg's piece from an access to the hub stays, since small models know the leg by this name only.
    """
    split = {road.id.removesuffix(OUTER) for road in spec.roads if road.id.endswith(OUTER)}
    inner = [w for w in ways if w.direction == "forward" and w.road.id in split]
    onward = {(w.from_node, w.road.id) for p in ways for w in _onward(p, ways)}
    first = [w for w in ways if (w.from_node, w.road.id) not in onward]
    kept = [w for w in first if degree(w.from_node, spec) <= 2 or degree(w.to_node, spec) > 2]
    return tuple(w for w in ways if w in kept or w in inner) or tuple(ways)


def held(name: str, either: Sequence[Course]) -> Hold:
    """The actor of that name takes one of these courses."""
    others = tuple(other for other in _IDS if other != name)
    return Hold(items="actors", key="id", values=(name,), others=others, either=tuple(either))
