"""OpenStreetMap extracts as files: .osm, .osm.gz and .osm.bz2 as they are, .osm.pbf through osmium.

Only ways for cars are roads. Nothing is downloaded. Data (c) OpenStreetMap contributors, ODbL: what is made from it
stays with the user.
"""

from __future__ import annotations

import bz2
import gzip
import importlib
import shutil
from pathlib import Path
from typing import IO, Any

from sgcad_core.errors import ConfigError, MissingTool

ENDINGS = (".osm", ".osm.gz", ".osm.bz2", ".osm.pbf")
ROADS = {
    "motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential", "living_street", "service",
    "motorway_link", "trunk_link", "primary_link", "secondary_link", "tertiary_link",
}  # fmt: skip
"""Values of the tag `highway` on which cars drive."""


def as_xml(extract: Path, folder: Path) -> Path:
    """The extract in a form that netconvert reads, unpacked into `folder` at need. Raises ConfigError, MissingTool."""
    if extract.name.endswith(".osm.pbf"):
        return from_pbf(extract, folder / "roads.osm")
    if extract.name.endswith(".osm.bz2"):
        target = folder / "roads.osm"
        try:
            with bz2.open(extract) as packed, target.open("wb") as file:
                shutil.copyfileobj(packed, file, 1 << 20)
        except (OSError, EOFError) as fault:
            raise damaged(extract, fault) from fault
        return target
    return extract.resolve()


def from_pbf(extract: Path, target: Path) -> Path:
    """The roads of a .pbf and the nodes they need, as XML, in a stream. Raises ConfigError, MissingTool."""
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


def opened(extract: Path) -> IO[bytes]:
    """The bytes of an XML extract, unpacked while they are read. Raises ConfigError where it cannot be opened."""
    open_: Any = {".gz": gzip.open, ".bz2": bz2.open}.get(extract.suffix, open)
    try:
        file: IO[bytes] = open_(extract, "rb")
    except OSError as fault:
        raise ConfigError(f"{extract}: cannot be opened ({fault.strerror}); name a file that can be read") from fault
    return file


def damaged(extract: Path, fault: Exception) -> ConfigError:
    """The error of an extract whose bytes cannot be unpacked."""
    return ConfigError(f"{extract}: damaged ({fault}); fetch the extract again")
