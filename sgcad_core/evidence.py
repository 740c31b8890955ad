"""The evidence of one crash, as a reader gives it: narrative, diagrams, and what the rules read of the narrative.

Knows no network and no scenario. The narrative is read at most once a case: `CrashReport.reading`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

from pydantic import Field

from sgcad_core.frozen import Record

if TYPE_CHECKING:
    from sgcad_core.narrative.reading import Reading


class Diagram(Record):
    """A crash diagram, always re-encoded as RGB PNG by the reader, so that later stages trust it."""

    png: bytes = Field(repr=False)
    width_px: int
    height_px: int


class ReadOnce(Record):
    """A narrative that is read at most once (`reading`, a cached property). Fields alone are pickled and compared."""

    narrative: str

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy; of another narrative nothing has been read yet."""
        copied = super().model_copy(update=update, deep=deep)
        if update:
            copied.__dict__.pop("reading", None)
        return copied

    def __getstate__(self) -> dict[Any, Any]:
        state = super().__getstate__()
        return state | {"__dict__": {k: v for k, v in state["__dict__"].items() if k != "reading"}}


class CrashReport(ReadOnce):
    """What is known of one crash. `coded` is None unless the config sets use_coded_fields."""

    case: str
    narrative: str
    diagrams: tuple[Diagram, ...] = ()
    coded: Mapping[str, Any] | None = None
    notes: tuple[str, ...] = ()
    """What the reader changed or left out, for result.json and the log."""
    places: tuple[tuple[int, int, int], ...] = Field((), repr=False)
    """Where the narrative stands in the text as it was written (`sgcad_core.narrative.traced.runs`); (): as it is."""

    @cached_property
    def reading(self) -> Reading:
        """What the rules read of the narrative, with places in the text as it was written."""
        from sgcad_core.narrative.reading import read  # patterns of half a second, which not everybody needs
        from sgcad_core.narrative.traced import placed

        return read(placed(self.narrative, self.places))


class Context(ReadOnce):
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
        """What the rules read of the narrative."""
        from sgcad_core.narrative.reading import read

        return read(self.narrative)
