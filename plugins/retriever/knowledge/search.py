"""Search: LanceDB's full text and vectors, fused by weighted reciprocal rank, filtered by kind and task.

LanceDB's own RRFReranker has no weights, so the fusion is computed here.

Reads the version that index.json names. Knows no source of chunks and no plugin.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from plugins.retriever.knowledge.chunk import Kind, Task
from plugins.retriever.knowledge.embedders import Embedder
from plugins.retriever.knowledge.manifest import Manifest, read_manifest
from plugins.retriever.knowledge.store import TABLE, check_embedder
from sgcad_core.case.records import Record
from sgcad_core.errors import ConfigError

RANK_CONSTANT = 10
"""Constant of reciprocal rank fusion; Cormack, Clarke and Büttcher (2009) take 60, for longer result lists."""
FULL_TEXT_WEIGHT = 1.5
"""Weight against 1 for vectors: names and numbers decide, and full text finds them more reliably."""
POOL = 30
"""Ranks of each list that are fused."""
MAX_QUERY = 4000
"""Characters of a query that are read: a narrative's first page."""
_COLUMNS = ["id", "kind", "title", "text", "data"]
_WORD = re.compile(r"\w")


class Hit(Record):
    """A found chunk; score is the weighted sum of reciprocal ranks, at most 2.5 / 11."""

    id: str
    kind: str
    title: str
    text: str
    data: str
    score: float


class Index:
    """One version of an index, opened; later additions do not change it. Thread-safe."""

    def __init__(self, folder: Path, embedder: Embedder | None) -> None:
        """Opens the index. Raises ConfigError if it is absent, broken, or has vectors of another embedder."""
        import lancedb

        self.manifest: Manifest = read_manifest(folder)
        if embedder:  # full text alone reads any index
            check_embedder(self.manifest, embedder.name)
        self._embedder = embedder
        try:
            self._table: Any = lancedb.connect(folder).open_table(TABLE)
            self._table.checkout(self.manifest.table_version)
        except (ValueError, RuntimeError, OSError) as fault:
            raise ConfigError(
                f"{folder}: broken ({fault}); build it anew: `sgcad index build --out {folder}`"
            ) from fault

    def search(self, text: str, k: int, kinds: Sequence[Kind] = (), task: Task | None = None) -> list[Hit]:
        """The k best chunks for a text, best first; an empty list for a text without a word."""
        text = text[:MAX_QUERY]
        if not _WORD.search(text):
            return []
        where = _where(kinds, task)
        lists = [self._full_text(text, where, max(POOL, k))]
        if self._embedder:
            lists.append(self._near(self._embedder.embed([text])[0], where, max(POOL, k)))
        rows = {row["id"]: row for found in lists for row in found}
        scores = fuse([[row["id"] for row in found] for found in lists], (FULL_TEXT_WEIGHT, 1.0))
        best = sorted(scores, key=lambda i: (-scores[i], i))[:k]
        return [Hit(**{c: rows[i][c] for c in _COLUMNS}, score=scores[i]) for i in best]

    def _full_text(self, text: str, where: str, k: int) -> list[dict[str, Any]]:
        from lancedb.query import MatchQuery

        query = self._table.search(MatchQuery(text, "words"), query_type="fts").select([*_COLUMNS, "_score"])
        return list((query.where(where, prefilter=True) if where else query).limit(k).to_list())

    def _near(self, vector: Any, where: str, k: int) -> list[dict[str, Any]]:
        query = self._table.search(vector, vector_column_name="vector", query_type="vector")
        query = query.distance_type("cosine").nprobes(24).select([*_COLUMNS, "_distance"])
        return list((query.where(where, prefilter=True) if where else query).limit(k).to_list())


def fuse(lists: Sequence[Sequence[str]], weights: Sequence[float]) -> dict[str, float]:
    """Reciprocal rank fusion: sum over lists of weight / (10 + rank), ranks from 1; extra weights are ignored."""
    scores: dict[str, float] = {}
    for found, weight in zip(lists, weights, strict=False):
        for rank, name in enumerate(found, 1):
            scores[name] = scores.get(name, 0.0) + weight / (RANK_CONSTANT + rank)
    return scores


def _where(kinds: Sequence[Kind], task: Task | None) -> str:
    parts = [f"kind IN ({', '.join(repr(k) for k in kinds)})"] if kinds else []
    parts += [f"array_has(tasks, '{task}')"] if task else []
    return " AND ".join(parts)
