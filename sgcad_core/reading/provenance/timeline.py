"""The timeline of a crash as it was read: cues of motion, contacts and the course, put in the order of the crash.

Made of what the readers of motion, contacts and course found, so that nothing is read twice. What is told behind the
sentence of the first contact is after it, unless nothing was told of that vehicle before. Knows no road network.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, get_args

from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.inference.inference_state import CrashInferred, CrashTold
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.motion_record import ManeuverCue, Source, VehicleMotion
from sgcad_core.reading.provenance.crash_provenance import FactBuilder
from sgcad_core.records.course import CourseTold
from sgcad_core.records.facts import Fact
from sgcad_core.records.timeline import MOVING, PHASES, STANDING, Act, ActKind, Phase

_KINDS: frozenset[str] = frozenset(get_args(ActKind))
_AS: dict[str, ActKind] = {
    "shifted_left": "lane_change_left", "shifted_right": "lane_change_right",
    "departed_lane_left": "lane_change_left", "departed_lane_right": "lane_change_right",
}  # fmt: skip
"""Cues that are an act by another name; those without a name here or in `ActKind` are no acts."""
_ONWARD = ("moved_on", "came_on")
_MOVES: dict[tuple[str, str | None], ActKind] = {
    ("departs", "left"): "departing_road_left", ("departs", "right"): "departing_road_right",
    ("crosses", "left"): "crossing_centerline",
}  # fmt: skip
"""Moves that are an act of their own kind; the kinds of others are the same words."""
_MOVED: frozenset[ActKind] = frozenset(_MOVES.values())
_MEANT, _CODED = "want_", "code:"
_LANE_WORDS = {-1: "leftmost", 1: "rightmost"}
_NO_SENTENCE = 10**6
_Placed = tuple[int, int, Act]
"""Sentence, place in it, act."""


def timeline_of(builder: FactBuilder, told: CrashTold, inferred: CrashInferred) -> tuple[Act, ...]:
    """All acts of all road users: before, at and after the first contact, each phase in the order of the text."""
    hits = [hit for hit in told.contact_mentions if not hit.summary] or list(told.contact_mentions)
    impact = min((hit.number for hit in hits), default=_NO_SENTENCE)
    found: list[tuple[int, int, int, Act]] = []
    for vehicle in told.roster.ids:
        motion = [*_motion(builder, vehicle, told.motions[vehicle], inferred, impact)]
        acts = [*_with_moves(motion, [*_course(builder, vehicle, told)])]
        found += [(PHASES.index(act.phase), number, at, act) for number, at, act in acts]
    found += [(PHASES.index(act.phase), number, 0, act) for number, act in _contacts(builder, told, hits)]
    found.sort(key=lambda one: one[:3])
    return _each_once(act for *_, act in found)


def _with_moves(motion: list[_Placed], course: list[_Placed]) -> Iterator[_Placed]:
    """The acts of motion and of the course; what moves of the course tell is no act of motion as well."""
    moves = {act.kind for *_, act in course} & _MOVED
    deciding = {act.kind for *_, act in motion if act.decides} & moves
    for number, at, act in motion:
        if act.kind not in moves or act.phase != "before":
            yield number, at, act
    for number, at, act in course:
        yield number, at, act.model_copy(update={"decides": True}) if act.kind in deciding else act
        deciding -= {act.kind}


def _each_once(acts: Iterator[Act]) -> tuple[Act, ...]:
    """Without acts that only say again what the same road user was told to do last."""
    kept: list[Act] = []
    last: dict[str, int] = {}
    for act in acts:
        at = last.get(act.actor)
        if at is not None and _same(kept[at], act):
            kept[at] = kept[at].model_copy(update={"decides": kept[at].decides or act.decides})
            continue
        last[act.actor] = len(kept)
        kept.append(act)
    return tuple(kept)


def _same(before: Act, act: Act) -> bool:
    """Whether an act says no more than the one before it."""
    alike = all(getattr(before, name) == getattr(act, name) for name in ("kind", "phase", "other", "value", "meant"))
    own = [getattr(act, name) for name in ("heading", "lane", "road", "speed_mph")]
    under_way = act.kind == "approach" and before.kind in MOVING and before.phase == act.phase
    return not any(own) and (alike or under_way)


def _act(fact: Fact, source: Source | None, actor: str, kind: ActKind, phase: Phase, **more: Any) -> Act:
    """An act with the place and the confidence of a fact."""
    return Act(
        actor=actor, kind=kind, phase=phase, words=source.words if source else "", rule=fact.rule, basis=fact.basis,
        confidence=fact.confidence, start=fact.start, end=fact.end, **more,
    )  # fmt: skip


# ------------------------------------------------------------------ motion
def _motion(
    builder: FactBuilder, vehicle: str, motion: VehicleMotion, inferred: CrashInferred, impact: int
) -> Iterator[tuple[int, int, Act]]:
    """(sentence, place in it, act) of one vehicle's approach and cues."""
    yield from _approach(builder, vehicle, motion, inferred)
    early = [cue for cue in motion.cues if cue.number <= impact]
    known = bool(early or motion.headings)
    decisive = inferred.sources.get(f"{vehicle} maneuver")
    stood = False
    for cue in sorted(motion.cues, key=lambda cue: cue.when):
        decides = decisive is not None and cue.source == decisive
        kind, meant = _kind_of(cue, stood)
        if kind is None:
            continue
        after = cue.number > impact and known and not decides
        fact = builder.stated("act", kind, cue.source)
        phase: Phase = "after" if after else "before"
        yield cue.number, cue.at, _act(fact, cue.source, vehicle, kind, phase, meant=meant, decides=decides)
        stood = stood if meant else kind in STANDING
    if vehicle in inferred.started:
        fact = builder.inferred("act", "starts", "infer.set_going")
        yield impact, _NO_SENTENCE, _act(fact, None, vehicle, "starts", "before", decides=True)


