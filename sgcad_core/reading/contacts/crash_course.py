"""The course of a crash as its narrative tells it: evasion before the contact, spin, rest and facing after it.

Reads segments (one subject each). Of what is told several times the crash's own sentences count before interviews, and
the first telling before later ones. Knows no contact but the sentence of the first one, and no road.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.before_contact import RETOLD, is_late, offset_fronts, split
from sgcad_core.reading.contacts.rest_words import (
    HANDS,
    last_place,
    leaves_road,
    rest_lane,
    rolls_told,
    side_named,
    spin_told,
    way_told,
)
from sgcad_core.reading.contacts.road_departure import DepartureReader, MoveHeard, left_scene, wandering
from sgcad_core.reading.contacts.untouched_events import Untouched
from sgcad_core.reading.language import Rule, of_role, rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.motion_reader import counts_from_median
from sgcad_core.reading.motion.motion_record import ManeuverCue, Source
from sgcad_core.reading.text.compass import COMPASS, WORDS
from sgcad_core.reading.text.sentence_roles import Role
from sgcad_core.records.course import AT_IMPACT_M, CourseTold, ImpactTold, Steering

UNREAD: frozenset[Role] = frozenset({"codes", "factors", "towing", "injury", "restraint", "police", "health"})
_OVERTURNED = "course_rest.attitude_overturned"


@dataclass
class _CourseReader:
    """What was read of one vehicle so far, and where each thing was read first.

    `from_median`: "the number 1 lane" is the leftmost one.
    """

    from_median: bool = False
    course: CourseTold = field(default_factory=CourseTold)
    sources: dict[str, Source] = field(default_factory=dict)
    places: dict[str, int] = field(default_factory=dict)
    leaving: DepartureReader = field(default_factory=DepartureReader)
    moves: list[tuple[MoveHeard, Source, int]] = field(default_factory=list)
    """Each with its sentence and its place in it."""
    passed: bool = False  # through a junction

    def add(self, name: str, value: Any, source: Source) -> None:
        """Take a fact of the course unless it is known."""
        if name not in self.sources:
            self.course = replace(self.course, **{name: value})
            self.sources[name] = source

    def add_rest(self, name: str, value: Any, source: Source, *, anew: bool = False) -> None:
        """Take a fact of the rest unless it is known; `anew`: instead of what is known."""
        if anew or f"rest.{name}" not in self.sources:
            self.course = replace(self.course, rest=replace(self.course.rest, **{name: value}))
            self.sources[f"rest.{name}"] = source


@dataclass(frozen=True)
class CoursesRead:
    """Courses by vehicle, those of which anything is told, and where each fact was read ("V1 rest.where")."""

    courses: dict[str, CourseTold] = field(default_factory=dict)
    sources: dict[str, Source] = field(default_factory=dict)
    places: dict[str, int] = field(default_factory=dict)
    """Where in its sentence each of several moves stands ("V1 moves.0")."""


class ImpactRead(NamedTuple):
    """One contact behind the first, and where it was read."""

    impact: ImpactTold
    source: Source
    at: int = 0
    """About where in its sentence, in characters."""


def courses_told(
    statements: Sequence[Statement], segments: Sequence[Segment], roster: Roster,
    coded: Mapping[str, ManeuverCue] | None = None, event: Untouched | None = None, *, unhit: bool = False,
) -> CoursesRead:  # fmt: skip
    """The course of every vehicle as told. `segments`: of `acting_segments`; `coded`: losses of control by codes;
    `event`: what stands for the impact where nothing is touched; `unhit`: nothing is, so that all comes before it."""
    impact = min((t.number for t in statements if t.role == "impact"), default=10_000)
    impact = event.source.number if event else impact
    from_median = counts_from_median([t.text for t in statements], roster)
    heard = {v: _CourseReader(from_median) for v in roster.ids}
    for vehicle, cue in (coded or {}).items():
        heard[vehicle].add("lost_control", True, cue.source)
    words = event.source.words.lower() if event else ""
    late = False
    for segment in sorted(segments, key=lambda s: s.role in RETOLD):
        if segment.role in UNREAD:
            continue
        for vehicle in segment.subjects:
            _read(heard[vehicle], segment, impact, words, late=late)
            if unhit:
                _read_spin(heard[vehicle], segment, segment.text)
        late = is_late(segment, impact, late)
    if event and event.kind == "rollover":
        heard[event.vehicle].add("rolls", True, event.source)
    for vehicle, source in offset_fronts([t for t in statements if t.role not in UNREAD], heard):
        heard[vehicle].add("offset", True, source)
    for vehicle, source in left_scene(statements, roster, impact if impact < 10_000 else 0):
        heard[vehicle].add("leaves", True, source)
    for one in heard.values():
        _keep_moves(one)
    courses = {v: one.course for v, one in heard.items() if not one.course.empty}
    sources = {f"{v} {name}": source for v, one in heard.items() for name, source in one.sources.items()}
    places = {f"{v} {name}": at for v, one in heard.items() for name, at in one.places.items()}
    return CoursesRead(courses, sources, places)


def before_near_miss(read: CoursesRead, *, of_thing: bool) -> CoursesRead:
    """What is kept of courses where no contact comes about: the pace, a loss of control with its spin; of one that
    nearly strikes a thing its way off the road too. Evasions are told apart from these."""
    kept = ("lost_control", "spin", "spin_deg", "pace", *(("departs", "moves") if of_thing else ()))
    courses = {who: CourseTold(**{name: getattr(told, name) for name in kept}) for who, told in read.courses.items()}
    sources = {name: source for name, source in read.sources.items() if name.split()[1].split(".")[0] in kept}
    return CoursesRead({who: told for who, told in courses.items() if not told.empty}, sources, read.places)


def _read(one: _CourseReader, segment: Segment, impact: int, event: str, *, late: bool = False) -> None:
    """Take what a segment tells. `late`: it stands behind the first contact in that sentence."""
    before, behind = split(segment, impact)
    if late and segment.number == impact:
        behind = segment.text
    if event and segment.number == impact and (at := segment.text.lower().find(event)) >= 0:
        before, behind = segment.text[:at], segment.text
    early = segment.number <= impact and not (late and segment.number == impact)
    _read_evasion(one, segment, before, early=early)
    if early and (m := rule("course_evasion.stops_in_the_way").search(before)):
        one.add("stops", True, Source(segment.number, m[0], "course_evasion.stops_in_the_way"))
    if segment.role not in RETOLD and early:
        if m := rule("course_evasion.in_junction").search(before):
            one.add("inside", True, Source(segment.number, m[0], "course_evasion.in_junction"))
        for pace, m in _done(before, of_role("pace")):
            if not rule("speeds.pace_of_other").search(before[: m.end()]):
                one.add("pace", pace.yields["pace"], Source(segment.number, m[0], pace.id))
        _read_departure(one, segment, before)
        _read_roll(one, segment, before, early=True)
    if behind:
        _read_spin(one, segment, behind)
        _read_rest(one, segment, behind)


# ------------------------------------------------------------------ before the contact
def _read_evasion(one: _CourseReader, segment: Segment, text: str, *, early: bool) -> None:
    """Evasion and loss of control before a contact; one that turns is out of control where that is told `early`, before
    the first contact, which else turned it."""
    none = rule("course_evasion.none").search(text)
    if none:
        one.add("no_evasion", True, Source(segment.number, none[0], "course_evasion.none"))
    lost = rule("meeting.lost").search(text)
    if lost and segment.role not in RETOLD:
        one.add("lost_control", True, Source(segment.number, lost[0], "meeting.lost"))
    if early and (turned := rule("course_rest.turned").search(text)):
        one.add("lost_control", True, Source(segment.number, turned[0], "course_rest.turned"))
    for found in _done(text, of_role("braking")):
        one.add("brakes", True, Source(segment.number, found[1][0], found[0].id))
    for found in _done(text, of_role("steering")):
        to: Steering = HANDS.get(found[1].groupdict().get("hand") or "", "either")
        one.add("steers", to, Source(segment.number, found[1][0], found[0].id))


def _read_departure(one: _CourseReader, segment: Segment, text: str) -> None:
    passes = rule("departures.passes").search(text)
    for move in one.leaving.hear(text):
        one.moves.append((move, Source(segment.number, move.words, move.rule), segment.at + move.at))
        if move.move.kind == "departs" and (one.passed or (passes and passes.start() < move.at)):
            one.add("beyond", True, Source(segment.number, move.words, move.rule))
    one.passed |= passes is not None
    found = one.leaving.found
    one.course = replace(one.course, departs=found.side if found else None)
    if found and found.words in text:
        one.sources["departs"] = Source(segment.number, found.words, found.rule)


def _keep_moves(one: _CourseReader) -> None:
    """The moves on the way to the contact, where there are several; their sources are "moves.0" and so on. How it yaws
    counts in any case."""
    for heard, source, _ in one.moves:
        if heard.move.kind == "yaws":
            one.add("yaws", heard.move.side, source)
    kept = wandering([move for move, *_ in one.moves])
    one.course = replace(one.course, moves=tuple(move.move for move in kept))
    for n, move in enumerate(kept):
        source, at = next((source, at) for other, source, at in one.moves if other is move)
        one.sources[f"moves.{n}"], one.places[f"moves.{n}"] = source, at


def _done(text: str, wordings: Sequence[Rule]) -> list[tuple[Rule, re.Match[str]]]:
    """The first of some wordings that tells an act as done, not as left undone."""
    for wording in wordings:
        for m in wording.finditer(text):
            undone = rule("course_evasion.not_done").search(text[max(0, m.start() - 40) : m.end()])
            if not undone:
                return [(wording, m)]
    return []


# ------------------------------------------------------------------ behind it
def _read_spin(one: _CourseReader, segment: Segment, text: str) -> None:
    found = spin_told(text)
    if found is None:
        return
    source = Source(segment.number, found.words, found.rule)
    if found.degrees and "spin" not in one.sources:
        one.add("spin_deg", found.degrees, source)
    one.add("spin", found.way, source)


def _read_rest(one: _CourseReader, segment: Segment, text: str) -> None:
    clause = _rest_clause(segment, text)
    known = "rest.at" in one.sources
    rolled = _read_roll(one, segment, text)
    lies = (clause, text) if rolled else (clause,)
    told = ((wording, wording.search(part)) for part in lies if part for wording in of_role("attitude"))
    counted = "roll_quarters" in one.sources
    for wording, lying in ((w, lying) for w, lying in told if lying and not (counted and w.id == _OVERTURNED)):
        weak = one.sources.get("rest.attitude", Source(0)).rule == _OVERTURNED
        one.add_rest("attitude", wording.yields["attitude"], Source(segment.number, lying[0], wording.id), anew=weak)
        break
    if way := way_told(text, rests=clause is not None):
        one.add_rest("distance_m", way.meters, Source(segment.number, way.words, way.rule))
    if clause is not None and not rule("course_rest.unknown").search(clause):
        _read_facing(one, segment, clause)
        for prop in (rule("course_rest.against"), rule("course_rest.at_thing")):
            if m := prop.search(clause):
                one.add_rest("against", m["thing"], Source(segment.number, m[0], prop.id))
                break
        one.sources.setdefault("rest.at", Source(segment.number, clause[:20], "course_rest.rest"))
        if "rest.distance_m" not in one.sources and (m := rule("course_rest.at_impact").search(clause)):
            one.add_rest("distance_m", AT_IMPACT_M, Source(segment.number, m[0], "course_rest.at_impact"))
    if not known and segment.role not in RETOLD:
        _read_place(one, segment, text, clause)
        _read_lane(one, segment, clause)


def _read_roll(one: _CourseReader, segment: Segment, text: str, *, early: bool = False) -> bool:
    """Whether it rolled over, how far, with which side leading; `early`: before any contact."""
    told = rolls_told(text, early=early)
    for name, value, words, by in told:
        one.add(name, value, Source(segment.number, words, by))
    return bool(told)


def _rest_clause(segment: Segment, text: str) -> str | None:
    """The text from the verb of coming to rest on; None where it has none."""
    m = rule("course_rest.rest").search(text) or rule("course_rest.stopped_there").search(text)
    m = m or rule("course_rest.stood_facing").match(text)
    return text[m.start() :] if m else None


def _read_facing(one: _CourseReader, segment: Segment, clause: str) -> None:
    m = rule("course_rest.facing").search(clause)
    if not m:
        if (about := rule("course_rest.turned_about").search(clause)) and "spin_deg" not in one.sources:
            one.add("spin_deg", 180.0, Source(segment.number, about[0], "course_rest.turned_about"))
        return
    angle = 45.0 * COMPASS.index(WORDS[(m["point"] or m["heads"] or m["way"]).lower()])
    if m["first"]:
        first = 45.0 * COMPASS.index(WORDS[m["first"].lower()])
        angle += ((first - angle + 180) % 360 - 180) / 2
    one.add_rest("facing_deg", angle % 360, Source(segment.number, m[0], "course_rest.facing"))


def _read_place(one: _CourseReader, segment: Segment, text: str, clause: str | None) -> None:
    """The clause of the rest says where; else the last place on the way there."""
    on_the_way = text[: len(text) - len(clause)] if clause else text
    for part in (on_the_way, clause or ""):
        found, side = last_place(part), side_named(part)
        if found is None and side is not None and part is clause and one.course.rest.where is not None:
            one.add_rest("side", side, Source(segment.number, part, "course_rest.side_named"), anew=True)
        if found is None or (part is on_the_way and not leaves_road(part)):
            continue
        wording, m = found
        source = Source(segment.number, m[0], wording.id)
        one.add_rest("where", wording.yields["where"], source, anew=True)
        if side is not None or wording.yields["where"] in ("road", "intersection"):
            one.add_rest("side", side, source, anew=True)


def _read_lane(one: _CourseReader, segment: Segment, clause: str | None) -> None:
    """The lane of a rest on the road."""
    if not clause or one.course.rest.where != "road" or not (found := rest_lane(clause, from_median=one.from_median)):
        return
    for name, value in (("lane", found.lane), ("lane_way", found.way)):
        if value is not None:
            one.add_rest(name, value, Source(segment.number, found.words, "course_rest.lane"))
