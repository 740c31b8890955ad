"""Whose deed is it: resolved sentences cut into segments, each with the vehicles that are its subject.

A segment runs from one subject to the next. A mention is a subject where a verb follows it and no
preposition stands before it ("behind V2", "struck V2"), or where a relative clause or participle begins
("V2, which was stopped"). Pronouns take the subject of the sentence before. Knows no motion words.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from sgcad_core.narrative.roles import role_of
from sgcad_core.narrative.text import Role, Sentence
from sgcad_core.narrative.vehicles import MENTION, Roster


class Segment(NamedTuple):
    """A stretch of a sentence about some vehicles; `text` starts behind the mention, lower case."""

    subjects: tuple[str, ...]
    text: str
    role: Role
    number: int
    """Of the sentence."""


class Told(NamedTuple):
    """A sentence with every vehicle named by its number, and the vehicle it is mainly about."""

    text: str
    role: Role
    number: int
    subject: str | None
    several: bool = False
    """Whether "they" at its start means all vehicles, not the driver of one."""


_LIST = r"V\d+(?:(?:, (?:and )?| and | & )V\d+)+"
_BOTH = r"\b(?:both|all(?: \w+)?|the two|these|the three|the) (?:of the )?(?:vehicles|drivers|cars)\b|"
_BOTH += r"\bboth (?=were|are|had)"
_STRANGER = (
    r"\b(?:an?|another|some|several|unknown|uninvolved|non-?contact|other|the (?:unknown|uninvolved|"
    r"non-?contact|lead|other)) "
    r"(?:(?!(?:of|and|was|in|to|for|by|with|the)\b)[\w-]+ ){0,3}?(?:vehicle|car|truck|bus|van|suv|pickup|motorist|"
    r"driver|pedestrian|animal|deer|traffic)s?\b"
    r"(?: (?:directly |stopped |also )?(?:ahead|in front|behind)(?: of (?:it|him|her|them|V\d+))?)?|"
    r"\b(?:the|a) (?:vehicle|car|truck|traffic|driver) (?:directly |immediately )?(?:ahead|in front|behind)(?: of "
    r"(?:it|him|her|them|V\d+))?"
)
_SUBJECT = re.compile(
    rf"(?P<both>{_BOTH})|(?P<stranger>{_STRANGER})|(?P<list>{_LIST})(?:'s?)?(?: (?:drivers|vehicles))?|"
    rf"(?P<one>V\d+)(?P<owner>'s (?:driver|"
    rf"operator))?(?!')", re.I)  # fmt: skip
_VERB = re.compile(
    r"\s*,\s*(?:after|while|when|upon|having|being|without|trying|in an|for an?|due|also|apparently|not|failing|"
    r"once|as)\b|"
    r"\s*(?:,\s*)?(?:\([^)]*\)\s*)?(?:(?:which|that|who|and)\s+)?(?:(?:then|also|both|each|all|initially|"
    r"suddenly|apparently|just|still|"
    r"never|now|first|had|has|was|were|is|are|being|been|not|had|did|does|may|might|could|would|should|\w+ly)\s+)*"
    r"(?:[\w-]+(?:ed|ing|s)\b|driven|was|were|is|are|had|did|went|ran|came|comes|made|began|begun|lost|drove|left|"
    r"swung|"
    r"slid|spun|fell|took|"
    r"saw|struck|hit|cut|put|set|got|sped|shot|swept|stuck|could|would|may|might|north\w*|south\w*|east\w*|"
    r"west\w*|behind|ahead)\b", re.I)  # fmt: skip
_PARTICIPLE = re.compile(
    r"\s*(?:,\s*)?(?:(?:which|that|who)\s+\w+|(?:already|still|just|also|suddenly)?\s*(?:traveling|turning|"
    r"stopped|stopping|crossing|making|parked|"
    r"waiting|coming|approaching|entering|exiting|slowing|pulling out|attempting|pulling|towing|moving|facing|"
    r"heading|going|"
    r"driving|proceeding|"
    r"changing|backing|merging|turned|turns|turn|pull|pulled|was|were|had|is|began|begin|entered|enter|slow|"
    r"slowed|stop|"
    r"come|came|cross|crossed|proceed|proceeded|move|moved|did|north\w*|south\w*|east\w*|west\w*)\b)",
    re.I)  # fmt: skip
_PREPOSITION = re.compile(
    r"(?:\b(?:of|by|to|with|behind|from|into|onto|for|against|over|under|underneath|across|through|toward|towards|"
    r"between|than|past|around|at|on|"
    r"in|before|ahead of|"
    r"struck|hit|hits|strikes|saw|see|seen|noticed|observed|avoid|avoided|avoiding|striking|hitting|impacted|"
    r"impacting|contacted|"
    r"contacting|allow|allowed|following|passing|pass|passed|overtaking|rear-ended|approaching|approached|caused|"
    r"causing|cause|"
    r"pushing|pushed|push|watched|let|waved|near|beside|realized|clear|cleared|toward|via|upon|sideswiped|"
    r"clipped|the|a|an|this|"
    r"signaled|believed|thought|stated|that|spotted|not see)\s*)$", re.I)  # fmt: skip
_ASIDE = re.compile(r"^\s*,\s*(?:an?|the|aged?|who (?:was|is))\b[^,;.]{0,70},", re.I)
_BESIDE = re.compile(
    r"\b(?:ahead of|in front of|behind|beside|next to|alongside|past|following|passing|"
    r"overtaking)\s*$",
    re.I,
)
_REPORTS = re.compile(r"\b(?:that|saw|see|noticed|observed|believed|thought|stated|realized|spotted|watched)\s*$", re.I)
_DRIVER_OF = re.compile(
    r"\b(?:driver|operator|driver's side|front|rear|side|left|right|corner|end|bumper|half|"
    r"portion)s? (?:\w+ )?of\s*$",
    re.I,
)
_PRONOUN = re.compile(
    r"^(?:(?:however|then|next|as|when|while|after|once|before|at (?:that|this) (?:time|point)),?\s+)?"
    r"(?:it(?! (?:was|is|had) (?:\w+ )?(?:day\w*|dark|dusk|dawn|rain\w*|snow\w*|clear|cloudy|the|a|an|possible|"
    r"\w*believed|thought|known|"
    r"unknown|noted|not known|likely|determined))|he|she|they|this vehicle|"
    r"the (?:driver|vehicle|operator|car|truck|van|bus|motorcycle)|this driver|his|her|their|its)\b"
    r"(?! (?:of|should)\b)",
    re.I)  # fmt: skip


def tell(sentences: Iterable[Sentence], who: Roster) -> tuple[Told, ...]:
    """Sentences with vehicles resolved; "the other vehicle" and "this vehicle" follow the subject."""
    told: list[Told] = []
    current: str | None = None
    several = True
    for s in sentences:
        text = who.resolve(s.text)
        text = _others(text, who, current, s.role)
        role = role_of(text) if s.role in ("other", "road") and text != s.text else s.role
        current = _main_subject(text, current, role, who)
        told.append(Told(text, role, s.number, current, several))
        several = _of_several(text, several)
    return tuple(told)


def _of_several(text: str, before: bool) -> bool:
    """Whether a following "they" means several vehicles: the last subject was all, a list, or nobody."""
    if _PRONOUN.match(text):
        return before
    if re.search(_BOTH, text, re.I) or re.search(_LIST, text):
        return True
    return before and not MENTION.search(text)


def _others(text: str, who: Roster, current: str | None, role: Role) -> str:
    """ "the other vehicle" as a number, where two vehicles leave no doubt."""
    subject = next((v for v in MENTION.findall(text) if v in who.ids), None) or current
    other = who.other(subject) if subject else None
    if other:
        text = re.sub(
            r"\b(?:the|an) (?:other|oncoming|opposing|approaching) (?:vehicle|car|driver|truck)\b(?!s)",
            other,
            text,
            flags=re.I,
        )
    if current and role not in ("codes", "factors"):
        pattern = r"\b(?:this vehicle|this driver)\b(?! (?:travel|turn|going|cross|over|off|driver))"
        text = re.sub(pattern, current, text, flags=re.I)
    return text


def _main_subject(text: str, current: str | None, role: Role, who: Roster) -> str | None:
    """The vehicle that a pronoun in the next sentence means; a number that is no vehicle's is nobody's."""
    if _PRONOUN.match(text) and current:
        return current
    first = next((m for m in MENTION.finditer(text) if m[0] in who.ids), None)
    if not first:
        return current
    opening = text[: first.start()]
    early = len(opening.split()) <= 8 or role in ("codes", "factors")
    return first.group() if early or current is None else current


def segments(told: Iterable[Told], who: Roster) -> tuple[Segment, ...]:
    """Every stretch of text with its subjects, in order; text before the first subject is left out."""
    found: list[Segment] = []
    for t in told:
        found += _cut(t, who)
    return tuple(found)


def _cut(told: Told, who: Roster) -> list[Segment]:
    starts = subject_starts(told, who)
    ends = [at for at, _, _ in starts[1:]] + [len(told.text)][: len(starts)]
    return [
        Segment(subjects, told.text[begin:end].lower().strip(" ,"), told.role, told.number)
        for (_, begin, subjects), end in zip(starts, ends, strict=True)
        if subjects
    ]


def subject_starts(told: Told, who: Roster) -> list[tuple[int, int, tuple[str, ...]]]:
    """(where the mention stands, where its text begins, who) of each subject."""
    text = told.text
    starts: list[tuple[int, int, tuple[str, ...]]] = []
    pronoun = _PRONOUN.match(text)
    if pronoun and told.subject:
        everyone = len(who.ids) == 2 and re.search(r"\bthey\b", pronoun.group(), re.I) and _means_all(told, pronoun)
        starts.append((0, pronoun.end(), who.ids if everyone else (told.subject,)))
    for m in _SUBJECT.finditer(text):
        subjects = _whom(m, who)
        if (subjects or m.group("stranger")) and _is_subject(text, m):
            starts.append((m.start(), m.end(), subjects))
    return starts


def _means_all(told: Told, pronoun: re.Match[str]) -> bool:
    return told.several or bool(re.match(r" (?:were |are |had )?(?:both|each)\b", told.text[pronoun.end() :], re.I))


def _whom(match: re.Match[str], who: Roster) -> tuple[str, ...]:
    if match.group("stranger"):
        return ()
    if match.group("both"):
        return who.ids if len(who.ids) > 1 else ()
    return tuple(v for v in MENTION.findall(match.group()) if v in who.ids)


def _is_subject(text: str, match: re.Match[str]) -> bool:
    before = text[max(0, match.start() - 60) : match.start()]
    behind = _ASIDE.sub("", text[match.end() :])
    if _DRIVER_OF.search(before):
        return bool(_VERB.match(behind))
    if _BESIDE.search(before):
        return bool(re.match(r"\s*,?\s*(?:which|that|who)\b", behind))
    if _PREPOSITION.search(before):
        reported = _REPORTS.search(before)
        return bool(_PARTICIPLE.match(behind)) or bool(reported and _VERB.match(behind))
    return bool(_VERB.match(behind))
