"""Findings: faults that a model or a person can act on, and the restrictions of the next answer that follow from them.

Knows no case, no file and no validator.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from sgcad_core.record_base import Record, Value


class Hold(Record):
    """What the items of a list in the next answer may say: a finding exact enough to narrow the answer's schema.

    Of the list `items`, those with one of `values` at `key` (all, if `key` is empty; only that in place `at`, from 0,
    if one is given) take one of the alternatives in `either`: field -> allowed values.
    """

    items: str
    key: str = ""
    values: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    """What `key` may say in items that are not meant; needed where the schema does not list its values."""
    either: tuple[Mapping[str, tuple[str | int, ...]], ...] = ()
    at: int | None = Field(None, ge=0)
    at_least: int = 0
    at_most: int | None = None

    def line(self) -> str:
        """One line for prompts and logs."""
        meant = self.items if self.at is None else f"{self.items}[{self.at}]"
        parts = [f"at least {self.at_least} {self.items}"] if self.at_least else []
        parts += [f"at most {self.at_most} {self.items}"] if self.at_most is not None else []
        told = [", ".join(f"{k} {'/'.join(map(str, v))}" for k, v in choice.items()) for choice in self.either]
        where = f" with {self.key} {'/'.join(self.values)}" if self.key else ""
        parts += [f"{meant}{where}: {' or '.join(told)}"] if told else []
        return "; ".join(parts)


Severity = Literal["repair", "refuse", "question", "doubt", "note"]
HARD: tuple[Severity, ...] = ("repair", "refuse")
"""Faults with which nothing is written: files that do not load, a told contact that does not happen, the impossible."""
SOFT: tuple[Severity, ...] = ("question", "doubt")
"""What is asked about and then let pass."""


class Told(Record):
    """The stated fact that a question rests on, and its sentence as it was read.

    [start, end): the sentence's characters in the narrative as it was written. `by`: who read it ("rules", "model",
    "person").
    """

    field: str
    value: Value
    by: str
    confidence: float
    start: int
    end: int
    sentence: str = ""


class Finding(Record):
    """What is wrong, written so that a model (or a person) can act on it.

    severity repair: asked again until it is mended; refuse: ends the stage as refused; question: what the report may
    tell otherwise, asked once and then let pass; doubt: what is odd, asked once and then let pass; note: kept, nothing
    happens.
    """

    source: str
    severity: Severity = "repair"
    what: str
    where: str = ""
    value: str = ""
    remedy: str = ""
    holds: tuple[Hold, ...] = ()
    """The remedy as the next answer's schema can be held to it, where it is that exact."""
    told: Told | None = None
    """Of a question, the fact that the artifact differs from."""

    @property
    def subject(self) -> tuple[str, str, str]:
        """What it is about: an answer that differs in nothing else is about the same."""
        return self.source, self.where, self.told.field if self.told else self.what

    def line(self) -> str:
        """One line for prompts and logs."""
        parts = [f"[{self.source}] {self.what}"]
        parts += [f"at {self.where}"] if self.where else []
        parts += [f"(found {self.value})"] if self.value else []
        parts += [f"-> {self.remedy}"] if self.remedy else []
        return " ".join(parts)


@dataclass(frozen=True)
class FindingFactory:
    """Makes one source's findings: `_finding = Finder("topology")`, then `_finding(what, where, value, remedy)`."""

    source: str
    where: str = ""
    """The place that is named where a finding names none."""
    remedy: str = ""

    def __call__(
        self,
        what: str,
        where: str = "",
        value: object = "",
        remedy: str = "",
        severity: Severity = "repair",
        holds: tuple[Hold, ...] = (),
        told: Told | None = None,
    ) -> Finding:
        """A finding of this source."""
        return Finding(
            source=self.source, severity=severity, what=what,
            where=where or self.where, value=str(value), remedy=remedy or self.remedy, holds=holds, told=told,
        )  # fmt: skip
