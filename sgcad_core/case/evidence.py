"""The evidence of one crash, as a reader gives it: narrative, diagrams, and what the rules read of the narrative.

Knows no network and no scenario. The narrative is read at most once a case: `CrashReport.reading`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from pydantic import Field

from sgcad_core.record_base import Record
from sgcad_core.records.edits import Edit
from sgcad_core.records.second_reader import Opinion

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading


class Diagram(Record):
    """A crash diagram, always re-encoded as RGB PNG by the reader, so that later stages trust it."""

    png: bytes = Field(repr=False)
    width_px: int
    height_px: int


class NarrativeRecord(Record):
    """A record whose narrative is read once (`reading`, a cached property); only fields are pickled and compared."""

    narrative: str

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy, without the reading where fields change."""
        copied = super().model_copy(update=update, deep=deep)
        if update:
            copied.__dict__.pop("reading", None)
        return copied

    def __getstate__(self) -> dict[Any, Any]:
        state = super().__getstate__()
        return state | {"__dict__": {k: v for k, v in state["__dict__"].items() if k != "reading"}}


class CrashReport(NarrativeRecord):
    """What is known of one crash. `coded` is None unless the config sets use_coded_fields."""

    case: str
    narrative: str
    diagrams: tuple[Diagram, ...] = ()
    coded: Mapping[str, Any] | None = None
    notes: tuple[str, ...] = ()
    """Changes and omissions of the reader, for result.json and the log."""
    edits: tuple[Edit, ...] = ()
    """Facts given by persons; they replace those of the reading (`sgcad_core.revision`)."""
    places: tuple[tuple[int, int, int], ...] = Field((), repr=False)
    """Where the narrative stands in the text as it was written (`sgcad_core.reading.text.traced_text.runs`); (): as it
    is."""

    opinion: Opinion | None = None
    """The second opinion, where a config asks for one."""

    @cached_property
    def reading(self) -> Reading:
        """What is read of the narrative, with places in the text as it was written: by the rules and, where there is a
        second opinion, as both together have it; and all that as people have it."""
        from sgcad_core.reading.reading import read
        from sgcad_core.reading.reading_with_edits import (  # patterns of half a second, which not everybody needs
            with_edits,
        )
        from sgcad_core.reading.second_reader.fuse_gist import fused_with_gist
        from sgcad_core.reading.second_reader.fuse_whole import fused_with_answer
        from sgcad_core.reading.second_reader.numbered.fuse_numbered import fused_with_guesses
        from sgcad_core.reading.second_reader.numbered.unsure_answers import unsure_answers
        from sgcad_core.reading.text.traced_text import placed

        found = rules = read(placed(self.narrative, self.places))
        if self.opinion and self.opinion.taken:
            found = fused_with_guesses(found, self.opinion.guesses)
            found = (
                fused_with_answer(found, self.opinion)
                if self.opinion.answered
                else fused_with_gist(found, self.opinion)
            )
        found = with_edits(found, self.edits)
        return replace(found, unsure=unsure_answers(rules, found, self.opinion.guesses)) if self.opinion else found


class Context(NarrativeRecord):
    """CAD's c: the crash evidence, which the context-free row does not see."""

    narrative: str
    diagrams: tuple[Diagram, ...] = ()

    @staticmethod
    def of(report: CrashReport) -> Context:
        """A report's evidence; its reading is the report's own."""
        context = Context(narrative=report.narrative, diagrams=report.diagrams)
        context.__dict__["reading"] = report.reading  # where cached_property keeps it
        return context

    @cached_property
    def reading(self) -> Reading:
        """The rules' reading of the narrative."""
        from sgcad_core.reading.reading import read

        return read(self.narrative)
