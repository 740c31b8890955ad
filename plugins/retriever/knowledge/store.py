"""The index on disk: one LanceDB table and `index.json`, which names its content and its complete version.

Readers open the version that index.json names. That file is written last, by rename, so an interrupted build or
addition is never read. Knows no source of chunks and no plugin.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from filelock import FileLock

from plugins.retriever.knowledge.chunk import Chunk
from plugins.retriever.knowledge.embedders import Embedder
from plugins.retriever.knowledge.manifest import MANIFEST, Manifest, read_manifest
from sgcad_core.errors import ConfigError
from sgcad_core.system.temp_folders import folder_beside

TABLE = "chunks"
BATCH = 256
"""Chunks held in memory at a time; the vectors of 256 chunks take 0.4 MB."""
VECTOR_INDEX_FROM = 20_000
"""Below this many rows an exact scan is as fast as an index."""
Progress = Callable[[int], None]
"""Called after every batch with the number of chunks processed since the last call."""


def build(folder: Path, chunks: Iterable[Chunk], embedder: Embedder | None, progress: Progress) -> Manifest:
    """Writes a new index beside `folder`, then replaces the folder. Raises ConfigError."""
    import lancedb

    _check_place(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    try:
        with folder_beside(folder) as partial:
            dimension = _dimension(embedder)
            table = lancedb.connect(partial).create_table(TABLE, schema=_schema(dimension))
            _write(table, chunks, embedder, progress)
            manifest = _seal(partial, table, embedder.name if embedder else "", dimension, 1)
            partial.chmod(0o755)
            _replace(partial, folder)
    except OSError as fault:
        raise ConfigError(f"--out {folder}: cannot be written ({fault}); make room or choose another folder") from fault
    return manifest


def add(folder: Path, chunks: Iterable[Chunk], embedder: Embedder | None, progress: Progress) -> Manifest:
    """Adds new and changed chunks; without any, the index stays byte for byte. Raises ConfigError."""
    import lancedb

    with _locked(folder):
        before = read_manifest(folder)
        check_embedder(before, embedder.name if embedder else "")
        table = lancedb.connect(folder).open_table(TABLE)
        if table.version != before.table_version:
            table.restore(before.table_version)  # what a killed addition left behind
        if not _write(table, chunks, embedder, progress):
            return before
        table.optimize()
        return _seal(folder, table, before.embedder, before.dimension, before.number + 1)


def check_embedder(manifest: Manifest, name: str) -> None:
    """Raises ConfigError if the index was built with another embedder: the vectors would not be comparable."""
    if manifest.embedder != name:
        raise ConfigError(
            f"the index was built with embedder {manifest.embedder or 'none'!r}, not {name or 'none'!r}; "
            f"name the same one, or build it anew: `sgcad index build --embedder {name.split('/')[0] or 'none'}`"
        )


# ------------------------------------------------------------------ rows
def _schema(dimension: int) -> Any:
    import pyarrow as pa

    names = ("id", "kind", "title", "text", "keywords", "source", "data", "digest", "words")
    texts = [pa.field(name, pa.string()) for name in names]
    vector = [pa.field("vector", pa.list_(pa.float32(), dimension))] if dimension else []
    return pa.schema([*texts, pa.field("tasks", pa.list_(pa.string())), *vector])


def _dimension(embedder: Embedder | None) -> int:
    return int(embedder.embed(["dimension"]).shape[1]) if embedder else 0


def _write(table: Any, chunks: Iterable[Chunk], embedder: Embedder | None, progress: Progress) -> int:
    """Appends new chunks and replaces changed ones, batch by batch; returns how many."""
    known = _known(table)
    written = 0
    for batch in _batches(chunks):
        news = {c.id: c for c in batch if known.get(c.id) != c.digest}
        stale = [i for i in news if i in known]
        if stale:
            table.delete(f"id IN ({', '.join(_quoted(i) for i in stale)})")
        if news:
            table.add(_rows(list(news.values()), embedder, table.schema))
            known |= {c.id: c.digest for c in news.values()}
            written += len(news)
        progress(len(batch))
    return written


def _known(table: Any) -> dict[str, str]:
    """Digests of the stored chunks by id; 100 bytes for each chunk."""
    found = table.search().select(["id", "digest"]).limit(None).to_arrow()
    return dict(zip(found["id"].to_pylist(), found["digest"].to_pylist(), strict=True))


def _batches(chunks: Iterable[Chunk]) -> Iterator[list[Chunk]]:
    rest = iter(chunks)
    while batch := list(islice(rest, BATCH)):
        yield batch


def _rows(chunks: Sequence[Chunk], embedder: Embedder | None, schema: Any) -> Any:
    import pyarrow as pa

    columns: dict[str, Any] = {name: [getattr(c, name) for c in chunks] for name in schema.names if name != "vector"}
    if embedder:
        vectors = embedder.embed([c.gist for c in chunks])
        columns["vector"] = pa.FixedSizeListArray.from_arrays(np.ascontiguousarray(vectors).ravel(), vectors.shape[1])
    return pa.table({name: columns[name] for name in schema.names}, schema=schema)


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


# ------------------------------------------------------------------ making it whole
def _seal(folder: Path, table: Any, embedder: str, dimension: int, number: int) -> Manifest:
    """Index the table, tag its version, and name that version in index.json."""
    from lancedb.index import FTS, IvfFlat

    table.create_index("words", config=FTS(with_position=False), replace=True)
    if dimension and table.count_rows() >= VECTOR_INDEX_FROM:
        table.create_index("vector", config=IvfFlat(distance_type="cosine"), replace=True)
    manifest = _count(table, embedder, dimension, number)
    _tag(table, manifest)
    _write_json(folder / MANIFEST, manifest.model_dump())
    return manifest


def _tag(table: Any, manifest: Manifest) -> None:
    """Mark the version so that it is never cleaned up; a killed addition may have used the tag."""
    if manifest.tag in table.tags.list():
        table.tags.update(manifest.tag, manifest.table_version)
    else:
        table.tags.create(manifest.tag, manifest.table_version)


def _count(table: Any, embedder: str, dimension: int, number: int) -> Manifest:
    found = table.search().select(["id", "digest", "kind", "source"]).limit(None).to_arrow()
    pairs = sorted(zip(found["id"].to_pylist(), found["digest"].to_pylist(), strict=True))
    content = hashlib.sha256("\n".join(" ".join(p) for p in pairs).encode()).hexdigest()[:12]
    return Manifest(
        number=number,
        tag=f"kb-v{number}",
        content=content,
        table_version=table.version,
        embedder=embedder,
        dimension=dimension,
        chunks=len(pairs),
        kinds=dict(sorted(Counter(found["kind"].to_pylist()).items())),
        sources=dict(sorted(Counter(found["source"].to_pylist()).items())),
        written=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def _write_json(file: Path, value: dict[str, Any]) -> None:
    beside = file.with_suffix(".partial")
    beside.write_text(json.dumps(value, indent=2) + "\n", encoding="utf-8")
    beside.replace(file)


def _check_place(folder: Path) -> None:
    """Raises ConfigError if the folder holds something other than an index."""
    if folder.exists() and not (folder / MANIFEST).is_file() and (not folder.is_dir() or any(folder.iterdir())):
        raise ConfigError(f"--out {folder}: holds something that is no index; choose another folder")


def _replace(partial: Path, folder: Path) -> None:
    if not folder.exists():
        partial.rename(folder)
        return
    with folder_beside(folder) as old:
        folder.rename(old / "old")
        partial.rename(folder)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """One addition at a time. Raises ConfigError where the folder holds no index."""
    read_manifest(folder)
    with FileLock(folder / ".lock"):
        yield
