"""Values that a writer computes once per case and uses in every attempt. Knows no plugin."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import Generic, TypeVar

from sgcad_core.case.records import Context

T = TypeVar("T")
KEPT = 256
"""More than the cases that one process works on at a time."""


class CaseCache(Generic[T]):
    """Keeps values by the evidence that they were made from; a first attempt always makes a new one. Thread-safe."""

    def __init__(self) -> None:
        self._known: OrderedDict[str, T] = OrderedDict()
        self._guard = threading.Lock()

    def of(self, context: Context, attempt: int, make: Callable[[], T]) -> T:
        """The value of that evidence, made where there is none; what `make` raises is not remembered."""
        key = _key(context)
        with self._guard:
            if attempt > 1 and key in self._known:
                return self._known[key]
            self._known.pop(key, None)
        made = make()
        with self._guard:
            self._known[key] = made
            while len(self._known) > KEPT:
                self._known.popitem(last=False)
        return made


def _key(context: Context) -> str:
    seen = hashlib.sha256(context.narrative.encode("utf-8", "replace"))
    for diagram in context.diagrams:
        seen.update(hashlib.sha256(diagram.png).digest())
    return seen.hexdigest()
