"""Draws configs/extracts/streets.osm: a made-up town with named streets, in OpenStreetMap's format.

    python docs/draw_places.py

Its junctions are of every kind that a report's place may have: a grid of streets that is turned by 12 degrees, a
skewed crossing, a divided road, T junctions, a one-way street, a roundabout, a highway with a number, two crossings of
the same names. Nothing in it is real.
"""

from __future__ import annotations

import math

from draw_extracts import OUT, Town

TURN = math.radians(12.0)
Point = tuple[float, float]


class Streets(Town):
    """A town in a frame that is turned clockwise by 12 degrees."""

    def at(self, x: float, y: float) -> Point:
        """A place of the frame, in metres east and north."""
        return x * math.cos(TURN) + y * math.sin(TURN), y * math.cos(TURN) - x * math.sin(TURN)

    def street(self, name: str, points: list[Point], kind: str, lanes: str, mph: int, **tags: str) -> None:
        """A named street through places of the frame."""
        told = {"name": name, "lanes": lanes, "maxspeed": f"{mph} mph"}
        told |= {key.replace("__", ":"): value for key, value in tags.items()}
        self.way([self.at(*p) for p in points], kind, **told)

    def put(self, x: float, y: float, **tags: str) -> None:
        """A node with tags at a place of the frame."""
        self.node(*self.at(x, y), **tags)


def grid(made: Streets) -> None:
    """Maple, Cedar and First Street cross 4th and 5th Avenue and end at Harbor Boulevard, which is divided."""
    made.street("North Maple Street", [(0, y) for y in (-300, 0, 210, 452, 468, 700)], "secondary", "4", 35)
    made.street("Cedar Street", [(200, y) for y in (-300, -15, 0, 15, 210, 452)], "residential", "2", 25)
    made.street("First Street", [(420, y) for y in (-300, 0, 210, 452)], "residential", "2", 25, oneway="yes")
    made.street("East 4th Avenue", [(x, 0) for x in (-300, 0, 200, 420, 700)], "residential", "2", 25)
    turns = {"lanes__forward": "2", "lanes__backward": "1", "turn__lanes__forward": "left|through;right"}
    made.street("East 5th Avenue", [(x, 210) for x in (-300, 0, 200, 420, 700)], "tertiary", "3", 30, **turns)
    for y, way in ((452, (-300, 0, 200, 420, 700)), (468, (700, 0, -300))):
        made.street("Harbor Boulevard", [(x, y) for x in way], "primary", "2", 45, oneway="yes")
    for x, y in ((0, 210), (0, 452), (0, 468)):
        made.put(x, y, highway="traffic_signals")
    made.put(200, 210, highway="stop", stop="all")
    made.put(200, -15, highway="stop", direction="forward")
    made.put(200, 15, highway="stop", direction="backward")


def rim(made: Streets) -> None:
    """A skewed crossing, a T junction, a roundabout and a highway with a number, away from the grid."""
    made.street("Old Post Road", [(x, 0) for x in (1000, 1300, 1600, 1900)], "secondary", "2", 45)
    far = [(1300 + s * math.cos(math.radians(50)), s * math.sin(math.radians(50))) for s in (-300, 0, 300)]
    made.street("Mill Road", far, "tertiary", "2", 35)
    made.street("Orchard Lane", [(1600, 0), (1600, -20), (1600, -250)], "residential", "2", 25)
    made.put(1600, -20, highway="stop", direction="backward")
    ring = [(18 * math.cos(math.radians(a)), -900 + 18 * math.sin(math.radians(a))) for a in range(0, 360, 30)]
    made.street("", [*ring, ring[0]], "tertiary", "1", 20, junction="roundabout")
    made.street("Lakeview Drive", [(0, -1200), (0, -918)], "tertiary", "2", 35)
    made.street("Lakeview Drive", [(0, -882), (0, -600)], "tertiary", "2", 35)
    made.street("College Way", [(18, -900), (300, -900)], "tertiary", "2", 30)
    made.street("College Way", [(-300, -900), (-18, -900)], "tertiary", "2", 30)
    made.street("Prairie Highway", [(x, -1600) for x in (-900, 0, 900)], "trunk", "2", 55, ref="US 40")
    made.street("", [(0, -1900), (0, -1620), (0, -1600), (0, -1300)], "tertiary", "2", 45, ref="CR 12")
    made.put(0, -1620, highway="stop", direction="forward")


def twins(made: Streets) -> None:
    """Park Street crosses Elm Street in two places, four kilometres apart."""
    for x, name, lights in ((3000, "Alder Falls", True), (7000, "Dunmore", False)):
        made.street("Park Street", [(x, y) for y in (2700, 3000, 3300)], "residential", "2", 25)
        made.street("Elm Street", [(x + step, 3000) for step in (-300, 0, 300)], "residential", "2", 25)
        made.put(x, 3000, highway="traffic_signals") if lights else made.put(x, 3000, highway="stop", stop="all")
        made.put(x + 60, 3060, place="town", name=name)


def main() -> None:
    """Write the town."""
    made = Streets()
    for part in (grid, rim, twins):
        part(made)
    for _, tags in made.ways:
        if not tags["name"]:
            del tags["name"]
    (OUT / "streets.osm").write_text(made.text(), encoding="utf-8")


if __name__ == "__main__":
    main()
