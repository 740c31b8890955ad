"""Features of the learned reader: the words around the contact's pair, and the values of the rules.

Words are those of the sentences with every actor named by number, so that the subject, its partner and any other actor
are three words, and every number is one. Nothing is weighed here; knows no weights.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from sgcad_core.reading import reading as stages
from sgcad_core.reading.actors.references import has_actor_numbers
from sgcad_core.reading.inference.inference_state import CrashTold
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.second_reader.seven_question_gist import (
    FIELDS,
    SUBJECT,
    RuleValues,
    meeting,
    partner,
    rule_values,
)
from sgcad_core.reading.text.report_styles import tells_study
from sgcad_core.reading.text.traced_text import TracedText

_PAIRS = (
    ("subject", "other"), ("subject_area", "other_area"), ("subject", "subject_area"), ("other", "other_area"),
    ("subject", "other_area"), ("other", "subject_area"), ("met", "other"),
)  # fmt: skip
"""Fields whose values go or do not go together."""
_OF_VEHICLE = ("maneuver", "origin", "target", "from_stop", "meant_maneuver", "lane_word")
_WHOLE, _ABOUT, _LAST = 3, 14, 10
"""Words in a row of the whole text; words of a stretch about one vehicle, and of its last one, that count."""
_BLOWS = 3


class Account(NamedTuple):
    """A report as its reading's stages left it, and the subject's partner by the rules."""

    reading: Reading
    statements: tuple[Statement, ...]
    segments: tuple[Segment, ...]
    crash_told: CrashTold
    say: RuleValues
    partner: str | None


def account_of(narrative: str) -> Account:
    """Reads a narrative by the rules and keeps the results of the stages."""
    even = stages.normalise(TracedText.of(narrative))
    found = stages.sentences(even)
    named = stages.mentions(found, not has_actor_numbers(even.text))
    cut = stages.clauses(named)
    seen = stages.events(found, named, cut, of_study=tells_study(even.text))
    reading = stages.infer(narrative, found, named, seen)
    contact = meeting(reading.crash)
    met = partner(contact) if contact else None
    return Account(reading, named.statements, cut, seen.crash_told, rule_values(reading), met)


# ------------------------------------------------------------------ words
def words(account: Account) -> set[str]:
    """One to three words in a row: of the whole text; before, in and behind the contact's sentence; of the stretches
    about the subject and about its partner; of the last such stretch up to the contact."""
    hit = _contact_at(account.crash_told)
    found: set[str] = set()
    for told in account.statements:
        if told.role != "formal":
            said = _tokens(told.text, account.partner)
            found |= {f"U:{g}" for g in _grams(said, _WHOLE)}
            found |= {f"P{_place(told.number, hit)}:{g}" for g in _grams(said, 2)}
    for tag, name in (("S", SUBJECT), ("O", account.partner)):
        about = [s for s in account.segments if s.role != "formal" and name is not None and name in s.subjects]
        for one in about:
            found |= {f"{tag}:{g}" for g in _grams(_tokens(one.text, account.partner)[:_ABOUT], _WHOLE)}
        if before := [s for s in about if hit is None or s.number <= hit]:
            found |= {f"{tag}L:{g}" for g in _grams(_tokens(before[-1].text, account.partner)[:_LAST], 2)}
    return found


def runs(found: Iterable[str]) -> set[str]:
    """Features of two and three words in a row; the share of known ones tells how foreign a text is."""
    return {one for one in found if one.startswith("U:") and "_" in one}


def _contact_at(crash: CrashTold) -> int | None:
    mine = [b.number for b in crash.contact_mentions if SUBJECT in (b.actor, b.other)] or [
        b.number for b in crash.contact_mentions
    ]
    return mine[0] if mine else None


def _place(number: int, hit: int | None) -> str:
    if hit is None:
        return "n"
    return "b" if number < hit else "c" if number == hit else "a"


def _tokens(text: str, met: str | None) -> list[str]:
    return [_role(m.group(), met) for m in rule("wordings.token").finditer(text.lower().replace("'s", ""))]


def _role(word: str, met: str | None) -> str:
    """A word, or its actor's part (subject, partner, third); numbers are one word."""
    if word.isdigit():
        return "NUM"
    if not (word[0] == "v" and word[1:].isdigit()):
        return word
    if word == SUBJECT.lower():
        return "SUBJ"
    return "OTH" if met is None or word == met.lower() else "THIRD"


def _grams(said: Sequence[str], most: int) -> Iterator[str]:
    for n in range(1, most + 1):
        for i in range(len(said) - n + 1):
            yield "_".join(said[i : i + n])


# ------------------------------------------------------------------ what the rules say
def readings(account: Account) -> set[str]:
    """Values of the rules, alone and in pairs, with their rules; maneuver cues and contacts as they were read."""
    found = {*_values(account.say), *_facts(account), *_cue_features(account), *_contact_features(account.crash_told)}
    crash = account.reading.crash
    found |= {f"vehicles={min(len(crash.vehicles), 4)}", f"near={crash.near_crash is not None}"}
    return found | {f"junction={account.reading.roads.junction.kind}"}


def _values(say: RuleValues) -> Iterator[str]:
    for key in FIELDS:
        yield f"{key}={say.values.get(key)}"
        yield f"{key}={say.values.get(key)}&{key in say.told}"
    for one, other in _PAIRS:
        yield f"{one}={say.values.get(one)}&{other}={say.values.get(other)}"


def _facts(account: Account) -> Iterator[str]:
    names = {SUBJECT: "S", account.partner: "O"}
    for fact in account.reading.facts:
        group, name, what = (*fact.field.split("."), "", "")[:3]
        if group == "contacts" and name == "0":
            yield f"contact.{what}:{fact.rule}"
        elif group == "vehicles" and name in names and what in _OF_VEHICLE:
            yield f"{names[name]}.{what}={fact.value}"
            yield f"{names[name]}.{what}:{fact.rule}"
            yield f"{names[name]}.{what}={fact.value}:{fact.rule}:{fact.confidence}"


def _cue_features(account: Account) -> Iterator[str]:
    for tag, name in (("S", SUBJECT), ("O", account.partner)):
        motion = account.crash_told.motions.get(name or "")
        cues = [cue.kind for cue in motion.cues] if motion else []
        yield f"{tag}deeds={min(len(cues), 4)}"
        yield from (f"{tag}deed={kind}" for kind in cues)
        yield from (f"{tag}last={kind}" for kind in cues[-1:])


def _contact_features(crash: CrashTold) -> Iterator[str]:
    mine = [b for b in crash.contact_mentions if SUBJECT in (b.actor, b.other)]
    yield f"blows={min(len(crash.contact_mentions), 3)}/{min(len(mine), 3)}"
    for mention in mine[:_BLOWS]:
        acts = mention.actor == SUBJECT
        sides = mention.areas_of(SUBJECT)
        yield f"blow acts={acts} passive={mention.passive} mutual={mention.mutual} noun={mention.noun}"
        yield f"blow mine={sides[0]}"
        yield f"blow theirs={sides[1]}"
        yield f"blow word={mention.words}"
