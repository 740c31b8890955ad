"""What the text says of one vehicle's motion: the record that the readers fill. Knows no text."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from sgcad_core.specs import Compass

Access = Literal["driveway", "parking_lot", "ramp", "shoulder", "side_road"]
DRIVES: tuple[Access, ...] = ("driveway", "parking_lot")
"""Where vehicles come from or turn into that drive on no street there."""
Kin = Literal["same", "opposite", "crossing"]


class Deed(NamedTuple):
    """One thing a vehicle did or was doing; `weight` 4 where the approach says so, 1 in an interview."""

    kind: str
    weight: int
    number: int


@dataclass
class Motion:
    """What the text says of one vehicle's motion; empty where it says nothing."""

    headings: list[tuple[int, Compass]] = field(default_factory=list)
    """(weight, heading) in the order of the text."""
    exits: list[Compass] = field(default_factory=list)
    """Headings that it turned to or meant to turn to."""
    deeds: list[Deed] = field(default_factory=list)
    kin: list[tuple[int, Kin, str | None, str]] = field(default_factory=list)
    """(weight, relation, other vehicle if named, word: ahead, behind, ...)."""
    lane: int | None = None
    lane_word: str | None = None
    speeds_mph: list[tuple[int, int]] = field(default_factory=list)
    origin: Access | None = None
    target: Access | None = None
    axes: list[str] = field(default_factory=list)
    from_side: Literal["left", "right"] | None = None

    def did(self, kind: str, least: int = 1) -> bool:
        """Whether a deed is told with at least that weight."""
        return any(d.kind == kind and d.weight >= least for d in self.deeds)
