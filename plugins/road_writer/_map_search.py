"""A library of existing maps: read, described by legs and lanes, searched for the one nearest to a layout.

The maps that come with the project stand in maps.yaml as layouts; a folder of the user's holds .net.xml and .xodr
files, which netconvert reads. Knows no narrative and no model.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from sgcad_core.case.records import PlainXml, RoadNetwork
from sgcad_core.errors import ConfigError
from sgcad_core.formats.sumo.existing_map import hub_legs, read_map
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.formats.sumo.turning import best_turn, turned_network
from sgcad_core.records.specs import RoadLayout
from sgcad_core.roads.junction_words import JunctionLeg, describe, layout_legs
from sgcad_core.roads.layout import COMPASS, hub_control, road_spec

BUILT_IN = Path(__file__).with_name("maps.yaml")
ENDINGS = (".net.xml", ".xodr")
LEG_COST, CONTROL_COST, KIND_COST = 10.0, 0.3, 0.3
"""Beside 1 for a radian that a leg lies off and 0.2 for a lane: a leg too many outweighs everything else."""


class Map(NamedTuple):
    """One map; `layout` where it was drawn from one, else `plain`."""

    name: str
    legs: tuple[JunctionLeg, ...]
    control: str
    layout: RoadLayout | None = None
    plain: PlainXml | None = None

    @property
    def words(self) -> str:
        """Legs and lanes, in the words in which real junctions are described."""
        return describe(self.legs, self.control)


def library(folder: Path | None) -> tuple[Map, ...]:
    """The maps of a folder; the project's own if the folder is None. Raises ConfigError, MissingTool."""
    return _built_in() if folder is None else _folder(folder.resolve())


def nearest(maps: Sequence[Map], wanted: RoadLayout) -> tuple[Map, float]:
    """The map nearest to a layout and the turn that fits it best (radians); of equally near maps the first."""
    found = [(_cost(m, wanted), i) for i, m in enumerate(maps)]
    chosen = maps[min(found)[1]]
    return chosen, _turn(chosen, wanted)[0]


def compiled(chosen: Map, turn_rad: float) -> RoadNetwork:
    """The map as a network, turned; its log begins with the map's name, turn and description."""
    if chosen.layout is not None:
        layout = _turned(chosen.layout, turn_rad)
        spec = road_spec(layout)
        network = compile_network(plain_xml(spec), spec).model_copy(update={"layout": layout})
    else:
        network = compile_network(turned_network(chosen.plain or PlainXml(nodes="", edges=""), turn_rad))
    said = f"map_library: {chosen.name}, turned by {math.degrees(turn_rad):.0f} degrees: {chosen.words}"
    log = f"{said}; the map existed before the report, so its connectivity is not the writer's\n{network.log}".strip()
    return network.model_copy(update={"source": "map_library", "log": log})


# ------------------------------------------------------------------ likeness
def _cost(m: Map, wanted: RoadLayout) -> float:
    legs = layout_legs(wanted)
    cost = LEG_COST * abs(len(m.legs) - len(legs)) + _turn(m, wanted)[1]
    cost += CONTROL_COST * (m.control != hub_control(wanted.legs))
    return cost + KIND_COST * (_features(m.layout) != _features(wanted)) if m.layout else cost


def _features(layout: RoadLayout) -> tuple[object, ...]:
    kinds = sorted(leg.kind for leg in layout.legs)
    curved = any(leg.curve != "none" for leg in layout.legs)
    return kinds, curved, any(leg.median != "none" for leg in layout.legs)


def _turn(m: Map, wanted: RoadLayout) -> tuple[float, float]:
    return best_turn(m.legs, layout_legs(wanted), math.pi / 4 if m.layout else 0.0)


def _turned(layout: RoadLayout, turn_rad: float) -> RoadLayout:
    """A layout turned by a multiple of 45 degrees."""
    steps = round(turn_rad / (math.pi / 4))  # counter-clockwise; compass bearings run clockwise
    legs = (
        leg.model_copy(update={"bearing": COMPASS[(COMPASS.index(leg.bearing) - steps) % 8]}) for leg in layout.legs
    )
    return layout.model_copy(update={"legs": tuple(legs)})


# ------------------------------------------------------------------ the two kinds of libraries
@cache
def _built_in() -> tuple[Map, ...]:
    raw: dict[str, Any] = yaml.safe_load(BUILT_IN.read_text(encoding="utf-8"))
    return tuple(_drawn(name, _layout(entry)) for name, entry in raw.items())


def _layout(entry: dict[str, Any]) -> RoadLayout:
    common, only = entry.get("leg", {}), entry.get("only", {})
    legs = [
        {"bearing": bearing, "lanes_in": lanes[0], "lanes_out": lanes[1], **common, **only.get(bearing, {})}
        for bearing, lanes in entry["legs"].items()
    ]
    return RoadLayout.model_validate({"legs": legs})


def _drawn(name: str, layout: RoadLayout) -> Map:
    return Map(name, layout_legs(layout), hub_control(layout.legs), layout=layout)


@cache
def _folder(folder: Path) -> tuple[Map, ...]:
    files = sorted(f for f in folder.glob("*") if f.name.endswith(ENDINGS)) if folder.is_dir() else []
    if not files:
        raise ConfigError(
            f"{folder}: no map library; put {' or '.join(ENDINGS)} files there, or leave `folder` out: "
            "the project's own maps then serve"
        )
    return tuple(_read(file) for file in files)


def _read(file: Path) -> Map:
    plain = read_map(file)
    legs, control = hub_legs(plain)
    return Map(file.name, legs, control, plain=plain)
