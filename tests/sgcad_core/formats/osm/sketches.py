"""Small maps of invented streets, drawn in metres about a place and written as .osm text."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

from sgcad_core.formats.osm.street_map import StreetMap, read_street_map

LAT, LON = 40.0, -75.0
_M_LAT = 1 / 111_034.6
_M_LON = 1 / (111_412.88 * math.cos(math.radians(LAT)) - 93.5 * math.cos(3 * math.radians(LAT)))
"""Degrees a metre at 40 degrees north, by the series of the length of a degree (not by the product's radii)."""
Point = tuple[float, float]


@dataclass
class Sketch:
    """Nodes by place, ways by their nodes."""

    nodes: dict[Point, tuple[int, dict[str, str]]] = field(default_factory=dict)
    ways: list[tuple[list[int], dict[str, str]]] = field(default_factory=list)

    def node(self, x: float, y: float, **tags: str) -> int:
        """The node at a place in metres, made at need."""
        number, known = self.nodes.setdefault((round(x, 2), round(y, 2)), (len(self.nodes) + 1, {}))
        known.update(tags)
        return number

    def street(self, name: str, points: list[Point], **tags: str) -> None:
        """A named way through places; `lanes__forward` is the tag lanes:forward."""
        told = {"highway": "tertiary"} | ({"name": name} if name else {})
        told |= {key.replace("__", ":"): value for key, value in tags.items()}
        self.ways.append(([self.node(*p) for p in points], told))

    def text(self) -> str:
        """The map as an .osm file."""
        lines = ["<osm version='0.6'>"]
        for (x, y), (number, tags) in self.nodes.items():
            place = f"lat='{LAT + y * _M_LAT:.9f}' lon='{LON + x * _M_LON:.9f}'"
            lines.append(f"<node id='{number}' {place}>{_tags(tags)}</node>")
        for number, (nodes, tags) in enumerate(self.ways, 1):
            refs = "".join(f"<nd ref='{n}'/>" for n in nodes)
            lines.append(f"<way id='{number}'>{refs}{_tags(tags)}</way>")
        return "\n".join([*lines, "</osm>"])

    def written(self, folder: Path, name: str = "sketch.osm") -> StreetMap:
        """The map, written to a folder and read again."""
        file = folder / name
        file.write_text(self.text(), encoding="utf-8")
        return read_street_map(file)


def _tags(tags: dict[str, str]) -> str:
    return "".join(f"<tag k={quoteattr(k)} v={quoteattr(v)}/>" for k, v in tags.items())


def polar(heading_deg: float, length_m: float, start: Point = (0.0, 0.0)) -> Point:
    """The point so far away on a heading, degrees clockwise from north."""
    angle = math.radians(heading_deg)
    return start[0] + length_m * math.sin(angle), start[1] + length_m * math.cos(angle)
