"""What a writer works out once a case and needs again at every further attempt. Knows no plugin."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import Generic, TypeVar

from sgcad_core.case.records import Context

T = TypeVar("T")
KEPT = 256
"""Cases under way at a time in one process, with room to spare."""


class OncePerCase(Generic[T]):
    """Remembers a value by the evidence it was made from. A first attempt always makes it anew. Thread-safe."""

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
