"""What one scenario may take with all that it names (catalogs, map, distributions): work and memory in one budget.

Prices are processor time and memory as measured for each kind of thing on a machine of two cores (27 November 2026), so
that a file is refused by what it would take, the same on every machine, before it takes it. Knows no file.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple


class Price(NamedTuple):
    """What one thing takes: microseconds and bytes; `played`: whether that is time of playing."""

    work_us: float
    memory_b: float
    played: bool = False


PRICES: dict[str, Price] = {
    "characters": Price(0.01, 5),
    "elements": Price(12, 400),
    "attributes": Price(1, 250),
    "elements of catalog entries": Price(20, 400),
    "catalog folders": Price(700, 1_000),
    "geometries": Price(60, 300),
    "points of roads": Price(0.4, 110),
    "edges of lanes": Price(0.03, 0),
    "listed values": Price(1, 350),
    "drawn values": Price(4, 0),
    "steps of entities": Price(15, 150, True),
    "tests of conditions": Price(3, 0, True),
    "places found": Price(4, 0, True),
    "vertices of trajectories": Price(20, 60, True),
    "points looked at": Price(0.02, 0, True),
    "roads on a way": Price(15, 300, True),
}
WORK_S = 5.0
"""Of reading."""
PLAYED_S = 10.0
MEMORY_MB = 300.0


class TooMuch(Exception):
    """The budget does not cover it; the message says what, how many and which limit."""


@dataclass(eq=False)
class Budget:
    """What is spent of it. Those of a scenario and of its map count together once `join` ties them."""

    work_us: float = 0.0
    played_us: float = 0.0
    memory_b: float = 0.0
    counts: dict[str, float] = field(default_factory=dict)
    """How many of each kind."""
    beside: Budget | None = None

    def spend(self, what: str, count: float) -> None:
        """Take `count` things of a kind. Raises TooMuch; then nothing is taken."""
        price, joined, had = PRICES[what], self.beside or _NONE, self.counts.get(what, 0.0)
        work, memory = price.work_us * count, price.memory_b * count
        spent = (self.played_us + joined.played_us) if price.played else (self.work_us + joined.work_us)
        most_s = PLAYED_S if price.played else WORK_S
        if spent + work > most_s * 1e6:
            raise TooMuch(f"takes more than {most_s:g} s {_WAY[price.played]} ({had + count:.0f} {what})")
        if self.memory_b + joined.memory_b + memory > MEMORY_MB * 1e6:
            raise TooMuch(f"takes more than {MEMORY_MB:g} MB {_WAY[price.played]} ({had + count:.0f} {what})")
        self.counts[what] = had + count
        self.memory_b += memory
        self.work_us += 0.0 if price.played else work
        self.played_us += work if price.played else 0.0

    def join(self, other: Budget) -> None:
        """Count what the other spends as well, and the other way round."""
        self.beside, other.beside = other, self

    def admit(self, text: str) -> None:
        """Take what it costs to parse an XML text, before it is parsed. Raises TooMuch."""
        self.spend("characters", len(text))
        self.spend("elements", text.count("<") - text.count("</"))
        self.spend("attributes", text.count("="))


_WAY = {True: "to play", False: "to read"}
_NONE = Budget()
