"""Numbers for the rest of a report that numbers some of its actors: the subject, or who struck it, has none.

"The test vehicle was stopped when vehicle 2 hit it": V1 is free, so it is the subject. "An Acme vehicle (V1) was
stopped. A car behind hit the Acme vehicle": the name is V1's, the car is V2. Such a text is then told as one without
numbers is, in order. Knows what phrases mean, no motion.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import lru_cache

from sgcad_core.reading.actors.references import Numbering, has_actor_numbers, numbered
from sgcad_core.reading.actors.unnumbered_actors import Actor, NamedActors, Phrase
from sgcad_core.reading.language import rule
from sgcad_core.reading.text.traced_text import TracedText

_PHRASE = rule("references.phrase")
_NUMBER = rule("common.vehicle")


def counts_itself(text: str) -> bool:
    """Whether actors of a normalized report get numbers here: it has none, or none for its subject or its striker."""
    return not has_actor_numbers(text) or _cast(text) is not None


def number_the_rest(text: TracedText) -> TracedText:
    """The normalized text with numbers for those that have none; unchanged where none or all are numbered."""
    cast = _cast(text.text) if has_actor_numbers(text.text) else None
    return text if cast is None else numbered(text, _Rest(cast))


def _cast(text: str) -> NamedActors | None:
    """The actors that a text numbers, its subject told; None where all that take part are numbered."""
    told = _told(text)
    if told is None:
        return None
    subject, automated, taken = told
    actors = [Actor(n, "vehicle", set(), subject=n == subject) for n in sorted(taken)]
    unnamed = [Actor(subject, "vehicle", set(), subject=True)] if automated and subject not in taken else []
    return NamedActors([*unnamed, *actors], automated, taken)


@lru_cache(maxsize=1)  # one report is asked about twice
def _told(text: str) -> tuple[int, bool, frozenset[int]] | None:
    """The subject's number, whether it has words of its own, and the numbers in a text; None as for `_cast`."""
    taken = frozenset(int(m.group()[1:]) for m in _NUMBER.finditer(text))
    phrases = list(_PHRASE.finditer(text))
    automated = any(m["automated"] for m in phrases)
    named = next((int(n["number"]) for m in phrases if (n := _number_of_name(m))), None)
    subject = named or (1 if 1 not in taken and (automated or _has_subject(phrases)) else None)
    if subject is None and taken == {1}:
        subject = 2 if automated else 1 if rule("part_numbers.stranger_hits").search(text) else None
    return None if subject is None else (subject, automated, taken)


def _number_of_name(match: re.Match[str]) -> re.Match[str] | None:
    """The number behind an automated vehicle or one that is called by a company's name."""
    number = rule("part_numbers.behind").match(match.string, match.end())
    return number if number and (match["automated"] or _of_company(match)) else None


def _of_company(match: re.Match[str]) -> bool:
    """Whether a company's name marks a vehicle that has no other word: "an Acme vehicle"."""
    words = match.group()[len(match["det"] or "") :].strip()
    return Phrase(match).kind == "vehicle" and bool(rule("references.branded").match(words))


def _has_subject(phrases: list[re.Match[str]]) -> bool:
    """Whether a road user without a number is named."""
    told = (m for m in phrases if m["det"] and not m["user"])
    return any(_number_of(m) is None for m in told)


def _number_of(match: re.Match[str]) -> re.Match[str] | None:
    """The number that stands right behind a phrase, or before one with "a"."""
    number = rule("part_numbers.behind").match(match.string, match.end())
    if number is None and (match["det"] or "").lower() in ("a", "an"):
        number = rule("part_numbers.before").search(match.string[: match.start()])
    return number


@dataclass
class _Rest(Numbering):
    """Fills in numbers beside those of the report."""

    told: str = field(default="", repr=False)
    """The sentence that is being read, up to `upto`."""
    upto: int = 0

    def fill(self, match: re.Match[str]) -> str:
        """The replacement of a phrase; one that describes a numbered actor stays, and its words are known then."""
        self._follow(match)
        phrase = Phrase(match)
        actor = self._described_beside(match)
        if actor is None or match["many"]:
            return super().fill(match)
        actor.heads.add(phrase.head)
        actor.names |= phrase.names
        actor.kind, actor.at = phrase.kind if actor.kind == "vehicle" else actor.kind, self.at
        actor.part, actor.stands = actor.part or phrase.part, actor.stands or phrase.stands
        return match.group()

    def _described_beside(self, match: re.Match[str]) -> Actor | None:
        """The actor whose number stands beside a phrase."""
        number = _number_of(match)
        return next((a for a in self.cast.actors if number and a.number == int(number["number"])), None)

    def _follow(self, match: re.Match[str]) -> None:
        """Take note of the numbers that stand before a phrase."""
        if match.string != self.told:
            self._mentioned(self.told, self.upto, len(self.told))
            self.told, self.upto = match.string, 0
        self._mentioned(match.string, self.upto, match.start())
        self.upto = match.start()

    def _mentioned(self, text: str, begin: int, end: int) -> None:
        for m in _NUMBER.finditer(text, begin, end):
            for actor in self.cast.actors:
                if actor.number == int(m.group()[1:]):
                    self.at += 1
                    actor.at = self.at

    def _known(self, phrase: Phrase) -> Actor | None:
        known = super()._known(phrase)
        match = phrase.match
        named = match["automated"] or _of_company(match)  # "struck the Acme vehicle from the rear" tells no place of it
        elsewhere = phrase.part or rule("references.elsewhere").match(match.string, match.end())
        beside = elsewhere and not named
        if known and known.subject and beside:
            known = None  # "the vehicle behind" is not the numbered one itself
        new = known is not None and not known.subject and not known.at and phrase.order is None
        return None if new else known
