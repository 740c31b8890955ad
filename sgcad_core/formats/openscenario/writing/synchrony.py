"""The last piece of a plan as a meeting: one actor chooses its speed so that it is in its place when the other is.

That is the plan where the other drives at an even speed from there on, since the one then speeds up or slows down
evenly. The meeting also holds where the other's approach is edited or driven. Knows no XML.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sgcad_core.case.records import Floats
from sgcad_core.formats.openscenario.roads.way import LanePlace

EVEN = 0.005
"""Share of the master's speed by which it may still change: the meeting is reckoned with the speed that it has."""
FIRST_S = 0.5
"""Earliest beginning: esmini has no speed of the master in the first step and stops the other actor."""
LEAST_S = 1.0
"""Shortest meeting: shorter ones leave nothing to edit."""
MOVES_MPS = 2.0
"""Least speed at the meeting: a slower actor has no definite time of arrival."""
Knots = tuple[Floats, Floats]


class Meeting(NamedTuple):
    """Begin, master, and the places of both at the meeting."""

    begin_s: float
    master: str
    there: LanePlace
    """The master's place."""
    here: LanePlace


def meeting_of(mine: tuple[Knots, LanePlace], master: tuple[str, Knots, LanePlace]) -> Meeting | None:
    """How one meets a master (name, times and speeds of its pieces, place at the end); None where it cannot."""
    (times, speeds), here = mine
    name, knots, there = master
    begin_s = max(float(times[-2]), _even_from(knots), FIRST_S)
    if float(times[-1]) - begin_s < LEAST_S or min(speeds[-1], knots[1][-1], _speed(mine[0], begin_s)) < MOVES_MPS:
        return None
    return Meeting(begin_s, name, there, here)


def _even_from(knots: Knots) -> float:
    """The first time from which the speed stays what it is at the end."""
    times, speeds = knots
    k = len(speeds) - 1
    while k > 0 and abs(speeds[k - 1] - speeds[-1]) <= EVEN * speeds[-1]:
        k -= 1
    return float(times[k])


def _speed(knots: Knots, t_s: float) -> float:
    return float(np.interp(t_s, *knots))
