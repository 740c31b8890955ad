"""Notes of a case as records: the remark of a step, its subject, its place in the report. Knows no file.

kind: `reader` (the report's files), `limit` (beyond what is read or driven), `finding` (a validator's remark), `held`
(what a model's answer was held to), `judge` (a second simulator), `place` (the real place), `plan` (what
writer and planner changed or left out).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Literal

from sgcad_core.reading.inference.reading_limits import BEYOND
from sgcad_core.record_base import Record
from sgcad_core.records.facts import Fact

NoteKind = Literal["reader", "limit", "finding", "held", "judge", "place", "plan"]
_ID = re.compile(r"\b[VNPBTOA]\d{1,2}\b")
_WORDS = {
    "rest": "rest.",
    "lane": "lane",
    "speed": "speed",
    "mph": "speed",
    "heading": "heading",
    "maneuver": "maneuver",
}


class Note(Record):
    """One remark; `field` and `subject` are empty for the whole case, start and end None without a sentence."""

    kind: NoteKind
    field: str = ""
    subject: str = ""
    text: str
    start: int | None = None
    end: int | None = None


def notes_of(kind: NoteKind, texts: Iterable[str], facts: Mapping[str, Fact], field: str = "") -> list[Note]:
    """Notes of plain remarks: the subject is the first actor named, field and sentence those of its fact."""
    return [_note(kind, text, facts, field) for text in texts]


def _note(kind: NoteKind, text: str, facts: Mapping[str, Fact], field: str) -> Note:
    subject = match[0] if (match := _ID.search(text)) else ""
    field = field or _field(subject, text, facts)
    fact = facts.get(field)
    place = (fact.start, fact.end) if fact else (None, None)
    kind = "limit" if text.startswith(BEYOND) else kind
    return Note(kind=kind, field=field, subject=subject, text=text, start=place[0], end=place[1])


def _field(subject: str, text: str, facts: Mapping[str, Fact]) -> str:
    """The name of the actor's fact that the words mention, else of the contact of two named actors."""
    names = list(dict.fromkeys(_ID.findall(text)))
    told = [name for name in facts if name.startswith((f"vehicles.{subject}.", f"others.{subject}."))]
    wanted = [start for word, start in _WORDS.items() if re.search(rf"\b{word}\b", text)]
    found = next((name for name in told for w in wanted if name.split(".", 2)[2].startswith(w)), "")
    if found or len(names) < 2:
        return found
    return next((name for name, fact in facts.items() if _between(name, fact, names, facts)), "")


def _between(name: str, fact: Fact, names: list[str], facts: Mapping[str, Fact]) -> bool:
    if not name.endswith((".striker", ".actor")):
        return False
    other = facts.get(name.replace(".striker", ".struck").replace(".actor", ".other"))
    return other is not None and {fact.value, other.value} == set(names[:2])
