"""What a narrative check asks: the fact that an artifact differs from, with the sentence that states it.

The rules may have misread the report, so their reading is no fault of an answer. Only what a sentence states is asked
about; what the rules concluded or assumed is a note.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal

from sgcad_core.case.records import Fact, Finding, Severity
from sgcad_core.findings import Told
from sgcad_core.reading.reading import Reading
from sgcad_core.record_base import Value

Reader = Literal["rules", "model", "person"]
_BY: dict[str, Reader] = {"text": "rules", "model": "model", "diagram": "model", "person": "person"}


def as_question(finding: Finding, reading: Reading, fields: Iterable[str], value: Value = None) -> Finding:
    """The finding as a question about the first of these fields that a sentence states.

    A doubt where one is stated without a place in the narrative (coded fields), a note where none is stated. `value`:
    what is told, where that is more than the field's own value.
    """
    stated = list(_stated(reading, fields))
    fact = next((fact for fact in stated if fact.end is not None), None)
    severity: Severity = "question" if fact else "doubt" if stated else "note"
    told = _told(reading, fact, value) if fact else None
    return finding.model_copy(update={"severity": severity, "told": told})


def quoted(finding: Finding, reading: Reading, fields: Iterable[str]) -> Finding:
    """The finding with the sentence that states the first of these fields; its severity stays."""
    fact = next((fact for fact in _stated(reading, fields) if fact.end is not None), None)
    return finding.model_copy(update={"told": _told(reading, fact, None)}) if fact else finding


def _stated(reading: Reading, fields: Iterable[str]) -> Iterator[Fact]:
    known = {fact.field: fact for fact in reading.facts}
    yield from (known[name] for name in fields if name in known and known[name].status == "stated")


def _told(reading: Reading, fact: Fact, value: Value) -> Told:
    start, end = fact.start or 0, fact.end or 0
    sentence = next((reading.text_of(s) for s in reading.sentences if (s.start, s.end) == (start, end)), "")
    return Told(
        field=fact.field, value=fact.value if value is None else value, by=_BY.get(fact.basis, "rules"),
        confidence=fact.confidence, start=start, end=end, sentence=sentence,
    )  # fmt: skip


def about(reading: Reading, prefix: str) -> tuple[str, ...]:
    """Names of all facts of one actor, road or contact."""
    return tuple(fact.field for fact in reading.facts if fact.field.startswith(f"{prefix}."))
