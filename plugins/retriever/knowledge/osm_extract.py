"""OpenStreetMap extracts to SUMO plain XML: .osm, .osm.gz and .osm.bz2 as they are, .osm.pbf through osmium.

Only roads for cars are kept. Everything runs in a folder that is removed afterwards; nothing is downloaded.
Knows no chunk. Data (c) OpenStreetMap contributors, ODbL: what is made from it stays with the user.
"""

from __future__ import annotations

import bz2
import importlib
import shutil
from pathlib import Path
from typing import Any

from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.formats.sumo.netconvert import plain_files

ENDINGS = (".osm", ".osm.gz", ".osm.bz2", ".osm.pbf")
TIMEOUT_S = 3600.0
ROADS = {
    "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential", "living_street", "service",
    "motorway_link", "trunk_link", "primary_link", "secondary_link", "tertiary_link",
}  # fmt: skip
FLAGS = (
    "--geometry.remove", "--junctions.join", "--tls.guess-signals", "--tls.join", "--tls.discard-simple",
    "--ramps.guess", "--keep-edges.by-vclass", "passenger", "--remove-edges.isolated", "--no-turnarounds",
    "--output.street-names", "--precision", "2", "-X", "never", "--no-warnings",
)  # fmt: skip


def plain_of(extract: Path, folder: Path) -> tuple[Path, Path, Path]:
    """Node, edge and connection file of an extract, made in `folder`. Raises ConfigError, MissingTool."""
    source = _readable(extract, folder)
    return plain_files(extract, ("--osm-files", str(source), *FLAGS), folder, TIMEOUT_S)


def _readable(extract: Path, folder: Path) -> Path:
    """The extract in a form that netconvert reads."""
    if extract.name.endswith(".osm.pbf"):
        return _from_pbf(extract, folder / "roads.osm")
    if extract.name.endswith(".osm.bz2"):
        target = folder / "roads.osm"
        try:
            with bz2.open(extract) as packed, target.open("wb") as file:
                shutil.copyfileobj(packed, file, 1 << 20)
        except (OSError, EOFError) as fault:
            raise ConfigError(f"{extract}: damaged ({fault}); fetch the extract again") from fault
        return target
    return extract.resolve()


def _from_pbf(extract: Path, target: Path) -> Path:
    """The roads of a .pbf and the nodes they need, as XML, in a stream."""
    try:
        osmium: Any = importlib.import_module("osmium")
    except ImportError as fault:
        raise MissingTool(
            f"{extract}: .osm.pbf needs osmium: `pip install 'sg-cadvlm[osm]'`, or give .osm.bz2"
        ) from fault
    try:
        with osmium.BackReferenceWriter(str(target), str(extract), overwrite=True, remove_tags=False) as writer:
            ways = osmium.FileProcessor(str(extract), osmium.osm.WAY).with_filter(osmium.filter.KeyFilter("highway"))
            for way in ways:
                if way.tags["highway"] in ROADS:
                    writer.add_way(way)
    except RuntimeError as fault:
        raise ConfigError(f"{extract}: damaged or no .pbf ({fault}); fetch the extract again") from fault
    return target
