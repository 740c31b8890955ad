"""What the generator knows of one crash before it is told: roads, actors, contacts, conditions.

Bearings are indices 0..7 clockwise from north. A leg's bearing says where it lies seen from the hub, so an
actor on leg b heads towards b + 4. Plain data; knows no text, no drawing and no JSON.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass, field
from random import Random

from research.model.answer_grammar import COMPASS as COMPASS
from sgcad_core.kinds import DRIVEWAY, ROAD
from sgcad_core.reading.language import values

_WORD_OF = {point: word for word, point in values("compass").items()}
WORDS = tuple(_WORD_OF[point] for point in COMPASS)
TURN_OF = {"left": 2, "right": -2, "through": 4}
"""Leg taken from leg b: b + TURN_OF[turn]."""


@dataclass
class Leg:
    """One road end at the hub; the fields are those of the answer."""

    bearing: int
    lanes_in: int = 1
    lanes_out: int = 1
    turns_in: list[str] = field(default_factory=list)
    twltl: bool = False
    median: str = "none"
    kind: str = ROAD
    control: str = "none"
    curve: str = "none"
    limit: int | None = None
    mouth: float | None = None
    """Metres of a driveway that a drawing shows beyond the junction; None: as of any leg."""

    @property
    def two_way(self) -> bool:
        """Whether traffic comes in and goes out."""
        return self.lanes_in > 0 and self.lanes_out > 0

    @property
    def flow(self) -> int:
        """Heading of its traffic as a bearing index; of a two-way one, of its inbound traffic."""
        return (self.bearing + 4 * (self.lanes_in > 0)) % 8


OPPOSITE = {"left": "right", "right": "left"}


@dataclass
class Access:
    """A driveway or side road off a leg."""

    leg: int
    side: str
    distance_m: int
    kind: str = DRIVEWAY
    mouth: float | None = None
    """Metres of it that a drawing shows beyond the curb, open at its end; None: a closed stub."""


@dataclass
class Actor:
    """A road user: `leg` it comes from, `out` the leg it takes or means to take."""

    id: str
    kind: str
    leg: int
    out: int | None
    maneuver: str
    lane: int | None = None
    speed: int | None = None
    model: str = ""
    purpose: str = ""
    """Why it stands or slows: "light", "turn_left", "turn_right", "traffic", "sign" or nothing."""

    @property
    def heading(self) -> int:
        """Where it drives, as a bearing index."""
        return (self.leg + 4) % 8

    @property
    def meant(self) -> bool:
        """Whether it stands or slows for a turn, which its maneuver does not say."""
        return self.purpose.startswith("turn_")

    @property
    def vehicle(self) -> bool:
        """Whether it is a motor vehicle: no tree, pedestrian or bicycle."""
        return self.id.startswith("V")

    def exit_of(self, told: Set[str]) -> int | None:
        """The leg that an actor takes, if these facts say which; without a told maneuver, the one straight ahead."""
        on = self.out is not None and (self.out - self.leg) % 8 == 4
        sure = f"man.{self.id}" in told or self.maneuver == "straight" or on
        open_ = self.meant or self.maneuver == "backing"  # which neither standing nor backing out tells
        return self.out if sure and (not open_ or f"exit.{self.id}" in told) else None


@dataclass
class Contact:
    """striker and struck are indices into the actors."""

    striker: int
    struck: int
    striker_area: str
    struck_area: str


@dataclass
class Crash:
    """One crash in full; what is told of it is decided later."""

    config: str
    layout: str
    main: int
    """Bearing of one leg of the main road; the other is main + 4."""
    legs: list[Leg]
    actors: list[Actor]
    contacts: list[Contact]
    light: str
    weather: str
    surface: str
    accesses: list[Access] = field(default_factory=list)
    area_word: str = "urban"
    one_way: bool = False

    def leg(self, bearing: int) -> Leg | None:
        """The leg at a bearing, if there is one."""
        return next((leg for leg in self.legs if leg.bearing == bearing % 8), None)

    @property
    def queue(self) -> list[Contact]:
        """The contacts of vehicles that run into one ahead of them on their road."""
        ends = ("front", "back")
        return [
            contact
            for contact in self.contacts
            if (contact.striker_area, contact.struck_area) == ends
            and self.actors[contact.striker].leg == self.actors[contact.struck].leg
        ]

    @property
    def alone(self) -> bool:
        """Whether a single vehicle crashes, into a thing or a person."""
        return sum(actor.vehicle for actor in self.actors) == 1

    def is_main(self, bearing: int) -> bool:
        """Whether a leg belongs to the main road."""
        return bearing % 4 == self.main % 4

    @property
    def stems(self) -> list[Leg]:
        """Legs that do not belong to the main road: two where roads cross, else one or none."""
        return [leg for leg in self.legs if not self.is_main(leg.bearing)]


def pick(rng: Random, weights: dict[str, float]) -> str:
    """One key, by weight."""
    return rng.choices(list(weights), list(weights.values()))[0]
