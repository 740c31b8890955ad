"""The same encounter a little otherwise, where what follows from it is not what the report tells.

Free are, within what the report leaves open, the place at which the two touch on the sides that are told, and speeds
that nobody tells. Knows encounters and what a cost of the course is; no scene's inside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, zip_longest
from typing import NamedTuple

from sgcad_core.planner.encounter import Meeting, meet
from sgcad_core.planner.options import Option
from sgcad_core.planner.pairing import Encounter
from sgcad_core.planner.resting import IMPACTS, Impact
from sgcad_core.planner.scene import Scene


class Unfolded(NamedTuple):
    """All that follows from an encounter, with notes, the oddity of the approach, and how much told is missed."""

    scene: Scene
    notes: tuple[str, ...]
    oddity: float
    missed: float


Unfold = Callable[[Encounter | None, Sequence[Impact]], Unfolded]
"""Of an encounter, with the frictions and restitutions of the blow that are tried."""

_TOLD_PART = 1.0
"""What a missed part of the told course costs at least."""
_LEVERS = ((1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0))
"""How the blow is to turn each: off the centers of both boxes in all ways."""
_SPEEDS = ((1.2, 1.0), (1.0, 1.2), (0.8, 1.0), (1.0, 0.8), (1.2, 1.2), (0.8, 0.8))
"""Factors on speeds that nobody tells."""
_SAME_S = 0.02
_MOST = 4
"""Of such encounters are tried: each costs about as much as the first."""
_BETTER = 0.25
"""What another encounter must gain."""


def least_missed(found: Encounter | None, unfold: Unfold) -> Unfolded:
    """What follows from an encounter, or from one like it that leads nearer to what is told."""
    best = unfold(found, IMPACTS)
    if found is None:
        return best
    for other in islice(_like(found), _MOST):
        if best.missed < _TOLD_PART:
            break
        done = unfold(other, [(best.scene.friction, best.scene.restitution)])
        if done.missed < best.missed - _BETTER:
            best = done
    return best


def _like(found: Encounter) -> Iterator[Encounter]:
    """Elsewhere on the told sides and at other speeds, in turn."""
    for pair in zip_longest(_elsewhere(found), _at_speeds(found)):
        yield from (other for other in pair if other)


def _elsewhere(found: Encounter) -> Iterator[Encounter]:
    """Further to either end of the told sides."""
    tried = [found.meeting]
    for lever in _LEVERS:
        other = _met(found.first, found.second, found, lever)
        if other and not any(_alike(other.meeting, meeting) for meeting in tried):
            tried.append(other.meeting)
            yield other


def _at_speeds(found: Encounter) -> Iterator[Encounter]:
    """At other speeds, where none are told."""
    for speeds in _SPEEDS:
        options = [_paced(o, k) for o, k in zip((found.first, found.second), speeds, strict=True)]
        if options[0] and options[1] and (other := _met(options[0], options[1], found)):
            yield other


def _paced(option: Option, factor: float) -> Option | None:
    """An option at another speed; None where its speed is told, or it has none."""
    if factor == 1.0:
        return option
    told = option.role.actor.speed_mph is not None or option.motion.standing
    return None if told else replace(option, pacing=option.pacing._replace(factor=option.pacing.factor * factor))


def _met(first: Option, second: Option, found: Encounter, spins: tuple[float, float] | None = None) -> Encounter | None:
    """Two on the sides of an encounter; None where they do not come to touch so."""
    one, two = first.motion_with(second), second.motion_with(first)
    if not one.drivable or not two.drivable:
        return None
    turned = spins or (first.role.spins, second.role.spins)
    glances = first.role.glances and second.role.glances
    meeting = meet(one, two, found.meeting.sides, turned, glances=glances)
    return None if meeting is None else Encounter(first, second, meeting)


def _alike(one: Meeting, other: Meeting) -> bool:
    """Whether both come to touch at the same own times."""
    return abs(one.first_s - other.first_s) < _SAME_S and abs(one.second_s - other.second_s) < _SAME_S
