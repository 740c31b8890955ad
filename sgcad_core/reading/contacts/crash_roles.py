"""Roles in the crash: initiator, responder or bystander for every road user, with the sentence that says so.

The initiator's act made the conflict (in NMVCCS's words: the critical reason is coded to it), the responder had to deal
with it, actors without a part in the first contact are bystanders. Evidence adds up: the report's codes outweigh
citations and broken rules, these the maneuvers; without any of them the striker is the initiator. Not a finding of
guilt. Replaced one role at a time, as in J. M. Scanlon et al., Waymo Simulated Driving Behavior in Reconstructed Fatal
Crashes, 2021. Knows no road.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from sgcad_core.kinds import CrashRole
from sgcad_core.reading.actors.vehicles import MENTION
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import DRIVES, Source
from sgcad_core.reading.provenance.crash_provenance import FactBuilder, default
from sgcad_core.records.facts import Fact
from sgcad_core.records.specs import Maneuver

_REASON, _EVENT, _BROKE, _CITED, _MANEUVER = 8.0, 4.0, 2.0, 2.0, 1.0
"""Weights of the kinds of evidence. Codes are given after an inquiry, with all that a report tells at hand."""
_BEGINS: dict[Maneuver, float] = {
    "crossing_centerline": 1.0, "u_turn": 0.9, "backing": 0.9, "departing_road_left": 0.8, "departing_road_right": 0.8,
    "turn_left": 0.8, "lane_change_left": 0.8, "lane_change_right": 0.8, "merge": 0.7, "overtaking": 0.6,
    "turn_right": 0.5, "negotiating_curve": 0.2, "straight": 0.0, "other": 0.0, "slowing": -0.1, "stopped": -0.2,
    "parked": -0.3,
}  # fmt: skip
"""How far a maneuver, by itself, makes a conflict: leaving a lane or crossing a path brings a duty to yield."""
_FROM_DRIVEWAY, _FROM_STOP, _RAN_INTO = 0.6, 0.3, 1.5


class RoleEvidence(NamedTuple):
    """One thing that speaks for (or, negative, against) a vehicle's having begun the crash."""

    vehicle: str
    weight: float
    rule: str
    source: Source | None = None


def role_facts(builder: FactBuilder, statements: Sequence[Statement], crash: CrashFacts) -> Iterator[Fact]:
    """`vehicles.<id>.role` (and `others.<id>.role`) of every actor in the crash."""
    ids = [v.id for v in crash.vehicles] + [o.id for o in crash.others]
    pair = _pair(crash)
    known = {v.id for v in crash.vehicles}
    signs = [*_told_signs(statements, known), *_signs_on_foot(statements, known, pair or ()), *_maneuver_signs(crash)]
    first = _initiator(pair, signs) if pair else None
    for name in ids:
        field = f"{'vehicles' if name.startswith('V') else 'others'}.{name}.role"
        if not pair or name not in pair:
            yield default(field, "bystander", "who takes no part in the first contact is a bystander")
        else:
            yield _fact(builder, field, name, first, signs, pair)


def _pair(crash: CrashFacts) -> tuple[str, str] | None:
    """Striker and struck of the first contact; of an encounter without contact the first two vehicles."""
    if crash.contacts:
        return crash.contacts[0].striker, crash.contacts[0].struck
    return (crash.vehicles[0].id, crash.vehicles[1].id) if len(crash.vehicles) > 1 else None


def _initiator(pair: tuple[str, str], signs: Iterable[RoleEvidence]) -> str:
    """The one of both with more signs; the striker where nothing tells them apart."""
    score = {name: sum(s.weight for s in signs if s.vehicle == name) for name in pair}
    return pair[0] if score[pair[0]] >= score[pair[1]] else pair[1]


