"""Keys and values of earlier prompts, so that a shared beginning is computed once.

Attention looks back only, so the first n positions of a prompt serve every prompt that begins with the same
n tokens and pictures: the row without context, the next attempt, the next report behind the same passages.
Knows token ids and digests; no model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plugins.backbone.engine.cache import Saved

Key = NDArray[np.int64]
SHORTEST = 8
"""Shorter beginnings are not worth a copy."""


@dataclass(frozen=True, eq=False)
class _Entry:
    salt: tuple[str, ...]
    key: Key
    saved: Saved
    size: int


class PrefixStore:
    """The most recently used prompts, up to `limit` bytes of keys and values (0 keeps none)."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.entries: list[_Entry] = []

    def longest(self, salt: tuple[str, ...], key: Key) -> tuple[Saved, int] | None:
        """The entry that shares the longest beginning, and its length; None if none is worth it."""
        found = max(
            ((common(entry.key, key), i) for i, entry in enumerate(self.entries) if entry.salt == salt),
            default=(0, -1),
        )
        if found[0] < SHORTEST:
            return None
        entry = self.entries.pop(found[1])
        self.entries.append(entry)
        return entry.saved, found[0]

    def known(self, salt: tuple[str, ...], key: Key) -> bool:
        """True if the whole of it is kept already."""
        return any(e.salt == salt and common(e.key, key) == len(key) for e in self.entries)

    def add(self, salt: tuple[str, ...], key: Key, saved: Saved) -> None:
        """Keep a prompt; forgets its own beginnings first, then what was not used for longest."""
        size = sum(part.element_size() * part.numel() for layer in saved if layer for part in layer)
        self.entries = [e for e in self.entries if e.salt != salt or common(e.key, key) < len(e.key)]
        self.entries.append(_Entry(salt, key, saved, size))
        while self.entries and sum(e.size for e in self.entries) > self.limit:
            self.entries.pop(0)

    def clear(self) -> None:
        """Forget everything, where memory ran out."""
        self.entries = []


def prompt_key(ids: Sequence[int], spans: Sequence[tuple[int, int]], digests: Sequence[str]) -> Key:
    """A prompt as numbers: token ids, and in a picture's span numbers made of its digest and the place in it."""
    key = np.asarray(ids, dtype=np.int64)
    for (start, end), digest in zip(spans, digests, strict=True):
        base = int(digest[:12], 16)
        key[start:end] = -1 - base - np.arange(end - start)
    return key


def common(left: Key, right: Key) -> int:
    """Length of the shared beginning."""
    length = min(len(left), len(right))
    differ = np.flatnonzero(left[:length] != right[:length])
    return int(differ[0]) if len(differ) else length
