"""OpenStreetMap extracts to SUMO plain XML, by netconvert.

Only roads for cars are kept. Everything runs in a folder that is removed afterwards; nothing is downloaded.
Knows no chunk.
"""

from __future__ import annotations

from pathlib import Path

from sgcad_core.formats.osm.extract import as_xml
from sgcad_core.formats.sumo.netconvert import plain_files

TIMEOUT_S = 3600.0
FLAGS = (
    "--geometry.remove", "--junctions.join", "--tls.guess-signals", "--tls.join", "--tls.discard-simple",
    "--ramps.guess", "--keep-edges.by-vclass", "passenger", "--remove-edges.isolated", "--no-turnarounds",
    "--output.street-names", "--precision", "2", "-X", "never", "--no-warnings",
)  # fmt: skip


def plain_of(extract: Path, folder: Path) -> tuple[Path, Path, Path]:
    """Node, edge and connection file of an extract, made in `folder`. Raises ConfigError, MissingTool."""
    source = as_xml(extract, folder)
    return plain_files(extract, ("--osm-files", str(source), *FLAGS), folder, TIMEOUT_S)
