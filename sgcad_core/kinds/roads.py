"""Kinds of roads, their names, and what sets some of them apart. Plain data."""

from __future__ import annotations

from typing import Final, Literal

RoadKind = Literal["road", "driveway", "ramp"]
ROAD: Final = "road"
DRIVEWAY: Final = "driveway"
ALLEY: Final = "alley"
RAMP: Final = "ramp"
"""Names of roads for code that treats one of them apart; no other module spells them (a test looks)."""
ROADS: tuple[RoadKind, ...] = (ROAD, DRIVEWAY, RAMP)
JOINING: Final = (DRIVEWAY, RAMP)
"""Roads that lead to or from a street and are told of by a word alone."""
UNPAINTED: Final = (DRIVEWAY, ALLEY)
"""What networks call roads that carry no markings; in a spec an alley is a driveway that says so (`Road.alley`)."""
