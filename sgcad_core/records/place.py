"""A real place: a junction (or a point of a street) of a map, its legs, and how a report fits it.

Headings are degrees clockwise from north, seen from the place; latitudes and longitudes are WGS84 degrees. Plain
values: knows no map file and no narrative.
"""

from __future__ import annotations

from typing import Literal

from sgcad_core.record_base import Record
from sgcad_core.records.specs import Compass, Median, Turn

LegControl = Literal["none", "signal", "flashing", "stop", "yield"]


class MapLeg(Record):
    """One road that leaves the place, as the map has it."""

    street: str
    """Name or number; "" where the map has none."""
    names: tuple[str, ...] = ()
    """All names that the map has for it."""
    heading_deg: float
    lanes_in: int
    lanes_out: int
    lanes_known: bool = True
    """Whether the map counts the lanes; else they are the usual ones of its class."""
    turns_in: tuple[Turn, ...] = ()
    """Use of each lane towards the place, from the right curb; () where the map does not tell it."""
    control: LegControl = "none"
    limit_mph: int | None = None
    center_turn_lane: bool = False
    median: Median = "none"


class MapPlace(Record):
    """A junction of three legs or more, or a point of a street with two."""

    source: str
    """Name of the extract."""
    streets: tuple[str, ...]
    latitude: float
    longitude: float
    legs: tuple[MapLeg, ...]
    circle_lanes: int = 0
    """Lanes around of a roundabout; 0: it is none."""
    where: str = ""
    """Of a point of a street: how it was chosen."""


class PlaceFact(Record):
    """One told fact held against the map. [start, end): its sentence in the narrative; None where it has none."""

    field: Literal["legs", "lanes", "control", "limit", "one_way", "circle"]
    subject: str
    """The street, or "junction"."""
    told: str
    on_map: str
    agrees: bool
    start: int | None = None
    end: int | None = None

    @property
    def text(self) -> str:
        """The comparison in words."""
        of = "" if self.subject == "junction" else f" of {self.subject}"
        name = self.field.replace("_", " ")
        return f"{name}{of}: {self.told}" + (", as on the map" if self.agrees else f", on the map {self.on_map}")


class LaidLeg(Record):
    """A leg of the map under the bearing by which the report knows it; `road`: the id of its road as drawn."""

    bearing: Compass
    leg: MapLeg
    road: str = ""


class Place(Record):
    """What came of looking for the report's place in the maps that a user gave."""

    found: bool
    reason: str = ""
    """Why it was not found; "" where it was."""
    place: MapPlace | None = None
    legs: tuple[LaidLeg, ...] = ()
    facts: tuple[PlaceFact, ...] = ()

    @property
    def origin(self) -> tuple[float, float] | None:
        """Latitude and longitude of the drawn road's (0, 0); None where no place was found."""
        return (self.place.latitude, self.place.longitude) if self.found and self.place else None

    @property
    def sentence(self) -> str:
        """One sentence for people: where it is and how well it fits, or why it was not found."""
        if not self.found or self.place is None:
            return f"the real place is not used: {self.reason}; the road is drawn from the report"
        agree = sum(fact.agrees for fact in self.facts)
        against = "; ".join(fact.text for fact in self.facts if not fact.agrees)
        where = f"{' and '.join(self.place.streets)} ({self.place.latitude:.5f}, {self.place.longitude:.5f})"
        where += f", {self.place.where}" if self.place.where else ""
        told = (
            f"{agree} of {len(self.facts)} told facts agree with the map" if self.facts else "nothing told to compare"
        )
        tail = f"; against it: {against}" if against else ""
        return f"the real place is {where} in {self.place.source}: {told}{tail}"
