"""The parts of a prompt in their fixed order: task, passages | evidence | repair.

The order serves prefix reuse: the parts that many calls share stand first, those that change stand last. Knows no
tokenizer, no chat format and no model.
"""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from dataclasses import dataclass, field, replace

from sgcad_core.case.records import Context, Diagram, Query

_KEPT_ANSWERS = 256


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
        """The beginning that every attempt and both rows share."""
        return "\n\n".join(text for text in (self.task, *self.passages) if text)


def parts(context: Context | None, query: Query) -> Parts:
    """The parts of a call; `context` None is the row without context: no narrative, no diagram."""
    return Parts(
        task=query.task.strip(),
        passages=tuple(f"[{p.kind} {p.id}] {p.text.strip()}" for p in query.passages),
        narrative=context.narrative.strip() if context else "",
        diagrams=context.diagrams if context else (),
        repair=query.repair.strip(),
    )


def with_previous(known: Parts, answer: str) -> Parts:
    """The same parts with the answer before as a turn of its own, whose tokens need not be computed again."""
    return replace(known, previous=answer) if answer and answer in known.repair else known


def subject(context: Context, query: Query) -> str:
    """A digest of all that the attempts of one stage share, by which a repair finds the earlier answer."""
    found = hashlib.sha256()
    known = parts(context, query)
    for text in (known.shared, known.narrative):
        found.update(text.encode() + b"\0")
    for diagram in known.diagrams:
        found.update(hashlib.sha256(diagram.png).digest())
    return found.hexdigest()


@dataclass
class EarlierAnswers:
    """The last answers by their subject: a repair goes on from its text, and its tokens are the draft of the next."""

    kept: OrderedDict[str, tuple[str, tuple[int, ...]]] = field(default_factory=OrderedDict)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def before(self, about: str, query: Query) -> tuple[str, tuple[int, ...]]:
        """Text and tokens of the attempt before; empty for a first attempt."""
        with self.lock:
            return self.kept.get(about, ("", ())) if query.attempt > 1 or query.repair else ("", ())

    def note(self, about: str, text: str, ids: tuple[int, ...]) -> None:
        """Keeps an answer; forgets the oldest beyond a limit."""
        with self.lock:
            self.kept[about] = text, ids
            if len(self.kept) > _KEPT_ANSWERS:
                self.kept.popitem(last=False)
