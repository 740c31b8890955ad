"""An extract read as streets: nodes, ways for cars, their names. Two passes in a stream, so that only roads are kept.

Knows no junction and no lane. Latitudes and longitudes in degrees.
"""

from __future__ import annotations

import zlib
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import IO, NamedTuple, TypeVar

from lxml import etree

from sgcad_core import settings
from sgcad_core.errors import ConfigError
from sgcad_core.formats.osm.extract import ENDINGS, ROADS, damaged, from_pbf, opened
from sgcad_core.formats.osm.names import StreetName, street_name
from sgcad_core.geometry.globe import Spot
from sgcad_core.system.temp_folders import temp_folder

MOST_MB = 500
"""Of an extract, unpacked: a city of a million people with all its buildings."""
MOST_WAYS = 400_000
REMEMBERED = 4
_NAMES = ("name", "ref", "alt_name", "official_name", "loc_name", "old_name", "short_name", "name_1")
_SETTLEMENTS = ("city", "town", "village", "hamlet", "suburb")
_KEPT_TAGS = ("highway", "stop", "direction", "traffic_signals", "traffic_signals:direction")
Tags = dict[str, str]
_Taken = TypeVar("_Taken")
_Number = TypeVar("_Number", int, float)
_ELEMENTS = ("node", "way", "relation")


class MapWay(NamedTuple):
    """One way; its nodes in order, only those that the extract holds."""

    id: int
    nodes: tuple[int, ...]
    tags: Tags

    @property
    def ring(self) -> bool:
        """Whether it is a piece of a roundabout."""
        return self.tags.get("junction") in ("roundabout", "circular")

    @property
    def link(self) -> bool:
        """Whether it only joins roads: a slip lane or a ramp."""
        return self.tags["highway"].endswith("_link")


