"""Scenario files on disk: with their catalogs and their map, and the variations of distribution files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sgcad_core.formats.openscenario.playing.player import DT_S, Played, play_scenario
from sgcad_core.formats.openscenario.playing.timed_motion import MAX_S
from sgcad_core.formats.openscenario.reading.catalogs import CatalogFolders, located, read_text
from sgcad_core.formats.openscenario.reading.elements import FileContext, XmlNode, read_root
from sgcad_core.formats.openscenario.reading.variation import Given, parameter_sets, scenario_file
from sgcad_core.formats.openscenario.roads.road_network import roads_of


@dataclass(frozen=True)
class Variation:
    """A scenario file and the parameters to play it with; `name` tells sets of one distribution apart."""

    file: Path
    given: Given
    name: str = ""


def variations(file: Path, given: Mapping[str, str] | None = None) -> list[Variation]:
    """What a file asks to play: itself, or a scenario with every parameter set of a distribution.

    Raises BadInput for what is no such file, InvalidOutput for a distribution that cannot be read.
    """
    root = read_root(read_text(file), book=FileContext(file.name))
    target = scenario_file(root)
    if target is None:
        return [Variation(file, dict(given or {}))]
    scenario = located(file.parent, target)
    sets = parameter_sets(root)
    width = len(str(len(sets)))
    return [Variation(scenario, {**s, **(given or {})}, f"set-{i + 1:0{width}d}") for i, s in enumerate(sets)]


def read_scenario(variation: Variation) -> XmlNode:
    """The root of a scenario with its parameters and its catalogs. Raises BadInput, InvalidOutput."""
    text, folder = read_text(variation.file), variation.file.parent
    book = FileContext(variation.file.name, strict=False)
    root = read_root(text, variation.given, book)
    book.catalogs = CatalogFolders(root, folder)
    return root


def play_file(
    variation: Variation, maps: Sequence[Path] = (), dt_s: float = DT_S, until_s: float = MAX_S
) -> tuple[Played, str | None]:
    """Play a scenario file with its map; also the map's text, if there is one.

    `maps`: folders to look for a map that is not where the file says. A scenario without a map is played as far as it
    needs none. Raises BadInput, InvalidOutput, Unsupported.
    """
    root = read_scenario(variation)
    xodr, missing = _map_of(root, variation.file.parent, maps)
    roads = roads_of(xodr) if xodr is not None else None
    return play_scenario(root, roads, dt_s, until_s, missing), xodr


def _map_of(root: XmlNode, folder: Path, maps: Sequence[Path]) -> tuple[str | None, str]:
    """The map's text, or why there is none."""
    network = root.find("RoadNetwork")
    logic = network.find("LogicFile") if network else None
    named = logic.text("filepath", "") if logic else ""
    if logic is None or not named:
        return None, "needs a road network, and the file names none"
    for file in _places(folder, named, maps):
        if file.is_file() and file.suffix.lower() == ".xodr":
            return read_text(file), ""
    what = f"the map {named!r} is not there"
    logic.note(what, remedy="only world positions are played; give the map's folder with --maps")
    return None, f"needs a road network, but {what}"


def _places(folder: Path, named: str, maps: Sequence[Path]) -> Iterator[Path]:
    """Where a map may lie: where the file says, then by its name in the given folders."""
    yield located(folder, named)
    name = Path(named.replace("\\", "/")).name
    for other in maps:
        yield other / name
        yield other / f"{name}.xodr"
