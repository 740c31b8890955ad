"""Draws configs/extracts/*.osm: two small towns of our own in OpenStreetMap's format, so that retrieval baselines run
where no map is at hand.

    python docs/draw_extracts.py

`town.osm` is laid out like an American town: a grid of two-lane streets with stop signs, arterials of four lanes with
signals and a left-turn lane, one-way pairs, skewed roads and T-junctions at its rim. `far_city.osm` is what a map from
elsewhere looks like to such a crash: ring roads of six to ten lanes, one-way frontage roads, signals nearly everywhere.
Nothing in them is real.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

OUT = Path(__file__).resolve().parent.parent / "configs" / "extracts"
LAT, LON = 40.0, -100.0
TURN_LANE = "left|through|through"
M_LAT = 1 / 111_320
M_LON = 1 / (111_320 * math.cos(math.radians(LAT)))
Tags = dict[str, str]


@dataclass
class Town:
    """Nodes by place in metres, ways by their nodes."""

    nodes: dict[tuple[float, float], tuple[int, Tags]] = field(default_factory=dict)
    ways: list[tuple[list[int], Tags]] = field(default_factory=list)

    def node(self, x: float, y: float, **tags: str) -> int:
        """The node at a place, made at need; tags are added."""
        number, known = self.nodes.setdefault((round(x, 1), round(y, 1)), (len(self.nodes) + 1, {}))
        known.update(tags)
        return number

    def way(self, points: list[tuple[float, float]], highway: str, **tags: str) -> None:
        """A way through places, in order."""
        self.ways.append(([self.node(*p) for p in points], {"highway": highway, **tags}))

    def sign(self, x: float, y: float, what: str) -> None:
        """What controls the junction at a place: traffic_signals or stop."""
        self.node(x, y, highway=what, **({"stop": "all"} if what == "stop" else {}))

    def text(self) -> str:
        """The town as an .osm file."""
        lines = ["<?xml version='1.0' encoding='UTF-8'?>", "<osm version='0.6' generator='sg-cadvlm'>"]
        for (x, y), (number, tags) in self.nodes.items():
            place = f"lat='{LAT + y * M_LAT:.6f}' lon='{LON + x * M_LON:.6f}'"
            lines.append(_element(f"node id='{number}' {place} version='1'", "node", "", tags))
        for number, (nodes, tags) in enumerate(self.ways, 1):
            refs = "".join(f"<nd ref='{n}'/>" for n in nodes)
            lines.append(_element(f"way id='{number}' version='1'", "way", refs, tags))
        return "\n".join([*lines, "</osm>", ""])


def _element(start: str, name: str, inner: str, tags: Tags) -> str:
    inner += "".join(f"<tag k={quoteattr(k)} v={quoteattr(v)}/>" for k, v in tags.items())
    return f"<{start}>{inner}</{name}>" if inner else f"<{start}/>"


def town() -> Town:
    """Blocks of 220 m, five streets each way, and what lies at the rim."""
    made = Town()
    steps = [220.0 * i for i in range(5)]
    streets = {0.0: ("residential", "2", ""), 220.0: ("tertiary", "2", ""), 440.0: ("primary", "4", ""),
               660.0: ("secondary", "5", TURN_LANE), 880.0: ("residential", "2", "")}  # fmt: skip
    for x, (kind, lanes, turns) in streets.items():
        _street(made, [(x, y) for y in (-200.0, *steps, 1080.0)], kind, lanes, turns)
    crossing = {0.0: ("residential", "2", ""), 220.0: ("secondary", "4", ""), 440.0: ("primary", "5", TURN_LANE),
                660.0: ("residential", "1", "one-way"), 880.0: ("tertiary", "2", "")}  # fmt: skip
    for y, (kind, lanes, turns) in crossing.items():
        _street(made, [(x, y) for x in (-200.0, *steps, 1080.0)], kind, lanes, turns)
    for x in (440.0, 660.0):
        for y in steps:
            made.sign(x, y, "traffic_signals")
    for place in ((0.0, 0.0), (220.0, 880.0), (880.0, 880.0)):
        made.sign(*place, "stop")
    _rim(made)
    return made


def _street(made: Town, points: list[tuple[float, float]], kind: str, lanes: str, turns: str) -> None:
    tags = {"lanes": lanes, "maxspeed": {"residential": "25 mph", "tertiary": "30 mph"}.get(kind, "40 mph")}
    if turns == "one-way":
        tags["oneway"] = "yes"
    elif turns:  # the fifth lane is a left-turn lane of one direction
        tags |= {"lanes:forward": "3", "lanes:backward": "2", "turn:lanes:forward": turns}
    made.way(points, kind, **tags)


def _rim(made: Town) -> None:
    """T-junctions of several widths, a skewed crossing, a fork, a five-leg junction, a divided road with ramps."""
    rows = ((0, "2", "2"), (1, "2", "1"), (2, "4", "2"), (3, "5", "2"), (4, "4", "4"), (5, "3", "2"), (6, "6", "2"))
    for i, main, stem in rows:
        y = -600.0 - 300.0 * i
        made.way([(0.0, y), (300.0, y), (600.0, y)], "secondary", lanes=main, maxspeed="45 mph")
        made.way([(300.0, y), (300.0, y - 120.0)], "residential", lanes=stem, maxspeed="25 mph")
        if i in (2, 4):
            made.sign(300.0, y, "traffic_signals")
    made.way([(1600.0, 0.0), (1800.0, 0.0), (2000.0, 0.0)], "secondary", lanes="4", maxspeed="45 mph")
    made.way([(1690.0, -160.0), (1800.0, 0.0), (1910.0, 160.0)], "tertiary", lanes="2", maxspeed="35 mph")
    made.way([(1600.0, 500.0), (1800.0, 500.0), (2000.0, 580.0)], "secondary", lanes="2", maxspeed="45 mph")
    made.way([(1800.0, 500.0), (2000.0, 420.0)], "tertiary", lanes="2", maxspeed="35 mph")
    for angle in range(0, 360, 72):
        far = (1800.0 + 180 * math.cos(math.radians(angle)), 1000.0 + 180 * math.sin(math.radians(angle)))
        made.way([far, (1800.0, 1000.0)], "tertiary", lanes="2", maxspeed="30 mph")
    made.way(
        [(1600.0, -400.0), (1800.0, -400.0), (2100.0, -400.0)], "trunk", lanes="2", oneway="yes", maxspeed="65 mph"
    )
    made.way([(1640.0, -470.0), (1800.0, -400.0)], "trunk_link", lanes="1", oneway="yes", maxspeed="45 mph")
    made.way(
        [(1600.0, -800.0), (1800.0, -800.0), (2100.0, -800.0)], "motorway", lanes="3", oneway="yes", maxspeed="65 mph"
    )
    made.way([(1800.0, -800.0), (1980.0, -870.0)], "motorway_link", lanes="1", oneway="yes", maxspeed="45 mph")


def far_city() -> Town:
    """A grid of 500 m of wide roads with one-way frontage roads, and two ring roads joined by ramps."""
    made = Town()
    steps = [500.0 * i for i in range(4)]
    widths = ("8", "6", "10", "6")
    for at, lanes in zip(steps, widths, strict=True):
        made.way([(at, y) for y in (-300.0, *steps, 1800.0)], "primary", lanes=lanes, maxspeed="60")
        made.way([(x, at) for x in (-300.0, *steps, 1800.0)], "primary", lanes=lanes, maxspeed="60")
    for x in steps:
        for y in steps:
            made.sign(x, y, "traffic_signals")
    for i, x in enumerate(steps[:3]):  # frontage roads and lanes of the blocks
        made.way(
            [(x + 250.0, y) for y in (0.0, 250.0, 500.0)],
            "residential",
            lanes=str(1 + i % 2),
            oneway="yes",
            maxspeed="30",
        )
        made.way([(x, 750.0), (x + 250.0, 750.0), (x + 500.0, 750.0)], "secondary", lanes="4", maxspeed="50")
        made.sign(x, 750.0, "traffic_signals")
        made.way([(x + 250.0, 750.0), (x + 250.0, 1000.0)], "tertiary", lanes="4", maxspeed="40")
    made.sign(1500.0, 750.0, "traffic_signals")
    for y, lanes in ((-800.0, "4"), (-1200.0, "3")):
        made.way([(-300.0, y), (500.0, y), (1300.0, y)], "motorway", lanes=lanes, oneway="yes", maxspeed="100")
        made.way([(300.0, y - 90.0), (500.0, y)], "motorway_link", lanes="2", oneway="yes", maxspeed="60")
    return made


def main() -> None:
    """Write both."""
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "town.osm").write_text(town().text(), encoding="utf-8")
    (OUT / "far_city.osm").write_text(far_city().text(), encoding="utf-8")


if __name__ == "__main__":
    main()
