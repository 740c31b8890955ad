"""Scenario files on disk: with their catalogs and their map, and the variations of distribution files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import overload

from sgcad_core.formats.openscenario.playing.player import DT_S, Played, play_scenario
from sgcad_core.formats.openscenario.playing.timed_motion import MAX_S
from sgcad_core.formats.openscenario.reading.catalogs import CatalogFolders, is_there, located, read_text
from sgcad_core.formats.openscenario.reading.elements import XmlNode, read_root
from sgcad_core.formats.openscenario.reading.file_context import FileContext
from sgcad_core.formats.openscenario.reading.variation import Given, ParameterSets, scenario_file
from sgcad_core.formats.openscenario.roads.road_network import roads_of


@dataclass(frozen=True)
class Variation:
    """A scenario file and the parameters to play it with; `name` tells sets of one distribution apart."""

    file: Path
    given: Given
    name: str = ""


class Variations(Sequence[Variation]):
    """What a file asks to play, in order; parameter sets are drawn when they are asked for."""

    def __init__(self, file: Path, given: Given, sets: ParameterSets | None = None) -> None:
        self._file, self._given, self._sets = file, given, sets

    def __len__(self) -> int:
        return 1 if self._sets is None else len(self._sets)

    def __iter__(self) -> Iterator[Variation]:
        if self._sets is None:
            yield Variation(self._file, self._given)
            return
        width = len(str(len(self._sets)))
        for i, drawn in enumerate(self._sets, start=1):
            yield Variation(self._file, {**drawn, **self._given}, f"set-{i:0{width}d}")

    @overload
    def __getitem__(self, index: int) -> Variation: ...
    @overload
    def __getitem__(self, index: slice) -> list[Variation]: ...
    def __getitem__(self, index: int | slice) -> Variation | list[Variation]:
        wanted = range(len(self))[index]
        if isinstance(wanted, int):
            return next(islice(self, wanted, None))
        kept = set(wanted)
        found = {
            i: variation for i, variation in zip(range(max(kept, default=-1) + 1), self, strict=False) if i in kept
        }
        return [found[i] for i in wanted]


def variations(file: Path, given: Mapping[str, str] | None = None) -> Variations:
    """What a file asks to play: itself, or a scenario with every parameter set of a distribution.

    Raises BadInput for what is no such file, InvalidOutput for a distribution that cannot be read.
    """
    root = read_root(read_text(file), book=FileContext(file.name, strict=False))
    target = scenario_file(root)
    if target is None:
        return Variations(file, dict(given or {}))
    return Variations(located(file.parent, target), dict(given or {}), ParameterSets(root))


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
    if roads is not None:
        root.book.budget.join(roads.budget)
    return play_scenario(root, roads, dt_s, until_s, missing), xodr


def _map_of(root: XmlNode, folder: Path, maps: Sequence[Path]) -> tuple[str | None, str]:
    """The map's text, or why there is none."""
    network = root.find("RoadNetwork")
    logic = network.find("LogicFile") if network else None
    named = logic.text("filepath", "") if logic else ""
    if logic is None or not named:
        return None, "needs a road network, and the file names none"
    for file in _places(folder, named, maps):
        if is_there(file) and file.suffix.lower() == ".xodr":
            return read_text(file), ""
    what = f"the map {named[:200]!r} is not there"
    logic.note(what, remedy="only world positions are played; give the map's folder with --maps")
    return None, f"needs a road network, but {what}"


def _places(folder: Path, named: str, maps: Sequence[Path]) -> Iterator[Path]:
    """Where a map may lie: where the file says, then by its name in the given folders."""
    yield located(folder, named)
    name = Path(named.replace("\\", "/")).name
    for other in maps:
        yield other / name
        yield other / f"{name}.xodr"
