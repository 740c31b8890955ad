"""Numbers for the actors of a report that has none: every noun phrase of an actor becomes that actor's number.

"The test vehicle was stopped when a white van hit it. The van left." becomes "V1 was stopped when a white van (V2) hit
it. V2 left.", so that all later stages work on numbers. The subject of the report is V1, the others follow in the order
in which they are named; a text that has any number stays as it is. People and animals count here, too: `Roster.called`
gives their own letters. Knows what phrases mean, no motion.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass

from sgcad_core.reading.actors.makes import BODY_WORDS, is_ridden, no_vehicle, on_foot
from sgcad_core.reading.actors.unnumbered_actors import TRUCK_PARTS, Actor, NamedActors, Phrase
from sgcad_core.reading.language import rule
from sgcad_core.reading.text.traced_text import TracedText, joined

_PHRASE = rule("references.phrase")
_OWNERS = ("his", "her", "their")
"""Determiners of a person's own vehicle, which is named so where no vehicle was named before: "a woman was hurt when
her car ..."."""
_NEAR = 40
"""Characters before a phrase in which a word may say that it is of a stranger."""


def has_actor_numbers(text: str) -> bool:
    """Whether a normalized report numbers any actor."""
    return bool(rule("common.vehicle").search(text))


def number_actors(text: TracedText) -> TracedText:
    """The normalized text with a number for every actor; unchanged if there is any number."""
    if has_actor_numbers(text.text):
        return text
    if rule("references.system_drives").search(text.text):
        text = text.sub(rule("references.system"), lambda m: f"{m['the']} ADS vehicle{m['owner'] or ''}")
    automated = any(m["automated"] for m in _PHRASE.finditer(text.text))
    if not automated and (name := _company(text.text)):
        text, automated = text.sub(rule("references.of_company").given(name=re.escape(name)), rf"{name} AV"), True
    for name in _companies(text.text):
        text = text.sub(rule("references.short_name").given(name=re.escape(name)), rf"\1 {name} AV")
    cast = NamedActors([Actor(1, "vehicle", set(), subject=True)] if automated else [], automated)
    return numbered(text, Numbering(cast))


def numbered(text: TracedText, numbering: Numbering) -> TracedText:
    """The text with a number for every actor that the numbering accepts, block by block."""
    blocks = [_numbered(block, numbering) for block in text.split_at("\n\n")]
    return joined(blocks, "\n\n")


def _numbered(block: TracedText, numbering: Numbering) -> TracedText:
    pieces: list[TracedText] = []
    at = 0
    for end in [m.end() for m in rule("text.end").finditer(block.text)] + [len(block.text)]:
        piece, at = block.cut(at, end), end
        formal = rule("roles.formal").search(piece.text)
        numbering.announcing = numbering.alone and bool(rule("references.announced").search(piece.text))
        pieces.append(piece if formal else piece.sub(_PHRASE, numbering.fill))
    return joined(pieces)


def _companies(text: str) -> list[str]:
    """Company names by which a report calls the automated vehicle: "the Acme AV"."""
    called = (rule("references.branded").match(m["automated"]) for m in _PHRASE.finditer(text) if m["automated"])
    return list(dict.fromkeys(name.group().strip() for name in called if name))


def _company(text: str) -> str | None:
    """The company whose vehicle a report of automated driving is about: the one named most, first of all."""
    if not rule("references.drives_itself").search(text):
        return None
    counts = Counter(m["name"] for m in rule("references.company_vehicle").finditer(text))
    return max(counts, key=lambda name: counts[name]) if counts else None


