"""The same encounter a little otherwise, where what follows from it is not what the report tells.

Free are, within what the report leaves open, the place at which the two touch on the sides that are told, and speeds
that nobody tells. Knows encounters and what a cost of the course is; no scene's inside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, zip_longest
from typing import NamedTuple

from sgcad_core.planner.aftermath.rest_fit import IMPACTS, Impact
from sgcad_core.planner.encounter.encounter_search import along_sides
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.pairing import Encounter
from sgcad_core.planner.scene import Scene


class WholeCourse(NamedTuple):
    """All that follows from an encounter, with notes, the oddity of the approach, and how much told is missed."""

    scene: Scene
    notes: tuple[str, ...]
    oddity: float
    missed: float


Unfold = Callable[[Encounter | None, Sequence[Impact]], WholeCourse]
"""Of an encounter, with the frictions and restitutions of the blow that are tried."""

_TOLD_PART = 1.0
"""What a missed part of the told course costs at least."""
_SPEEDS = ((1.0, 1.0), (1.3, 0.75), (0.75, 1.3), (1.2, 1.2), (0.8, 0.8))
"""Factors on speeds that nobody tells. Two that are equally fast come to rest where they met, head on."""
_PLACES = 5
"""Along the told sides, at each of the speeds."""
_MOST, _MOST_AGAIN = 5, 10
"""Of such encounters are tried: each costs about as much as the first. More where the two are to meet a second time:
whether a tail swings into the other hangs on where the blow falls."""
_BETTER = 0.25
"""What another encounter must gain."""


def least_missed(found: Encounter | None, unfold: Unfold) -> WholeCourse:
    """What follows from an encounter, or from one like it that leads nearer to what is told."""
    best = unfold(found, IMPACTS)
    if found is None:
        return best
    again = bool(best.scene.again)
    for other in islice(_like(found, again), _MOST_AGAIN if again else _MOST):
        if best.missed < _TOLD_PART:
            break
        done = unfold(other, IMPACTS if again else [(best.scene.friction, best.scene.restitution)])
        if done.missed < best.missed - _BETTER:
            best = done
    return best


def _like(found: Encounter, again: bool) -> Iterator[Encounter]:
    """Elsewhere along the told sides, at the given speeds and at others, the speeds in turn; for two that are to meet
    `again` at the given ones first."""
    at_speeds = [_along(found, speeds) for speeds in _SPEEDS]
    if again:
        yield from at_speeds.pop(0)
    for row in zip_longest(*at_speeds):
        yield from (other for other in row if other)


def _along(found: Encounter, factors: tuple[float, float]) -> Iterator[Encounter]:
    """All along the told sides, at speeds that nobody tells."""
    first, second = (_paced(o, k) for o, k in zip((found.first, found.second), factors, strict=True))
    if not (first and second):
        return
    one, two = first.motion_with(second), second.motion_with(first)
    if one.drivable and two.drivable:
        for meeting in along_sides(one, two, found.meeting.sides, _PLACES):
            yield Encounter(first, second, meeting)


def _paced(option: Option, factor: float) -> Option | None:
    """An option at another speed; None where its speed is told, or it has none."""
    if factor == 1.0:
        return option
    told = option.role.actor.speed_mph is not None or option.motion.standing
    return None if told else replace(option, pacing=option.pacing._replace(factor=option.pacing.factor * factor))
