"""The records of an account, written into result.json as they are."""

from __future__ import annotations

from typing import Any, Literal

from sgcad_core.record_base import Record
from sgcad_core.records.facts import Value

Kind = Literal["has", "lacks", "assumed"]
Verdict = Literal["whole", "lacking", "none"]
"""`whole`: no stated item is lacking; `lacking`: at least one is; `none`: there is no scenario to compare with."""


class Item(Record):
    """One stated thing that the scenario has or lacks, or one assumption of the scenario.

    `field`: the fact's name (`sgcad_core.records.facts.Fact.field`) or, of what no fact carries, "text.<what>".
    `subject`: "V1", "roads.main", "junction", "contacts.0" or "". `value`: as stated or as assumed;
    `seen`: what the scenario has instead. [start, end): the sentence in the narrative as it was written; None where
    there is none.
    """

    kind: Kind
    field: str
    subject: str
    value: Value
    seen: Value = None
    text: str
    """The item in a few words, for people."""
    reason: str = ""
    """Why it lacks, or why this was assumed."""
    start: int | None = None
    end: int | None = None

    def line(self) -> str:
        """One line for a console."""
        return f"{self.text}: {self.reason}" if self.reason else self.text


class Account(Record):
    """All items of a case, in the order: lacking, has, assumed."""

    verdict: Verdict
    items: tuple[Item, ...] = ()

    def of(self, kind: Kind) -> tuple[Item, ...]:
        """The items of one kind."""
        return tuple(item for item in self.items if item.kind == kind)

    def summary(self) -> dict[str, Any]:
        """The account as result.json has it: verdict, counts, items."""
        has, lacks = len(self.of("has")), len(self.of("lacks"))
        counts = {"told": has + lacks, "has": has, "lacking": lacks, "assumed": len(self.of("assumed"))}
        return {"verdict": self.verdict, **counts, "items": [item.model_dump(mode="json") for item in self.items]}
