"""Takes personal data out of a narrative; the course of the crash stays.

Sex, age, names, licence, health and injury data, numbers of reports, badges and plates are of no use to a scenario and
never reach a prompt. Motion is never touched: a sentence goes only if it tells of persons alone. Knows no crash facts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.text.traced_text import TracedText, joined

_PERSON_ONLY = rule("privacy.person_only")
_CRASH = rule("privacy.crash")
_PLURAL = {"was": "were", "is": "are", "has": "have", "does": "do", "wasn't": "weren't"}
_MENTION = rule("privacy.mention")
_PERSON = rule("privacy.person")


def redact(text: str) -> str:
    """The narrative without persons: sentences about people alone dropped, ages, sexes and names replaced."""
    return redacted(TracedText.of(text)).text


def redacted(text: TracedText) -> TracedText:
    """`redact` of a text whose characters know their places."""
    out = joined(list(_parts_without_persons(text.split(rule("privacy.sentence_end")))))
    out = out.sub(rule("privacy.age"), lambda m: f"{m.group('the') or 'a '}person ").sub(
        rule("privacy.name"), "a person"
    )
    out = out.sub(rule("privacy.identifier"), lambda m: f"{m['what']} (number left out)")
    out = out.sub(rule("privacy.sex"), lambda m: _person(m.group(0), m.group(1))).sub(
        rule("privacy.person_before_role"), r"\1"
    )
    for pronoun in of_role("personal_pronoun"):
        out = out.sub(pronoun, pronoun.yields["to"])
    out = out.sub(rule("privacy.agreement"), lambda m: m.group(1) + _PLURAL[m.group(2)])
    out = out.sub(rule("privacy.sentence_begins"), r"\1A person").sub(rule("privacy.spaces"), " ")
    return out.sub(rule("privacy.space_before_mark"), r"\1").strip()


def _parts_without_persons(sentences: Iterable[TracedText]) -> Iterator[TracedText]:
    """Sentences without persons; after a dropped sentence that named the vehicle, "he" or "she" in the next one names
    it.

    A dropped sentence about the driver of a study leaves "is driving": all that follows is about that driver,
    even in the same sentence.
    """
    named: str | None = None
    for sentence in sentences:
        kept = _without_persons(sentence)
        mention = _MENTION.search(sentence.text)
        watched = rule("near_names.watched")
        if not kept.text.strip(" .!?") and watched.match(sentence.text):
            kept = sentence.sub(watched, r"\1\2 is driving. ", 1)
        elif kept.text != sentence.text and (who := watched.match(sentence.text)) and not watched.match(kept.text):
            kept = joined([sentence.cut(0, who.end("subject")).sub(watched, r"\1\2 is driving and "), kept])
        elif not kept.text.strip(" .!?"):
            named = mention.group(0) if mention else named
        elif _PERSON.match(kept.text) and named:
            kept, named = kept.sub(_PERSON, rf"\1The driver of {named}", 1), None
        elif _MENTION.search(kept.text):
            named = None
        yield kept


def _without_persons(sentence: TracedText) -> TracedText:
    """A sentence without the clauses that tell of persons alone; its end mark and line break stay.

    Clauses go whole. What is left begins with the subject of the first clause if that went and the next one has none,
    and a clause that cannot stand by itself ("which then rolled over") keeps the whole sentence.
    """
    if not _PERSON_ONLY.search(sentence.text):
        return sentence
    ends = rule("privacy.body_and_end").fullmatch(sentence.text).start(2)  # type: ignore[union-attr]
    body, end = sentence.cut(0, ends), sentence.cut(ends, len(sentence.text))
    clauses = body.sub(rule("privacy.unhurt"), "").split(rule("privacy.clause"))
    gone = [_tells_of_persons_alone(clause.text) for clause in clauses]
    left = "".join(c.text for c, out in zip(clauses, gone, strict=True) if not out)
    if not any(gone) or rule("privacy.leaning").match(_first_left(clauses, gone)):
        return joined([*clauses, end])
    if not _CRASH.search(left) and (gone[0] or rule("privacy.person_subject").match(left)):
        return end.strip(".!? ")  # what is left tells of a person, or has lost its subject and tells of no motion
    text = (
        joined(list(_kept(clauses, gone)))
        .strip(" ,;")
        .sub(rule("privacy.connector"), "")
        .sub(rule("privacy.left_open"), "")
    )
    if gone[0] and not rule("privacy.verb_begins").match(text.text):
        text = text.sub(rule("privacy.small_beginning"), lambda m: m.group(0).upper(), 1)
    elif gone[0] and (lost := _subject(clauses[0])):
        text = joined([lost, text], " ")
    space = body.cut(0, rule("privacy.leading_space").match(body.text).end())  # type: ignore[union-attr]
    return joined([space, text, end]) if text.text else end.strip(".!? ")


def _first_left(clauses: Sequence[TracedText], gone: Sequence[bool]) -> str:
    """The first clause that stays, if the first of all goes."""
    return next((c.text for c, out in zip(clauses, gone, strict=True) if not out), "") if gone[0] else ""


def _kept(clauses: Sequence[TracedText], gone: Sequence[bool]) -> Iterator[TracedText]:
    """Clauses that stay; behind an insertion that goes, its closing comma goes as well."""
    inserted = False
    for clause, out in zip(clauses, gone, strict=True):
        if not out:
            yield clause.cut(1, len(clause.text)) if inserted and clause.text.startswith(",") else clause
        inserted = out and bool(rule("privacy.insertion").match(clause.text))


def _subject(clause: TracedText) -> TracedText | None:
    """The subject of a clause that went, for a verb that stays; None where none is seen."""
    found = rule("privacy.subject").match(clause.text)
    return clause.cut(found.start("subject"), found.end("subject")) if found else None


def _tells_of_persons_alone(clause: str) -> bool:
    return bool(_PERSON_ONLY.search(clause)) and not _CRASH.search(clause)


def _person(found: str, role: str | None) -> str:
    article = "a " if found.lower().startswith(("a ", "an ")) else ""
    return article + (role or "person")
