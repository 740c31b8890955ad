"""What a text says of the way to a rest: rotation, kind of place and its side, lane.

Reads one segment or clause; knows no road. Lanes are counted as before the contact (`heading_lane_cues.read_lane`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple, cast

from sgcad_core.reading.language import Rule, of_role, rule
from sgcad_core.reading.motion.heading_lane_cues import read_lane
from sgcad_core.reading.motion.motion_record import Source, VehicleMotion
from sgcad_core.reading.text.compass import WORDS, turned
from sgcad_core.reading.text.normalise import number
from sgcad_core.records.course import CourseTold, Hand, RestLane, Spin
from sgcad_core.records.specs import Compass
from sgcad_core.units import METERS

HANDS: dict[str, Hand] = {"left": "left", "right": "right"}
_FAR_M = (0.5, 300.0)
"""Distances from a contact to a rest that are believed."""
_MOST_QUARTERS = 24
"""Quarter turns; more is a misreading."""


class LaneRead(NamedTuple):
    """A lane by number or word, the direction in which its traffic runs, and the words that tell it."""

    lane: int | RestLane | None
    way: Compass | None
    words: str


def rest_lane(clause: str, *, from_median: bool) -> LaneRead | None:
    """The lane of a clause; None where it tells none, or a place between two.

    `from_median`: "the number 1 lane" is the leftmost one.
    """
    if rule("course_rest.between_lanes").search(clause):
        return None
    own = rule("course_rest.own_lane").search(clause)
    way = rule("course_rest.lane_way").search(clause)
    heads = WORDS[next(filter(None, way.groups())).lower()] if way else None
    center = rule("course_rest.center_lane").search(clause)
    if own or center:
        return LaneRead("own", heads, own[0]) if own else LaneRead("center_turn", heads, center[0] if center else "")
    heard = VehicleMotion()
    read_lane(heard, clause, from_median)
    lane = heard.lane if heard.lane is not None else cast("RestLane | None", heard.lane_word)
    if lane is None and way is None:
        return None
    return LaneRead(lane, heads, heard.sources["lane"].words if lane is not None else way[0] if way else "")


class SpinRead(NamedTuple):
    """A rotation with its degrees, where told; the words that tell it, and by which rule."""

    way: Spin
    degrees: float | None
    words: str
    rule: str


def spin_told(text: str) -> SpinRead | None:
    """The rotation that a text tells of a vehicle; None where it tells none."""
    for told in (rule("course_rest.turned"), rule("course_rest.turned_to_side")):
        if m := told.search(text):
            words = m.groupdict()
            said = next(filter(None, map(words.get, ("way", "round", "to")))).replace(" ", "").replace("-", "")
            degrees = words.get("degrees") or words.get("deg")
            way: Spin = "clockwise" if said in ("clockwise", "right") else "counterclockwise"
            return SpinRead(way, float(degrees) if degrees else _turned_by(text), m[0], told.id)
    return None


def _turned_by(text: str) -> float | None:
    """Degrees of a rotation that is told in quarter, half or full turns."""
    m = rule("course_rest.turned_by").search(text)
    if m is None:
        return None
    count = 1 if m["count"].lower() in ("a", "an") else number(m["count"])
    return count * {"quarter": 90.0, "half": 180.0}.get(m["part"].lower(), 360.0)


class RollRead(NamedTuple):
    """One thing told of a rollover: the name of the fact, its value, the words, and by which rule."""

    name: str
    value: bool | int | Hand
    words: str
    rule: str


def rolls_told(text: str, *, early: bool = False) -> tuple[RollRead, ...]:
    """What a text tells of a rollover: that there is one, how far, with which side leading; () where it tells none.

    `early`, before any contact, "rolled over" alone may tell of a line that the vehicle crossed.
    """
    rolled, m = rule("course_rest.rolled").search(text), rule("course_rest.quarters").search(text)
    leads = m or rule("course_rest.leads").search(text)
    if not rolled or (early and not leads and rule("course_rest.over_a_line").match(rolled[0])):
        return ()
    found = [RollRead("rolls", True, rolled[0], "course_rest.rolled")]
    if m and 0 < (count := number(next(filter(None, m.groups())))) <= _MOST_QUARTERS:
        found.append(RollRead("roll_quarters", count, m[0], "course_rest.quarters"))
    if m := rule("course_rest.rolls_to").search(text):
        hand: Hand = "left" if next(filter(None, m.groups())).lower() == "left" else "right"
        found.append(RollRead("rolls_to", hand, m[0], "course_rest.rolls_to"))
    return tuple(found)


class WayRead(NamedTuple):
    """The way from the contact to the rest, or how far from it the rest is, with the words and the rule."""

    meters: float
    words: str
    rule: str


def way_told(text: str, *, rests: bool) -> WayRead | None:
    """The way to the rest that a text tells; None where it tells none that is believed. `rests`: it tells the rest."""
    for told in of_role("rest_distance") if rests else (rule("course_rest.pushed_by"),):
        if m := told.search(text):
            meters = float(m["number"]) * METERS[m["unit"].lower()]
            return WayRead(round(meters, 1), m[0], told.id) if _FAR_M[0] <= meters <= _FAR_M[1] else None
    return None


def leaves_road(text: str) -> bool:
    """Whether a text tells a way off the road or back onto it, not just where something happened."""
    places = (m for wording in of_role("place") for m in wording.finditer(text))
    return any(rule("course_rest.left_road").search(m[0]) for m in places)


def last_place(text: str) -> tuple[Rule, re.Match[str]] | None:
    """The place that is named last; of wordings that read the same words the one of least weight."""
    best: tuple[Rule, re.Match[str]] | None = None
    for wording in of_role("place"):
        for m in wording.finditer(text):
            if best is None or m.start() >= best[1].end():
                best = (wording, m)
    return best


def side_named(text: str) -> Compass | Hand | None:
    found = None
    for m in rule("course_rest.side_named").finditer(text):
        word = (m["side"] or m["to"] or m["other"] or m["sent"]).lower()
        found = HANDS.get(word) or WORDS.get(word)
        if m["bound"] and word in WORDS:  # a northbound shoulder lies east of its road
            found = turned(WORDS[word], 90)
    return found


def touched_at_rest(text: str, at: int) -> bool:
    """Whether the words at a place of a sentence tell where a vehicle rests, at the thing that was struck before: they
    tell no further contact with it."""
    rest = rule("course_rest.rest").search(text)
    props = (rule("course_rest.against"), rule("course_rest.at_thing")) if rest else ()
    told = (m for prop in props for m in prop.finditer(text, rest.end() if rest else 0))
    return any(m.start() <= at < m.end() and rule("course_rest.same_thing").search(m[0]) for m in told)


def at_struck(
    courses: Mapping[str, CourseTold], sources: Mapping[str, Source], struck: Iterable[tuple[str, str]]
) -> dict[str, CourseTold]:
    """The courses without rests at things that their vehicles did not strike: a sign, or a barrier along the road, then
    only says where that was. `struck`: pairs of a vehicle and the words for what it struck."""
    met = {(vehicle, _last(thing)) for vehicle, thing in struck}
    return {
        vehicle: replace(course, rest=replace(course.rest, against=None))
        if (prop := course.rest.against) and (vehicle, _last(prop)) not in met
        and sources[f"{vehicle} rest.against"].rule == "course_rest.at_thing" else course
        for vehicle, course in courses.items()
    }  # fmt: skip


def _last(thing: str) -> str:
    """ "light-pole" -> "pole"."""
    return thing.replace("-", " ").split()[-1]
