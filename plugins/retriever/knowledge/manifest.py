"""index.json: what an index holds, and which version of its table is complete.

Knows no database, so that a config can be checked without importing one.
"""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from sgcad_core.case.records import Record
from sgcad_core.errors import ConfigError

MANIFEST = "index.json"
FORMAT = 1


class Manifest(Record):
    """The content of index.json."""

    format: int = FORMAT
    number: int
    """Counts builds and additions, from 1."""
    tag: str
    """Name of the table's version, such as "kb-v2"."""
    content: str
    """Fingerprint of all chunks: equal knowledge, equal fingerprint, however it was put together."""
    table_version: int
    embedder: str
    """Empty: full text alone."""
    dimension: int
    chunks: int
    kinds: dict[str, int]
    sources: dict[str, int]
    written: str

    @property
    def stamp(self) -> str:
        """Version and fingerprint, as a run logs them."""
        return f"{self.tag}-{self.content}"


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a folder. Raises ConfigError, with the command to build the index, if it is not complete."""
    file = folder / MANIFEST
    try:
        manifest = Manifest.model_validate_json(file.read_bytes())
    except OSError as fault:
        raise ConfigError(
            f"no knowledge base in {folder}: build it with `sgcad index build --out {folder}`, "
            "or use `retriever: {name: none}`"
        ) from fault
    except ValidationError as fault:
        raise ConfigError(f"{file}: unreadable; build the index anew: `sgcad index build --out {folder}`") from fault
    if manifest.format != FORMAT:
        raise ConfigError(f"{file}: format {manifest.format}, this version reads {FORMAT}; build the index anew")
    return manifest
