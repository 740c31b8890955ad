"""What the text says of one vehicle's motion: the record that the readers fill. Knows no text."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

from sgcad_core.kinds import ALLEY, DRIVEWAY
from sgcad_core.records.specs import Compass

Access = Literal["driveway", "alley", "parking_lot", "ramp", "shoulder", "side_road"]
DRIVES: tuple[Access, ...] = (DRIVEWAY, ALLEY, "parking_lot")
"""Where vehicles come from or turn into that drive on no street there."""
RelativeDirection = Literal["same", "opposite", "crossing"]


class Source(NamedTuple):
    """Where something was read: a sentence's number (from 0), the words, as in the resolved sentence, and the rule."""

    number: int
    words: str = ""
    rule: str = ""


class ManeuverCue(NamedTuple):
    """One thing a vehicle did or was doing; `weight` 4 where the approach says so, 1 in an interview."""

    kind: str
    weight: int
    number: int
    words: str = ""
    rule: str = ""
    at: int = 0
    """Where in its sentence it ends."""

    @property
    def source(self) -> Source:
        """Where it was read."""
        return Source(self.number, self.words, self.rule)

    @property
    def when(self) -> tuple[int, int]:
        """Its place in the order of the text."""
        return self.number, self.at


class WeightedValue(NamedTuple):
    """A heading or a speed (mph) that is told, and with what weight."""

    weight: int
    value: Any
    source: Source


@dataclass
class VehicleMotion:
    """What the text says of one vehicle's motion; empty where it says nothing."""

    at: int = 0
    """The sentence that is being read."""
    watched: bool = False
    """Whether it is the report's own vehicle."""
    ordered: bool = False
    """Whether the cues are one account in order, up to the contact."""
    headings: list[WeightedValue] = field(default_factory=list)
    """In the order of the text."""
    exits: list[Compass] = field(default_factory=list)
    """Headings that it turned to or meant to turn to."""
    cues: list[ManeuverCue] = field(default_factory=list)
    relations: list[tuple[int, RelativeDirection, str | None, str]] = field(default_factory=list)
    """(weight, relation, other vehicle if named, word: ahead, behind, ...)."""
    lane: int | None = None
    """1 = at the right curb; -1 = the leftmost."""
    lane_word: str | None = None
    to_lane: int | str | None = None
    """The lane into which it changes, as `lane` or `lane_word`."""
    straddles: Literal["left", "right"] | None = None
    """The hand on which the lane lies over whose line it stands."""
    speeds_mph: list[WeightedValue] = field(default_factory=list)
    origin: Access | None = None
    target: Access | None = None
    from_side: Literal["left", "right"] | None = None
    street: str | None = None
    """The name of the street that it is first told to drive on."""
    entered: Compass | None = None
    """The way of the traffic into whose lanes it came."""
    sources: dict[str, Source] = field(default_factory=dict)
    """Where lane, origin, target, each exit ("exit W") and where it faces or backs to ("faces W", "backs W") were first
    read."""

    def has_cue(self, kind: str, least: int = 1) -> bool:
        """Whether a cue of that kind has at least that weight."""
        return self.cue(kind, least) is not None

    def cue(self, kind: str, least: int = 1) -> ManeuverCue | None:
        """The first cue of that kind with at least that weight."""
        return next((d for d in self.cues if d.kind == kind and d.weight >= least), None)

    def read(self, what: str, words: str, rule: str) -> None:
        """Note where something was read and by which rule, if it is the first time."""
        self.sources.setdefault(what, Source(self.at, words, rule))

    def add_value(self, into: list[WeightedValue], weight: int, value: Any, words: str, rule: str) -> None:
        """Note a heading or a speed."""
        into.append(WeightedValue(weight, value, Source(self.at, words, rule)))
