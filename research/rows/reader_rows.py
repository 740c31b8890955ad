"""Coded reports as rows for the learned reader: features, the rules' values, the values that the codes allow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from research.rows.coded_incidents import Incident, by_hash
from research.rows.coded_rows import allowed
from sgcad_core.reading.second_reader.learned_reader_features import account_of, readings, words
from sgcad_core.reading.second_reader.seven_question_gist import shown_alike
from sgcad_core.records.second_reader import Value

FIELDS = ("subject", "subject_area", "other_area")
"""What is learned. Of "other" a reader spoiled nearly as much as it mended, out of fold (+11 -8); of the rest the rules
are right in 97 of 100 reports, or codes do not judge it."""


class Row(NamedTuple):
    """A report: its features, what the rules say, the values that its codes allow."""

    id: str
    words: frozenset[str]
    readings: frozenset[str]
    values: Mapping[str, Value]
    told: frozenset[str]
    allowed: Mapping[str, tuple[Value, ...]]

    def right(self, key: str, value: Value) -> bool:
        """Whether a value shows what the codes say."""
        return any(shown_alike(value, one) for one in self.allowed[key])

    @property
    def fold(self) -> int:
        """A number that follows from the id."""
        return by_hash(f"f{self.id}")


def row(incident: Incident) -> Row | None:
    """A report as a row; None of one that cannot be drawn."""
    account = account_of(incident.text)
    if account.reading.crash.gap or not account.reading.crash.unnumbered:
        return None
    say, codes = account.say, allowed(incident.truth)
    seen = frozenset(words(account)), frozenset(readings(account))
    return Row(incident.id, *seen, say.values, say.told, {key: codes[key] for key in FIELDS if key in codes})


def target(one: Row, key: str) -> tuple[Value, ...]:
    """Values that are to be said: the rules' own where the text tells it outright and codes allow it, else all."""
    rule = one.values.get(key)
    return (rule,) if rule is not None and key in one.told and rule in one.allowed[key] else one.allowed[key]