@dataclass
class StreetMap:
    """The roads of one extract."""

    source: str
    """Name of the file."""
    places: dict[int, Spot] = field(default_factory=dict)
    tags: dict[int, Tags] = field(default_factory=dict)
    """Of nodes that tell a control."""
    ways: list[MapWay] = field(default_factory=list)
    settlements: list[tuple[str, Spot]] = field(default_factory=list)

    @cached_property
    def at(self) -> dict[int, list[int]]:
        """Node -> indices of the ways through it, each once."""
        found: dict[int, list[int]] = defaultdict(list)
        for index, way in enumerate(self.ways):
            for node in dict.fromkeys(way.nodes):
                found[node].append(index)
        return found

    @cached_property
    def names(self) -> list[tuple[StreetName, ...]]:
        """Of each way, all its names in one spelling."""
        return [tuple(dict.fromkeys(_spelled(way.tags))) for way in self.ways]

    @cached_property
    def _by_core(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = defaultdict(list)
        for index, names in enumerate(self.names):
            for core in {name.core for name in names}:
                found[core].append(index)
        return found

    def named(self, name: StreetName) -> dict[int, int]:
        """Way -> how well one of its names fits (1 to 3); only those that fit best."""
        fits = {i: max(name.likeness(own) for own in self.names[i]) for i in self._by_core.get(name.core, ())}
        best = max(fits.values(), default=0)
        return {i: fit for i, fit in fits.items() if fit == best} if best else {}


def names_of(tags: Tags) -> tuple[str, ...]:
    """All names and numbers of a way, each once."""
    told = (text.strip() for key in _NAMES for text in tags.get(key, "").split(";"))
    return tuple(dict.fromkeys(text for text in told if text))


def _spelled(tags: Tags) -> Iterator[StreetName]:
    return (name for text in names_of(tags) if (name := street_name(text)))


# ------------------------------------------------------------------ files
def maps_in(place: Path) -> tuple[Path, ...]:
    """The extract, or those of a folder; a relative one that is not here may be one of the project's.

    Raises ConfigError where there is none.
    """
    place = place if place.exists() or place.is_absolute() else settings.ROOT / place
    if place.is_dir():
        found = tuple(sorted(f for f in place.iterdir() if f.name.endswith(ENDINGS)))
        if not found:
            raise ConfigError(f"{place}: no extract in this folder; put files there that end in {', '.join(ENDINGS)}")
        return found
    if not place.is_file():
        raise ConfigError(f"{place}: no such file or folder; give an OpenStreetMap extract ({', '.join(ENDINGS)})")
    if not place.name.endswith(ENDINGS):
        raise ConfigError(f"{place}: unknown kind of file; an extract ends in {', '.join(ENDINGS)}")
    return (place,)


def read_street_map(extract: Path) -> StreetMap:
    """The roads of an extract; the last few are kept while their files stay as they are.

    Raises ConfigError where the file is damaged, too large or holds no road; MissingTool for a .pbf without osmium.
    """
    about = extract.stat()
    return _remembered(extract, about.st_mtime_ns, about.st_size)


@lru_cache(maxsize=REMEMBERED)
def _remembered(extract: Path, _changed: int, _size: int) -> StreetMap:
    if extract.name.endswith(".osm.pbf"):
        with temp_folder("osm") as folder:
            return _read(extract, from_pbf(extract, folder / "roads.osm"))
    return _read(extract, extract)


def _read(extract: Path, file: Path) -> StreetMap:
    made = StreetMap(extract.name)
    ways = [(way, refs) for way, refs in _pass(extract, file, "way", _way) if way is not None]
    if len(ways) > MOST_WAYS:
        raise ConfigError(f"{extract}: {len(ways)} roads, at most {MOST_WAYS} are read; cut the extract smaller")
    needed = {ref for _, refs in ways for ref in refs}
    for number, place, tags in _pass(extract, file, "node", _node):
        if number in needed:
            made.places[number] = place
            if kept := {key: tags[key] for key in _KEPT_TAGS if key in tags}:
                made.tags[number] = kept
        if tags.get("place") in _SETTLEMENTS and tags.get("name"):
            made.settlements.append((tags["name"], place))
    for (number, tags), refs in ways:
        nodes = tuple(ref for ref in refs if ref in made.places)
        if len(nodes) > 1:
            made.ways.append(MapWay(number, nodes, tags))
    if not made.ways:
        raise ConfigError(f"{extract}: holds no road for cars; give an extract with ways that have the tag highway")
    return made


def _pass(extract: Path, file: Path, wanted: str, take: Callable[[etree._Element], _Taken]) -> Iterator[_Taken]:
    """What `take` makes of every such element. Raises ConfigError naming the extract, the place and the remedy."""
    with opened(file) as raw:
        counted = _Counted(raw, extract)
        events = etree.iterparse(counted, tag=_ELEMENTS, resolve_entities=False, no_network=True, huge_tree=False)
        try:
            for _, element in events:
                if element.tag == wanted:
                    yield take(element)
                element.clear()
                while element.getprevious() is not None:
                    del element.getparent()[0]
        except etree.XMLSyntaxError as fault:
            what = f"no well-formed OpenStreetMap XML ({fault.msg})"
            raise ConfigError(f"{extract}: {what}; fetch the extract again") from fault
        except (OSError, EOFError, zlib.error) as fault:
            raise damaged(extract, fault) from fault
        except _BadValue as fault:
            raise ConfigError(f"{extract}: {fault}; fetch the extract again") from fault
        if events.root is not None and events.root.tag != "osm":
            raise ConfigError(
                f"{extract}: begins with <{events.root.tag}>, an extract with <osm>; export it as OSM XML"
            )


class _BadValue(ValueError):
    """A value of an element that no extract has."""


class _Counted:
    """A file that refuses to give more than `MOST_MB`."""

    def __init__(self, raw: IO[bytes], extract: Path) -> None:
        self.raw, self.extract, self.left = raw, extract, MOST_MB << 20

    def read(self, size: int = -1) -> bytes:
        """The next bytes. Raises ConfigError beyond the limit."""
        data = self.raw.read(size)
        self.left -= len(data)
        if self.left < 0:
            raise ConfigError(
                f"{self.extract}: more than {MOST_MB} MB of XML; cut out the town, or give roads alone as .osm.pbf"
            )
        return data


def _tags(element: etree._Element) -> Tags:
    return {tag.get("k", ""): tag.get("v", "") for tag in element.iterfind("tag")}


def _way(element: etree._Element) -> tuple[tuple[int, Tags] | None, tuple[int, ...]]:
    """Number and tags of a way for cars, and its nodes; None of another way."""
    tags = _tags(element)
    kind = tags.get("highway", "")
    if kind not in ROADS or (kind == "service" and "name" not in tags) or tags.get("area") == "yes":
        return None, ()
    refs = tuple(_number(nd, "ref", int) for nd in element.iterfind("nd"))
    return (_number(element, "id", int), tags), refs


def _node(element: etree._Element) -> tuple[int, Spot, Tags]:
    place = _number(element, "lat", float), _number(element, "lon", float)
    if not (abs(place[0]) <= 90 and abs(place[1]) <= 180):
        raise _BadValue(f"node {element.get('id')} lies at {place[0]:g}, {place[1]:g}, beyond 90 and 180 degrees")
    return _number(element, "id", int), place, _tags(element)


def _number(element: etree._Element, key: str, kind: Callable[[str], _Number]) -> _Number:
    text = element.get(key, "")
    try:
        return kind(text)
    except ValueError as fault:
        raise _BadValue(f"{element.tag} {element.get('id', '?')} has {key}={text!r}, a number is needed") from fault
