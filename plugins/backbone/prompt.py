"""The parts of a prompt in their fixed order: task, passages | evidence | repair.

The order serves prefix reuse: what many calls share stands first, what changes stands last. Knows no
tokenizer, no chat format and no model.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

from sgcad_core.case.records import Context, Diagram, Query


@dataclass(frozen=True)
class Parts:
    """Texts are stripped; an empty one is left out of the prompt."""

    task: str
    passages: tuple[str, ...]
    narrative: str
    diagrams: tuple[Diagram, ...]
    repair: str
    previous: str = ""
    """The answer that `repair` is about, if it is known and stands in there."""

    @property
    def shared(self) -> str:
        """What every attempt and both rows begin with."""
        return "\n\n".join(text for text in (self.task, *self.passages) if text)


def parts(context: Context | None, query: Query) -> Parts:
    """Split a call into its parts; `context` None is the context-free row: no narrative, no diagram."""
    return Parts(
        task=query.task.strip(),
        passages=tuple(f"[{p.kind} {p.id}] {p.text.strip()}" for p in query.passages),
        narrative=context.narrative.strip() if context else "",
        diagrams=context.diagrams if context else (),
        repair=query.repair.strip(),
    )


def with_previous(known: Parts, answer: str) -> Parts:
    """The same parts, knowing the answer before: as a turn of its own, its tokens need not be read again."""
    return replace(known, previous=answer) if answer and answer in known.repair else known


def subject(context: Context, query: Query) -> str:
    """A digest of all that the attempts of one stage share: whose earlier answer a repair starts from."""
    found = hashlib.sha256()
    known = parts(context, query)
    for text in (known.shared, known.narrative):
        found.update(text.encode() + b"\0")
    for diagram in known.diagrams:
        found.update(hashlib.sha256(diagram.png).digest())
    return found.hexdigest()
