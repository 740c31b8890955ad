"""What a story tells of a road besides its junction: lanes that a work zone closes, its median, gores.

Reads resolved sentences and the vehicles' facts. Knows no lane that is drawn and no file format.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from sgcad_core.kinds import JOINING
from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_merge import MergedRoad
from sgcad_core.reading.text.normalise import NUMBERS
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Compass, Median

Side = Literal["left", "right"]
InGore = Literal["stands", "strikes", "crosses", "leaves"]
"""Acts in a gore; "leaves" crosses it into the ramp."""


@dataclass(frozen=True)
class ClosedLanes:
    """Lanes that are closed ahead, `count` from the curb or from the middle, for traffic that heads `toward`."""

    side: Side
    count: int
    toward: Compass
    side_stated: bool
    where: Source = field(compare=False, repr=False)


CLOSED_LANES = rule("places.closed_side")
_CLOSURE = rule("places.closure")
MEDIAN_OPENING = rule("places.median_opening")
_GORE, _IN_GORE, _TO_RAMP = rule("places.gore"), rule("places.in_gore"), rule("places.to_ramp")
_LEFT = ("left", "leftmost", "left-most", "inside", "inner")
_AWAY: dict[str, Side] = {"lane_change_left": "right", "lane_change_right": "left"}
"""The side of the lane that one leaves by a change of lane."""


def closed_lanes(statements: Sequence[Statement], vehicles: Sequence[VehicleFacts]) -> ClosedLanes | None:
    """The closed lanes of a story, None where it tells none. Without a told side it is that of the vehicle that leaves
    the lane, else the right one."""
    leaves = next((v for v in vehicles if v.maneuver in (*_AWAY, "merge") and v.heading), None)
    lead = leaves or next((v for v in vehicles if v.heading), None)
    if lead is None or lead.heading is None:
        return None
    for t in _story(statements):
        if match := CLOSED_LANES.search(t.text):
            parts = match.groupdict()
            word = next(parts[k] for k in ("side", "ahead", "noun", "blocked", "by") if parts[k]).lower()
            count = NUMBERS.get(number := (parts["count"] or parts["more"] or "1").lower()) or int(number)
            side: Side = "left" if word in _LEFT else "right"
            return ClosedLanes(side, count, lead.heading, True, Source(t.number, match[0], CLOSED_LANES.id))
        if match := _CLOSURE.search(t.text):
            return ClosedLanes(_left_by(lead), 1, lead.heading, False, Source(t.number, match[0], _CLOSURE.id))
    return None


def median_opening(statements: Sequence[Statement]) -> Source | None:
    """Where a story tells of an opening in the median."""
    found = ((t, match) for t in _story(statements) if (match := MEDIAN_OPENING.search(t.text)))
    return next((Source(t.number, match[0], MEDIAN_OPENING.id) for t, match in found), None)


def with_entered_median(roads: list[MergedRoad], statements: Sequence[Statement]) -> list[MergedRoad]:
    """The roads, of which the street of the vehicle that is told to enter a median has that one, if none is told of it.

    Among several streets it is the only one on which that vehicle drives.
    """
    found = ((t, m) for t in _story(statements) if (m := rule("median.entered").search(t.text)))
    if (first := next(found, None)) is None:
        return roads
    told, match = first
    streets = [road for road in roads if road.kind not in JOINING]
    streets = [road for road in streets if told.subject in road.vehicles] if len(streets) > 1 else streets
    if len(streets) != 1 or streets[0].lanes.median or streets[0].lanes.divided is not None:
        return roads
    kind: Median = "raised" if rule("median.hard").search(match[0]) else "grass"
    where = {**streets[0].lanes.where, "median": Source(told.number, match[0], "median.entered")}
    streets[0].lanes = replace(streets[0].lanes, median=kind, where=where)
    return roads


def in_gores(statements: Sequence[Statement]) -> dict[str, InGore]:
    """Vehicles in a gore, by what they do: stand there, strike an object there, cross it, or leave by the ramp."""
    found: dict[str, InGore] = {}
    for t in _story(statements):
        for match in _IN_GORE.finditer(t.text):
            how, who = next((how, who) for how, who in match.groupdict().items() if who)
            away = how == "crosses" and _TO_RAMP.search(t.text[match.end() : match.end() + 60])
            found.setdefault(who, "leaves" if away else how)  # type: ignore[arg-type]
    return found


def names_closure(statements: Sequence[Statement]) -> bool:
    """Whether a story tells a closed lane at all, even without a direction."""
    return any(CLOSED_LANES.search(t.text) or _CLOSURE.search(t.text) for t in _story(statements))


def names_gore(statements: Sequence[Statement]) -> bool:
    """Whether a story names a gore at all."""
    return any(_GORE.search(t.text) for t in _story(statements))


def _story(statements: Sequence[Statement]) -> list[Statement]:
    return [t for t in statements if t.role in STORY_ROLES]


def _left_by(v: VehicleFacts) -> Side:
    """The side on which the lane lies that a vehicle leaves, as far as that is told."""
    word: Side = "left" if v.lane_word == "left" else "right"
    return _AWAY.get(v.maneuver, word)


def keeps_lane_open(closed: ClosedLanes, lanes: LaneFacts) -> bool:
    """Whether a road with some lanes closed keeps one open that way, as far as its lanes are counted."""
    counted = lanes.toward.get(closed.toward) or lanes.each_way
    if counted is None and lanes.total:
        counted = lanes.total if lanes.one_way or lanes.divided else lanes.total // 2
    return counted is None or counted > closed.count


def undrawn(named: tuple[str, ...], places: Mapping[str, tuple[object, object]]) -> tuple[str, ...]:
    """Kinds of places that are named and not drawn; `places`: of some kinds what is told and what is drawn."""
    told = [kind for kind, (seen, drawn) in places.items() if seen and not drawn]
    return tuple(dict.fromkeys([*(kind for kind in named if not places.get(kind, (None, None))[1]), *told]))
