"""Start conditions of a plan's events: editable conditions that hold from the planned step on and not before.

For an actor in the contact the distance to the other; for others the distance traveled; for standing actors the
clock. Thresholds lie between two steps of the plan, so that players which move a little otherwise fire at the same one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scenariogeneration import xosc
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.case.records import Trajectory
from sgcad_core.formats.openscenario.writing.parts import at_once, from_time, rounded
from sgcad_core.geometry.plane import Floats, arc_lengths

NEARER_M = 0.1
"""The two come nearer by so much in the step at least: at a slower pace the step is not certain."""
GONE_M = 0.05
"""Gone in the step at least."""


@dataclass(frozen=True)
class EventTriggers:
    """The motions of all origins to the end, and the partners of the contact."""

    moves: Mapping[str, Trajectory]
    partners: Mapping[str, str]
    clock: bool = False
    """Whether all goes by the clock."""

    def at(self, name: str, actor: str, t_s: float) -> xosc.ValueTrigger | xosc.EntityTrigger:
        """From a time of the plan on."""
        row = self._row(actor, t_s)
        if row == 0:
            return at_once(name)
        if self.clock:
            return from_time(name, t_s)
        return self._nearer(name, actor, row) or self._gone(name, actor, row) or from_time(name, t_s)

    def place(
        self, name: str, actor: str, row: int, there: tuple[float, float], position: xosc.LanePosition
    ) -> xosc.ValueTrigger | xosc.EntityTrigger:
        """From where it was planned to begin: so near to a place ahead on its way (x, y and as it is written)."""
        if row == 0:
            return at_once(name)
        move = self.moves[actor]
        gap = np.hypot(move.x_m - there[0], move.y_m - there[1])
        if self.clock or not _falls(gap, row, GONE_M):
            return self.at(name, actor, float(move.t_s[row]))
        told = xosc.DistanceCondition(
            between(gap[row], gap[row - 1]), xosc.Rule.lessThan, position, alongroute=False, freespace=False,
            distance_type=_straight(), coordinate_system=xosc.CoordinateSystem.entity,
        )  # fmt: skip
        return _by_entity(name, actor, told)

    def _row(self, actor: str, t_s: float) -> int:
        return int(np.searchsorted(self.moves[actor].t_s, t_s - 1e-6))

    def _nearer(self, name: str, actor: str, row: int) -> xosc.EntityTrigger | None:
        """Where the other has come so near for the first time."""
        if not (partner := self.partners.get(actor, "")):
            return None
        one, two = self.moves[actor], self.moves[partner]
        gap = np.hypot(one.x_m[: row + 1] - two.x_m[: row + 1], one.y_m[: row + 1] - two.y_m[: row + 1])
        if not _falls(gap, row, NEARER_M):
            return None
        told = xosc.RelativeDistanceCondition(
            between(gap[row], gap[row - 1]), xosc.Rule.lessThan, _straight(), partner, alongroute=False,
            freespace=False,
        )  # fmt: skip
        return _by_entity(name, actor, told)

    def _gone(self, name: str, actor: str, row: int) -> xosc.EntityTrigger | None:
        move = self.moves[actor]
        gone = arc_lengths(move.points)
        if gone[row] - gone[row - 1] < GONE_M:
            return None
        return _by_entity(name, actor, xosc.TraveledDistanceCondition(between(gone[row - 1], gone[row])))


def between(low: float, high: float) -> float:
    """A number about half way between two, with as few digits as tell it apart from both."""
    middle = (low + high) / 2
    for digits in range(6):
        if low + (high - low) / 4 < (told := round(middle, digits)) < high - (high - low) / 4:
            return told
    return rounded(middle)


def _falls(gap_m: Floats, row: int, least_m: float) -> bool:
    """Whether a distance falls in the step to a row, and was never as small before."""
    return bool(gap_m[row - 1] - gap_m[row] >= least_m and gap_m[:row].min() >= gap_m[row - 1] - 1e-9)


def _straight() -> object:
    """As the crow flies; version 1.0 has another word."""
    kinds = xosc.RelativeDistanceType
    return kinds.cartesianDistance if VersionBase().isVersion(minor=0) else kinds.euclidianDistance


def _by_entity(name: str, actor: str, condition: object) -> xosc.EntityTrigger:
    return xosc.EntityTrigger(name, 0.0, xosc.ConditionEdge.none, condition, actor)
