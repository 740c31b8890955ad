"""What the elements of one file share: its name, its catalogs, what is noted of it, and what it may cost."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from typing import Any, Protocol

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.reading.budget import Budget, TooMuch
from sgcad_core.formats.xml import Element, parse_xml

SOURCE = "openscenario"
MAX_NOTES = 500


class Catalogs(Protocol):
    """Where catalog entries come from."""

    def entry(self, reference: Any) -> Any:
        """The entry (a node) that a <CatalogReference> (a node) names. Raises InvalidOutput."""


class Notes(list[Finding]):
    """What is noted of a scenario, each place once; of very many the first, and that there are more."""

    def __init__(self) -> None:
        super().__init__()
        self._seen: set[tuple[str, str, str]] = set()

    def add(self, note: Finding) -> None:
        """Keep a note that is not there yet."""
        if len(self) > MAX_NOTES or (about := (note.what, note.where, note.value)) in self._seen:
            return
        self._seen.add(about)
        full = len(self) == MAX_NOTES
        self.append(note.model_copy(update={"what": "more notes are left out", "value": ""}) if full else note)


@dataclass(eq=False)
class FileContext:
    """The context of one file; files that belong together share notes and budget."""

    file: str = ""
    catalogs: Catalogs | None = None
    notes: Notes = field(default_factory=Notes)
    strict: bool = True
    """Whether what other players let pass with a warning is a fault (as for files that we write) or a note."""
    depth: int = 0
    """How many catalogs were opened on the way to this one."""
    budget: Budget = field(default_factory=Budget)

    def read(self, text: str, what: str) -> Element:
        """The root element of a text, within the budget. Raises InvalidOutput naming the file, or `what`."""
        try:
            self.budget.admit(text)
        except TooMuch as fault:
            remedy = f"make the file smaller; most of its elements are <{_commonest(text)}>"
            found = Finding(source=SOURCE, what=str(fault), where=self.file or what, remedy=remedy)
            raise InvalidOutput.of(found) from fault
        return parse_xml(text, self.file or what)


def _commonest(text: str) -> str:
    """The name that most elements at the beginning of an XML text have."""
    names = Counter(re.findall(r"<(\w[\w.-]{0,60})", text[:1_000_000])).most_common(1)
    return names[0][0] if names else "?"
