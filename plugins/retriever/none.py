"""No retrieval: the model sees the task and the evidence, nothing else. Knows no knowledge base."""

from __future__ import annotations

from sgcad_core.case.records import Passage
from sgcad_core.interfaces import Retriever


class NoRetrieval(Retriever):
    """Retrieves nothing: the model sees only the task and the evidence."""

    def retrieve(self, text: str, task: str) -> tuple[Passage, ...]:
        """Always empty."""
        return ()
