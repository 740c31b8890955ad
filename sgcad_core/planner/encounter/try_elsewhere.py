"""Variations of an encounter, where its consequences are not those that the report states.

Free are the place of the contact along the stated sides and speeds that are not stated. Knows encounters and the cost
of a course; not the inside of scenes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import chain, islice, zip_longest
from operator import itemgetter
from typing import NamedTuple

from sgcad_core.planner.actor_plan import comes_against
from sgcad_core.planner.aftermath.impact import IMPACTS, Impact
from sgcad_core.planner.encounter.blow_turns import misturned, turns_told
from sgcad_core.planner.encounter.encounter_search import along_sides
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.off_center import at_corner, beside_middle
from sgcad_core.planner.encounter.out_of_lanes import OUT
from sgcad_core.planner.encounter.pairing import Encounter, part_of
from sgcad_core.planner.scene import Scene
from sgcad_core.records.course import AT_IMPACT_M


class WholeCourse(NamedTuple):
    """All consequences of an encounter, with notes, the oddity of the approach, and the cost of missed statements."""

    scene: Scene
    notes: tuple[str, ...]
    oddity: float
    missed: float


Unfold = Callable[[Encounter | None, Sequence[Impact]], WholeCourse]
"""From an encounter and the impacts to try."""

_TOLD_PART = 1.0
"""Least cost of a missed part of the stated course."""
_SPEEDS = ((1.0, 1.0), (1.3, 0.75), (0.75, 1.3), (1.2, 1.2), (0.8, 0.8))
"""Factors on speeds that are not stated. Two equally fast vehicles would come to rest where they met, head on."""
_SPEEDS_AGAIN = ((0.6, 1.3), (1.3, 0.6), (0.45, 1.1), (1.1, 0.45))
"""Further ones where the two touch a second time: one then comes to rest where the other still goes on."""
_SPEEDS_SHORT = ((0.5, 0.5), (0.35, 0.35), (0.7, 0.7))
"""Those that are tried first where one of the two comes to rest at the place of the impact."""
_SPEEDS_ASIDE = ((0.5, 1.1), (1.1, 0.5))
"""The same where the side on which one of them comes to rest is told: the slower one hardly turns the other one's
way."""
_SPEEDS_HEAD_ON = ((1.0, 1.0), (0.85, 1.1), (1.1, 0.85), (0.7, 0.9), (0.9, 0.7), (0.7, 0.7))
"""Those of two fronts that come against each other: nothing untold makes one of them much faster."""
_PLACES = 5
"""Places along the stated sides, at each of the speeds."""
_MOST, _MOST_AGAIN = 12, 14
"""Encounters tried: each costs about as much as the first. More where the two touch a second time, since a tail hits
the other only for some places of the impact."""
_RANKED, _RANKED_AGAIN = 15, 30
"""Encounters of which those are tried first that turn the vehicles as told."""
_WORSE = 1.5
"""By which another place may be worse: less than a maneuver or a departure that does not show there."""
_BETTER = 0.25
"""Gain that another encounter must bring."""


def least_missed(found: Encounter | None, unfold: Unfold) -> WholeCourse:
    """The consequences of an encounter, or of a similar one that is nearer to the stated course."""
    if found is None:
        return unfold(found, IMPACTS)
    found, *beside = beside_middle(found) or [found]
    best = unfold(found, IMPACTS)
    again = bool(best.scene.again)
    usual = best.scene.impact
    others = chain(((other, usual) for other in beside), _like(found, usual, again=again))
    for other, impact in islice(others, _MOST_AGAIN if again else _MOST):
        if best.missed < _TOLD_PART:
            break
        done = unfold(other, IMPACTS if again else [impact])
        if done.missed < best.missed - _BETTER:
            best = done
    return best


def _like(found: Encounter, usual: Impact, *, again: bool) -> Iterator[tuple[Encounter, Impact]]:
    """Other places along the stated sides, at the given speeds and at others in turn, each with a friction and a
    restitution (`usual` first), those first that turn the vehicles as told; for a second contact (`again`) at the given
    speeds first."""
    at_speeds = [_along(found, speeds) for speeds in _speeds(found, again=again)]
    if again:
        yield from ((other, usual) for other in at_speeds.pop(0))
    others = (other for row in zip_longest(*at_speeds) for other in row if other)
    if not turns_told(found):
        yield from ((other, usual) for other in others)
        return
    impacts = tuple(dict.fromkeys((usual, *IMPACTS)))
    ranked = [(*misturned(other, impacts), other) for other in islice(others, _RANKED_AGAIN if again else _RANKED)]
    yield from ((other, impact) for _, impact, other in sorted(ranked, key=itemgetter(0)))


def _speeds(found: Encounter, *, again: bool) -> tuple[tuple[float, float], ...]:
    """Factors on the speeds of both, in the order in which they are tried."""
    if again:
        return (*_SPEEDS, *_SPEEDS_AGAIN)
    rests = [option.role.told.rest for option in (found.first, found.second)]
    if found.meeting.sides == ("front", "front") and comes_against(found.first.role):
        return _SPEEDS_HEAD_ON
    if any(rest.against or (rest.distance_m is not None and rest.distance_m <= AT_IMPACT_M) for rest in rests):
        return (*_SPEEDS_SHORT, *_SPEEDS)
    aside = any(rest.side is not None and rest.where == "off_road" for rest in rests)
    return (_SPEEDS[0], *_SPEEDS_ASIDE, *_SPEEDS[1:]) if aside else _SPEEDS


def _along(found: Encounter, factors: tuple[float, float]) -> Iterator[Encounter]:
    """Places all along the stated sides, at other speeds."""
    if factors != (1.0, 1.0) and not any(_may_vary(option) for option in (found.first, found.second)):
        return
    first, second = (_paced(o, k) for o, k in zip((found.first, found.second), factors, strict=True))
    one, two = first.motion_with(second), second.motion_with(first)
    parts = part_of(first.role), part_of(second.role)
    if one.drivable and two.drivable:
        for meeting in along_sides(one, two, found.meeting.sides, _PLACES, parts):
            if meeting.cost < min(OUT, found.meeting.cost + _WORSE):
                other = Encounter(first, second, meeting)
                if glancing := at_corner(other):
                    yield glancing
                    return
                yield other


def _may_vary(option: Option) -> bool:
    """Whether the speed of an option is free: it moves, and its speed is not stated."""
    return option.role.actor.speed_mph is None and not option.motion.standing


def _paced(option: Option, factor: float) -> Option:
    """An option at another speed; the same where its speed is stated or it stands."""
    if factor == 1.0 or not _may_vary(option):
        return option
    return replace(option, pacing=option.pacing._replace(factor=option.pacing.factor * factor))
