"""Compass words: directions in text, turns between them, what lies opposite. Knows no vehicle."""

from __future__ import annotations

import math
from typing import Literal, get_args

from sgcad_core.reading.language import rule, values
from sgcad_core.records.specs import Compass

COMPASS: tuple[Compass, ...] = get_args(Compass)
WORDS: dict[str, Compass] = values("compass")
NAMES: dict[Compass, str] = {point: word for word, point in WORDS.items()}
AXIS_NAMES: dict[Compass, str] = {axis: name for name, axis in values("axis").items()}
"""Axis -> how a message calls it, its first end first."""
OPPOSITE_HAND: dict[str, Literal["left", "right"]] = {"left": "right", "right": "left"}


def compass_of(word: str) -> Compass | None:
    """ "northbound", "north", "northerly" -> "N"; None if it is no direction."""
    match = rule("compass.direction").match(word.lower())
    return WORDS[match.group(1)] if match else None


def turned(heading: Compass, clockwise_deg: float) -> Compass:
    """The heading after a clockwise turn, to the nearest eighth."""
    return COMPASS[round(COMPASS.index(heading) + clockwise_deg / 45) % 8]


def between(first: Compass, second: Compass) -> int:
    """Clockwise turn from the first heading to the second, degrees in [0, 360)."""
    return (COMPASS.index(second) - COMPASS.index(first)) % 8 * 45


def against(first: Compass, second: Compass) -> bool:
    """Whether two headings come against each other, an eighth more or less."""
    return between(first, second) in (135, 180, 225)


def compass_of_angle(heading_rad: float) -> Compass:
    """The nearest compass word of a heading counter-clockwise from east."""
    return COMPASS[round((90 - math.degrees(heading_rad)) % 360 / 45) % 8]


def angle_of(heading: Compass) -> float:
    """Heading in radians counter-clockwise from east."""
    return math.radians(90 - 45 * COMPASS.index(heading))