def _fact(
    builder: FactBuilder, field: str, name: str, first: str | None, signs: Sequence[RoleEvidence], pair: tuple[str, str]
) -> Fact:
    """The role with the sign that weighs most for it: one's own, else the other one's."""
    role: CrashRole = "initiator" if name == first else "responder"
    way = 1.0 if role == "initiator" else -1.0
    other = pair[1] if name == pair[0] else pair[0]
    for whose, sign_of in ((name, way), (other, -way)):
        best = max((s for s in signs if s.vehicle == whose), key=lambda s: s.weight * sign_of, default=None)
        if best is not None and best.weight * sign_of > 0:
            told = best.source and whose == name and best.weight * sign_of >= _EVENT
            return (
                builder.stated(field, role, best.source)
                if told
                else builder.inferred(field, role, best.rule, best.source)
            )
    return default(field, role, "the striker began unless more is told")


# ------------------------------------------------------------------ what sentences tell
def _told_signs(statements: Sequence[Statement], known: set[str]) -> Iterator[RoleEvidence]:
    for sentence in statements:
        named = [v for v in MENTION.findall(sentence.text) if v in known]
        owner = named[0] if named else sentence.subject
        if owner in known and owner is not None:
            yield from _of_sentence(sentence, owner)


def _signs_on_foot(statements: Sequence[Statement], known: set[str], pair: Sequence[str]) -> Iterator[RoleEvidence]:
    """What the one of the pair that is no vehicle (a person, a cyclist, an animal) does against the right of way.

    In statements it has its noun, or a number that no vehicle has.
    """
    others = [name for name in pair if name not in known]
    for sentence in statements if len(others) == 1 else ():
        found = rule("crash_roles.stepped_out").search(sentence.text.lower())
        if found and found["who"].upper() not in known:
            source = Source(sentence.number, sentence.text[:60], "crash_roles.stepped_out")
            yield RoleEvidence(others[0], _BROKE, "crash_roles.stepped_out", source)


def _of_sentence(sentence: Statement, owner: str) -> Iterator[RoleEvidence]:
    text = sentence.text.lower()
    coded = sentence.role == "codes" or (sentence.role != "factors" and bool(rule("crash_roles.coded").search(text)))
    if (read := _read(text, sentence.subject == owner, coded)) is not None:
        weight, name = read
        yield RoleEvidence(owner, weight, name, Source(sentence.number, text[:60], name))


def _read(text: str, is_subject: bool, coded: bool) -> tuple[float, str] | None:
    """What a sentence says of its owner: a weight and the rule; `coded`: whether it quotes codes."""
    if rule("crash_roles.reason").search(text):
        none = rule("crash_roles.reason_none").search(text)
        return (-_REASON, "crash_roles.reason_none") if none else (_REASON, "crash_roles.reason")
    if is_subject and rule("crash_roles.came_over").search(text):
        return _BROKE, "crash_roles.came_over"
    if coded and rule("critical_events.event").search(text):
        return None if rule("crash_roles.no_event").search(text) else _read_event(text)
    if rule("crash_roles.cited").search(text) and not rule("crash_roles.not_cited").search(text):
        return _CITED, "crash_roles.cited"
    if is_subject and rule("crash_roles.broke_a_rule").search(text):
        return _BROKE, "crash_roles.broke_a_rule"
    return None


def _read_event(text: str) -> tuple[float, str]:
    """What a critical event says of its owner."""
    if rule("crash_roles.ran_into").search(text):
        return _EVENT, "crash_roles.ran_into"
    if rule("crash_roles.encroached").search(text):
        return -_EVENT, "crash_roles.encroached"
    return _EVENT, "critical_events.event"


# ------------------------------------------------------------------ what maneuvers suggest
def _maneuver_signs(crash: CrashFacts) -> Iterator[RoleEvidence]:
    for v in crash.vehicles:
        yield RoleEvidence(v.id, _MANEUVER * _begins(v), "crash_roles.maneuver")
    for contact in crash.contacts[:1]:
        backed = any(v.id == contact.struck and v.maneuver == "backing" for v in crash.vehicles)
        if contact.striker_area == "front" and contact.struck_area == "back" and not backed:
            yield RoleEvidence(contact.striker, _RAN_INTO, "crash_roles.rear end")


def _begins(v: VehicleFacts) -> float:
    more = _FROM_DRIVEWAY if v.origin in DRIVES else _FROM_STOP if v.from_stop else 0.0
    return _BEGINS.get(v.maneuver, 0.0) + more
