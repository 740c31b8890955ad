"""The records of an account, written into result.json as they are."""

from __future__ import annotations

from typing import Any, Literal

from sgcad_core.record_base import Record
from sgcad_core.records.facts import Value

Kind = Literal["has", "lacks", "assumed", "unread", "contradicts", "guessed"]
Verdict = Literal["whole", "lacking", "unread", "contradicts", "guessed", "disputed", "none"]
"""The first of these that holds. `lacking`: a stated item is not in the scenario; `unread`: a sentence tells something
of which nothing was read; `contradicts`: the report says two things of one field, or the map of its place has another;
`guessed`: what the crash turns on is told nowhere; `disputed`: another reader reads the report otherwise than the one
whose answer stands; `whole`: none of these, right as far as told; `none`: there is no scenario to compare with."""


def is_of_map(field: str) -> bool:
    """Whether an item is a told fact held against a map (`Item.field`), not against the scenario."""
    return field.startswith("place.on_map.")


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


class Disagreement(Record):
    """One field that two readers read differently: `kept` stands in the scenario, `other` is what a sentence may tell.

    `kept_by`, `by`: "model", "rules" or "person"; [start, end): the sentence, None where there is none. `text`: the
    difference in words.
    """

    field: str
    subject: str
    kept: Value
    kept_by: str
    kept_confidence: float
    other: Value
    by: str
    confidence: float
    start: int | None = None
    end: int | None = None
    text: str = ""

    def line(self) -> str:
        """One line for a console."""
        return f"{self.field}: {self.kept} ({self.kept_by}), but {self.by} read {self.other}"


class Account(Record):
    """All items of a case, in the order: lacking, unread, contradicting, guessed, has, assumed; and what readers
    disagree about. `sentence`: the verdict in one sentence, the same wherever it is shown."""

    verdict: Verdict
    sentence: str = ""
    items: tuple[Item, ...] = ()
    disagreements: tuple[Disagreement, ...] = ()

    def of(self, kind: Kind) -> tuple[Item, ...]:
        """The items of one kind."""
        return tuple(item for item in self.items if item.kind == kind)

    def summary(self) -> dict[str, Any]:
        """The account as result.json has it: verdict, counts, items."""
        has, lacks = len(self.of("has")), len(self.of("lacks"))
        counts = {"told": has + lacks, "has": has, "lacking": lacks, "assumed": len(self.of("assumed"))}
        counts |= {"unread": len(self.of("unread")), "contradicts": len(self.of("contradicts"))}
        said = {"verdict": self.verdict, "sentence": self.sentence}
        return {**said, **counts, "items": [item.model_dump(mode="json") for item in self.items]}