@dataclass
class Numbering:
    """Fills in numbers, phrase by phrase in the order of the text."""

    cast: NamedActors
    announcing: bool = False
    at: int = 0
    last: tuple[re.Match[str], Actor] | None = None
    """The phrase before, and its actor."""

    @property
    def alone(self) -> bool:
        """Whether only the subject was named so far."""
        return all(actor.subject for actor in self.cast.actors)

    def fill(self, match: re.Match[str]) -> str:
        """The replacement of a phrase: the number, at first behind the words that describe the actor."""
        phrase = Phrase(match)
        self.at += 1
        if self.is_no_actor(phrase):
            return match.group()
        if match["attendant"]:
            return f"{'The' if match.group()[0].isupper() else 'the'} driver of V1"
        if same := self._described(match):
            same.heads.add(phrase.head)
            same.names |= phrase.names
            return match.group()
        known = self._known(phrase)
        actor = known or self.cast.add(phrase, self._is_subject(phrase), self.announcing)
        if actor is None:
            return match.group()
        self.last = match, actor
        actor.at = self.at
        parted = known is not None and match.string.startswith("'", match.end())
        actor.stands = actor.stands or phrase.stands
        actor.announced = actor.announced and self.announcing
        words = phrase.head.split() if match["automated"] else phrase.modifiers
        actor.heads |= {phrase.head, *(w for w in words if w in BODY_WORDS)}
        actor.names |= phrase.names
        actor.part = actor.part or phrase.part
        return self._written(phrase, actor, known is None, "" if parted else phrase.clauses)

    def is_no_actor(self, phrase: Phrase) -> bool:
        """Whether a phrase names no single actor that gets a number."""
        match = phrase.match
        before = match.string[max(0, match.start() - _NEAR) : match.start()]
        behind = rule("references.part").match(match.string, match.end())
        owner = match["automated"] or (behind and phrase.definite)
        if match["many"] and (not owner or rule("references.several").search(before)):
            return True
        if match["user"] and match["user"][0].isupper() and not match["det"]:
            return True
        if phrase.head in TRUCK_PARTS and match.string.startswith(" of ", match.end()):
            return True
        if not match["det"] and not match["automated"]:
            return bool(match.start()) or not phrase.order
        if match["det"] and match["det"].lower() in _OWNERS and self.cast.actors:
            return True
        ridden = is_ridden(phrase.kind) and rule("references.ridden").search(before)
        return bool(rule("references.stranger").search(before)) or bool(ridden and self._has(phrase.kind))

    def _described(self, match: re.Match[str]) -> Actor | None:
        """The actor before, where a phrase only describes it: "the other vehicle was a 2031 van", "the car, a van,
        ..."."""
        if self.last is None or self.last[0].string != match.string or (match["det"] or "").lower() not in ("a", "an"):
            return None
        between = match.string[self.last[0].end() : match.start()]
        apposed = (
            between == ", " and match.string[match.end() : match.end() + 1] == "," and Phrase(self.last[0]).definite
        )
        return self.last[1] if apposed or rule("references.was").fullmatch(between) else None

    def _has(self, kind: str) -> bool:
        return any(a.kind == kind for a in self.cast.actors)

    def _is_subject(self, phrase: Phrase) -> bool:
        if self.cast.subject():
            return False
        return bool(phrase.match["automated"]) if self.cast.automated else not on_foot(phrase.kind)

    def _known(self, phrase: Phrase) -> Actor | None:
        match = phrase.match
        subject = self.cast.subject()
        if phrase.match["automated"] and subject and rule("references.aboard").match(match.string, match.end()):
            return subject
        if phrase.match["automated"] and subject and phrase.order in (None, 1) and (phrase.definite or not subject.at):
            return subject
        if phrase.definite:
            return self.cast.meant(phrase) or self.cast.open(phrase)
        return self.cast.open(phrase) if not self.announcing else None

    def _written(self, phrase: Phrase, actor: Actor, first: bool, clauses: str) -> str:
        """The number, at first behind the words that describe the actor, and its `clauses`."""
        match = phrase.match
        owner = "'s" if match["many"] else ""
        if (actor.subject and match["automated"]) or not first:
            return f"V{actor.number}{owner}{clauses}"
        det, words = match["det"] or "the", match.group()[len(match["det"] or "") :].strip()
        det = {"another": "a", "one": "a", **dict.fromkeys(("its", *_OWNERS), "the")}.get(det.lower(), det)
        return self.introduced(f"{det} {words}", f"(V{actor.number}){clauses}")

    def introduced(self, words: str, number: str) -> str:
        """The words that first describe an actor, with its number."""
        return f"{words} {number}"


def number_cyclists(text: TracedText) -> TracedText:
    """A text that numbers V1 alone with all cyclists numbered from V2 on; all others stay as they are.

    Of several numbered vehicles the words alone do not tell which one a cyclist met: those texts stay as well.
    """
    if {m.group() for m in rule("common.vehicle").finditer(text.text)} != {"V1"}:
        return text
    v1 = Actor(1, "vehicle", set(), subject=True)
    return numbered(text, _Cyclists(NamedActors([v1], automated=True)))


class _Cyclists(Numbering):
    """Numbers cyclists alone, and marks them as numbered here; no phrase of a vehicle means V1 or another actor."""

    def is_no_actor(self, phrase: Phrase) -> bool:
        """Whether a phrase names no single actor that gets a number."""
        rides = is_ridden(phrase.kind) and no_vehicle(phrase.kind)
        return not rides or not phrase.match["user"] or super().is_no_actor(phrase)

    def introduced(self, words: str, number: str) -> str:
        """The words that first describe an actor, with its number."""
        return f"{'An' if words[0].isupper() else 'an'} unnumbered {words.partition(' ')[2]} {number}"


def number_parked(text: TracedText) -> TracedText:
    """A numbered text in which the one parked vehicle that is hit and has no number gets the next one."""
    named = list(rule("references.parked").finditer(text.text))
    hits = {m.start("who") for m in rule("references.parked_hit").finditer(text.text)}
    hit = next((m.start() for m in named if m.start() in hits), None)
    if hit is None or not has_actor_numbers(text.text):
        return text
    number = max(int(m.group()[1:]) for m in rule("common.vehicle").finditer(text.text)) + 1
    return text.sub(rule("references.parked"), lambda m: _parked(m, f"V{number}", m.start() - hit))


def _parked(match: re.Match[str], id: str, behind: int) -> str:
    """The number; where it is hit first (`behind` 0) with the words that describe it; another one stays as it is."""
    if behind == 0:
        return f"an unnumbered {match['what']} ({id}), which was parked"
    return id if behind > 0 and match["det"].lower() == "the" else match.group()
