"""Real junctions as chunks: cut out of an OpenStreetMap extract and described from their geometry.

A cut is one junction with the junctions nearer than 60 m, three at most, and 150 m of every road that leads
away. Knows no database.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from plugins.retriever.knowledge.chunk import Chunk
from plugins.retriever.knowledge.junction_cut import Cut, cut
from plugins.retriever.knowledge.osm_extract import plain_of
from plugins.retriever.knowledge.plain_graph import PlainGraph, read_plain
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.plain_xml import xsd_findings
from sgcad_core.roads.junction_words import JunctionLeg, describe, marks
from sgcad_core.roads.layout import COMPASS
from sgcad_core.system.temp_folders import temp_folder
from sgcad_core.units import MPS_PER_MPH

CONTROLS = {
    "traffic_light": "signal", "traffic_light_right_on_red": "signal", "traffic_light_unregulated": "signal",
    "allway_stop": "all_way_stop", "priority_stop": "stop",
}  # fmt: skip
"""Other types give no control: OpenStreetMap rarely tells which road yields."""


def junction_chunks(extract: Path, on_skip: Callable[[str, str], None]) -> Iterator[Chunk]:
    """A chunk for every junction of an extract; `on_skip` gets the name and the reason of each that cannot be cut."""
    with temp_folder("osm") as folder:
        graph = read_plain(*plain_of(extract, folder))
    source = extract.name.partition(".osm")[0]
    for node in graph.places:
        if len(graph.neighbors(node)) >= 3:
            try:
                yield _chunk(graph, node, source)
            except InvalidOutput as fault:
                on_skip(f"{source} node {node}", str(fault))


def _chunk(graph: PlainGraph, node: str, source: str) -> Chunk:
    legs = legs_of(graph, node)
    piece = cut(graph, node)
    if findings := xsd_findings(piece.plain):
        raise InvalidOutput(findings[0].line())
    control = CONTROLS.get(graph.types[node], "none")
    return Chunk(
        id=f"junction/{source}/{node}", kind="junction", tasks=("road",), title=describe(legs, control),
        text=_text(legs, control, piece, graph, node), keywords=marks(legs), source=f"OpenStreetMap {source}",
        data=_data(legs, control, piece),
    )  # fmt: skip


def legs_of(graph: PlainGraph, node: str) -> list[JunctionLeg]:
    """One leg for each neighboring node: direction of the road some 20 m out, lanes both ways."""
    legs = []
    for other in graph.neighbors(node):
        edges = [graph.edges[name] for name in graph.touching[node]]
        inward = [e for e in edges if e.start == other]
        outward = [e for e in edges if e.end == other]
        line = outward[0].line if outward else inward[0].line[::-1]
        angle = _direction(line, graph.places[node])
        legs.append(JunctionLeg(angle, sum(e.lanes for e in inward), sum(e.lanes for e in outward)))
    return legs


def _direction(line: Sequence[tuple[float, float]], hub: tuple[float, float]) -> float:
    x, y = next((p for p in line if math.dist(p, hub) >= 20), line[-1])
    return math.atan2(y - hub[1], x - hub[0])


def _text(legs: Sequence[JunctionLeg], control: str, piece: Cut, graph: PlainGraph, node: str) -> str:
    lines = [f"A real junction: {describe(legs, control)}."]
    for leg, other in zip(legs, graph.neighbors(node), strict=True):
        edge = next(e for n in graph.touching[node] if other in ((e := graph.edges[n]).start, e.end))
        about = ", ".join(p for p in (edge.kind, f"{round(edge.speed_mps / MPS_PER_MPH)} mph") if p)
        lines.append(f"- leg {_wind(leg.angle_rad)}: {leg.lanes_in} lanes in, {leg.lanes_out} out; {about}")
    if piece.junctions > 1:
        lines.append(f"{piece.junctions - 1} more junction(s) within 60 m.")
    return "\n".join(lines)


def _wind(angle_rad: float) -> str:
    return COMPASS[round((math.pi / 2 - angle_rad) / (math.pi / 4)) % 8]


def _data(legs: Sequence[JunctionLeg], control: str, piece: Cut) -> str:
    return json.dumps(
        {
            "control": control,
            "legs": [
                {"angle_deg": round(math.degrees(leg.angle_rad) % 360, 1), "lanes_in": leg.lanes_in,
                 "lanes_out": leg.lanes_out} for leg in legs
            ],
            "junctions": piece.junctions,
            "plain": piece.plain.model_dump(),
        }
    )  # fmt: skip
