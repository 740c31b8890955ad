"""Sources of chunks: the project's own, and files that the user names.

A file is an OpenStreetMap extract (.osm, .osm.gz, .osm.bz2, .osm.pbf) or holds the user's own chunks (.jsonl).
Knows no database.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path

from pydantic import ValidationError

from plugins.retriever.knowledge.chunk import Chunk
from sgcad_core.errors import ConfigError
from sgcad_core.formats.osm.extract import ENDINGS as OSM_ENDINGS

ENDINGS = (*OSM_ENDINGS, ".jsonl")

OnSkip = Callable[[str, str], None]
"""Called with the name of each item that could not be used, and the reason."""


def builtin_chunks() -> Iterator[Chunk]:
    """scenariogeneration's API, snippets, SUMO's XML, worked scenarios; about 550 chunks, 2 s."""
    from plugins.retriever.knowledge.api import api_chunks
    from plugins.retriever.knowledge.examples import example_chunks, snippet_chunks
    from plugins.retriever.knowledge.sumo_schema import xml_chunks

    return chain(example_chunks(), snippet_chunks(), xml_chunks(), api_chunks())


def file_chunks(file: Path, on_skip: OnSkip) -> Iterator[Chunk]:
    """Chunks of one file, one at a time. Raises ConfigError, MissingTool before the first."""
    check_file(file)
    if file.name.endswith(".jsonl"):
        return _jsonl(file)
    from plugins.retriever.knowledge.junction_chunks import junction_chunks

    return junction_chunks(file, on_skip)


def check_file(file: Path) -> None:
    """Raises ConfigError for a file that is absent or of an unknown kind."""
    if not file.is_file():
        raise ConfigError(f"{file}: no such file")
    if not file.name.endswith(ENDINGS):
        raise ConfigError(f"{file}: unknown kind of file; known endings: {', '.join(ENDINGS)}")


def _jsonl(file: Path) -> Iterator[Chunk]:
    with file.open(encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            if line.strip():
                yield _chunk(line, f"{file}, line {number}", file.name)


def _chunk(line: str, where: str, source: str) -> Chunk:
    try:
        chunk = Chunk.model_validate_json(line)
    except ValidationError as fault:
        faults = "; ".join(f"{'.'.join(map(str, e['loc'])) or 'line'}: {e['msg']}" for e in fault.errors())
        raise ConfigError(f"{where}: {faults}; needed: id, kind, tasks, title, text") from fault
    return chunk if chunk.source else chunk.model_copy(update={"source": source})