def _kind_of(cue: ManeuverCue, stood: bool) -> tuple[ActKind | None, bool]:
    """The act of a cue and whether it is only meant; None for what is no act of its own."""
    name = cue.kind.removeprefix(_CODED)
    meant = name.startswith(_MEANT)
    name = name.removeprefix(_MEANT)
    if name in _ONWARD:
        name = "starts" if stood and not rule("deeds.on_its_way").match(cue.words) else "approach"
    found = _AS.get(name, name)
    return (found if found in _KINDS else None), meant  # type: ignore[return-value]


def _approach(
    builder: FactBuilder, vehicle: str, motion: VehicleMotion, inferred: CrashInferred
) -> Iterator[tuple[int, int, Act]]:
    """The state of a vehicle before all acts, where its heading, lane, speed or origin are told."""
    sources = inferred.sources
    at = {
        "heading": sources.get(f"{vehicle} heading"), "lane": motion.sources.get("lane"),
        "road": motion.sources.get("origin"), "speed_mph": sources.get(f"{vehicle} speed"),
    }  # fmt: skip
    values = {
        "heading": inferred.headings.get(vehicle) if vehicle in inferred.stated else None,
        "lane": _lane_word(motion), "road": motion.origin, "speed_mph": inferred.speeds.get(vehicle),
    }  # fmt: skip
    told = {name: value for name, value in values.items() if value is not None and at[name] is not None}
    if not told:
        return
    source = min((at[name] for name in told), key=lambda one: one.number if one else _NO_SENTENCE)
    fact = builder.stated("act", "approach", source)
    yield source.number if source else 0, -1, _act(fact, source, vehicle, "approach", "before", **told)


def _lane_word(motion: VehicleMotion) -> str | None:
    """The told lane in words: its number from the right curb, or its place."""
    if motion.lane_word:
        return motion.lane_word.replace("_", " ")
    return None if motion.lane is None else _LANE_WORDS.get(motion.lane, str(motion.lane))


# ------------------------------------------------------------------ contacts
def _contacts(builder: FactBuilder, told: CrashTold, hits: Sequence[ContactMention]) -> Iterator[tuple[int, Act]]:
    """(sentence, act) of every contact: the first at the crash, the others after it or before it as told."""
    seen: set[frozenset[str]] = set()
    for hit in sorted(hits, key=lambda hit: hit.number):
        pair = frozenset((hit.actor, hit.other))
        if pair in seen:
            continue
        phase: Phase = "after" if seen else "at"
        seen.add(pair)
        fact = builder.stated("act", "contact", hit.source)
        value = hit.actor_area.split("/")[0] if hit.actor_area else None
        yield hit.number, _act(fact, hit.source, hit.actor, "contact", phase, other=hit.other, value=value)
    for impact, source, _ in told.impacts:
        phase = "before" if impact.before else "after"
        fact = builder.stated("act", "contact", source)
        act = _act(fact, source, impact.actor, "contact", phase, other=impact.other, value=impact.actor_area)
        yield source.number, act


# ------------------------------------------------------------------ course
def _course(builder: FactBuilder, vehicle: str, told: CrashTold) -> Iterator[tuple[int, int, Act]]:
    """(sentence, place in it, act) of evasion, loss of control, spin, rollover and rest."""
    course = told.course.courses.get(vehicle)
    if course is None:
        return
    for name, kind, phase, value in _course_acts(course):
        source = told.course.sources.get(f"{vehicle} {name}")
        fact = builder.stated("act", kind, source)
        number = source.number if source else _NO_SENTENCE
        last = _NO_SENTENCE if kind == "rests" else 0
        at = told.course.places.get(f"{vehicle} {name}", 0)
        yield max(number, last), at, _act(fact, source, vehicle, kind, phase, value=value)


def _course_acts(course: CourseTold) -> Iterator[tuple[str, ActKind, Phase, Any]]:
    """(name of the source, kind, phase, value) of what is told."""
    if course.brakes:
        yield "brakes", "brakes", "before", None
    for n, move in enumerate(course.moves):
        kind = _MOVES.get((move.kind, move.side), move.kind)
        yield f"moves.{n}", kind, "before", None if kind in _MOVED else move.side
    if course.steers and not course.moves:
        yield "steers", "steers", "before", course.steers
    if course.no_evasion and not (course.brakes or course.steers):
        yield "no_evasion", "no_evasion", "before", None
    if course.lost_control:
        yield "lost_control", "loses_control", "before", None
    if course.spin or course.spin_deg:
        yield "spin" if course.spin else "spin_deg", "spins", "after", course.spin or course.spin_deg
    if course.rolls:
        yield "rolls", "rolls_over", "after", None
    rest = course.rest
    for name in ("where", "against", "side", "attitude", "facing_deg", "distance_m"):
        if (value := getattr(rest, name)) is not None:
            yield f"rest.{name}", "rests", "after", value
            return
