"""Junctions that can be drawn, one record each, and places that reports name and that cannot be drawn.

Plain data: knows no pydantic, no narrative and no file format. Wordings stand in `sgcad_core/reading/language`; a
record names its rule.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from sgcad_core.kinds.roads import ALLEY, DRIVEWAY, RAMP, ROAD, RoadKind

JunctionKind = Literal["none", "roundabout", "parking_lot", "t", "four_leg", "alley", "driveway", "ramp"]
T: Final = "t"
FOUR_LEG: Final = "four_leg"
ROUNDABOUT: Final = "roundabout"
PARKING_LOT: Final = "parking_lot"
WORK_ZONE: Final = "work_zone"
GARAGE: Final = "parking_garage"
MEDIAN_OPENING: Final = "median_opening"
GORE: Final = "gore"
"""Names of junctions and places for code that treats one of them apart; no other module spells them (a test looks)."""
PLAIN: Final = "plain"
FOUR: Final = "four"
MERGE: Final = "merge"
"""Layouts of made reports that are not called as their kind is (`Junction.layout`)."""


@dataclass(frozen=True)
class Junction:
    """A junction that can be drawn: `legs` meet at its hub, of which one is a road of the kind `stem` where not all are
    roads; `rule`: the wordings that name it; `layout`: what made reports call it, "" while none are made of it;
    `round`: its legs meet at a circle, and there may be fewer or more of them."""

    kind: JunctionKind
    called: str
    legs: int
    intersections: int
    layout: str
    stem: RoadKind = ROAD
    rule: str = ""
    round: bool = False

    @property
    def crossing(self) -> bool:
        """Whether two roads cross, so that no leg is a stem."""
        return self.legs == 4

    @property
    def meets(self) -> bool:
        """Whether it has a leg that one of two roads may lack: a stem, or both legs of the crossing road."""
        return self.legs > 2 and self.stem != RAMP


JUNCTIONS: tuple[Junction, ...] = (
    Junction("none", "a road without a junction", 2, 0, PLAIN),
    Junction(ROUNDABOUT, "a roundabout", 4, 1, "", rule="junction.roundabout", round=True),
    Junction(PARKING_LOT, "a parking lot", 2, 0, "", stem=DRIVEWAY, rule="junction.parking_lot"),
    Junction(FOUR_LEG, "a four-leg intersection", 4, 1, FOUR, rule="junction.four"),
    Junction(T, "a T-intersection", 3, 1, T, rule="junction.t"),
    Junction(ALLEY, "an alley", 3, 1, "", stem=DRIVEWAY),
    Junction(DRIVEWAY, "a driveway", 3, 1, DRIVEWAY, stem=DRIVEWAY),
    Junction(RAMP, "a ramp that merges", 3, 1, MERGE, stem=RAMP),
)
"""Kinds that a text names come in the order in which they win where two are named at one place."""
INTERSECTIONS: tuple[str, ...] = tuple(one.layout for one in JUNCTIONS if one.layout and one.meets and one.stem == ROAD)
"""Layouts of made reports in which streets meet."""


@dataclass(frozen=True)
class Unsupported:
    """A place that reports name and that cannot be drawn as it is: the network carries a note of what it lacks.

    Its words are the vocabulary class `unsupported_place`, whose meanings are these kinds.
    """

    kind: str
    called: str
    remedy: str


UNSUPPORTED: tuple[Unsupported, ...] = (
    Unsupported(GARAGE, "a parking garage", "a level is drawn as a parking lot, without walls, pillars and ramps"),
    Unsupported("interchange", "an interchange", "see that the ramp or the road of the crash is drawn"),
    Unsupported(
        WORK_ZONE,
        "a work zone",
        "the road is drawn without it: lanes that are closed are drawn on roads of two or more each way, off junctions",
    ),
    Unsupported(
        MEDIAN_OPENING,
        "an opening in the median",
        "the road is drawn without it: openings are drawn on roads without a junction",
    ),
    Unsupported(GORE, "a gore area", "the gore is drawn at its ramp; see that the vehicle or thing is in it"),
    Unsupported("rail_crossing", "a railway crossing", "the road is drawn without its rails"),
)


def junction_kind(kind: JunctionKind) -> Junction:
    """The record of a kind. Raises KeyError for one that there is not."""
    return {record.kind: record for record in JUNCTIONS}[kind]


def unsupported_kind(kind: str) -> Unsupported:
    """The record of a kind that cannot be drawn. Raises KeyError for one that there is not."""
    return {record.kind: record for record in UNSUPPORTED}[kind]
