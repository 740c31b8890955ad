"""The doubt on a planned behavior as one number, and the reading of a report with the least doubt.

The checks are those of the validators `meeting` and `drivable`, and that the declared contact is the planned one; with
a stated loss of control odd driving is no doubt. Plans other readings in ordinary driving only: a reading that needs
force is no better than the first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from sgcad_core.case.records import Scenario, Trajectory
from sgcad_core.errors import InvalidOutput, Refused
from sgcad_core.execution.contact import avoided, closest_approach, first_contact, realised
from sgcad_core.execution.scenario import actor_infos
from sgcad_core.kinds import ACROSS_LANES
from sgcad_core.metrics.drivability import driving_peaks, first_touches
from sgcad_core.metrics.untold_places import untold_places
from sgcad_core.planner import plan
from sgcad_core.planner.encounter.meeting_place import TURNING
from sgcad_core.planner.maneuver_visible import TURNED_RAD
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.inference.hypotheses import ONWARD, Hypothesis, hypotheses
from sgcad_core.records.specs import BehaviorSpec, Maneuver, size_m
from sgcad_core.roads.lane_graph import LaneGraph

ODD_FROM = 0.5
"""Oddity (`Plan.oddity`) from which a contact is doubted, as the validator `meeting` has it."""
_UNMET, _OVER, _OUT = 10.0, 1.0, 1.0
_FORCED = 2.0
"""Doubt from which the untold heading of a parked vehicle, or of one from a driveway or the like, gives way. In two of
300 development reports it did, and both had been read wrongly; of vehicles on the road the first reading was right."""
_AWRY_RAD: dict[Maneuver, float] = {
    **dict.fromkeys(("straight", "slowing"), math.radians(30)),
    **dict.fromkeys(ACROSS_LANES, math.radians(45)),
}  # fmt: skip
"""Turn beyond which a maneuver along a road is not visible as such."""
MOST = 4
"""Largest number of other readings that are planned."""


class TriedReading(NamedTuple):
    """One planned reading: its difference in words, and its doubt."""

    words: str
    doubt: float


class LeastDoubted(NamedTuple):
    """The facts with the least doubt, their reading ("" the first), and all tried ones."""

    facts: CrashFacts
    words: str
    tried: tuple[TriedReading, ...]

    def notes(self) -> list[str]:
        """The tried readings, for result.json."""
        if not self.tried:
            return []
        first, *others = self.tried
        said = "; ".join(f"{one.words}: {one.doubt:.1f}" for one in others)
        kept = self.words or "the first reading"
        return [f"doubt {first.doubt:.1f} on the first reading; tried {said or 'no other'}; kept: {kept}"]


def doubt(behavior: BehaviorSpec, motions: Sequence[Trajectory], oddity: float) -> float:
    """0 where the declared pair meets, or of a near crash comes as near, as declared in ordinary driving; larger with
    every deviation."""
    sizes = {a.id: size_m(a) for a in behavior.actors}
    if behavior.contacts and not realised(behavior.contacts[0], first_contact(motions, sizes)):
        return _UNMET
    near = behavior.near_crash
    pair = (near.conflict.striker, near.conflict.struck) if near else ("", "")
    if near and not avoided(near, first_contact(motions, sizes), closest_approach(motions, sizes, pair)):
        return _UNMET
    return (oddity if oddity >= ODD_FROM else 0.0) + _OVER * _undrivable(behavior, motions)


def _undrivable(behavior: BehaviorSpec, motions: Sequence[Trajectory]) -> int:
    """Vehicles that leave the limits of driving before anything touches them."""
    sizes = {a.id: size_m(a) for a in behavior.actors}
    touches = first_touches(motions, sizes)
    count = 0
    for actor, track in zip(behavior.actors, motions, strict=True):
        if actor.record.wheeled:
            motion = driving_peaks(
                track, sizes[actor.id][0], touches.get(actor.id), backing=actor.maneuver == "backing"
            )
            count += bool(motion.excesses(behavior.surface))
    return count


def least_doubted(
    facts: CrashFacts,
    behave: Callable[[CrashFacts], BehaviorSpec],
    graph: LaneGraph,
    first: Scenario,
    may_be: Callable[[CrashFacts], bool] = lambda facts: True,
) -> LeastDoubted:
    """The first reading, or the cheapest of a few others that leaves no doubt; `first`: the planned scenario of the
    first, `may_be`: whether another reading is possible at all (e.g. does not contradict an edit by a person).

    Statements of the text give way only where the declared contact does not come about at all: on the development
    reports the other side of a corner and other headings resolved three doubts of seven, and each time the codes agreed
    with the first reading. Readings that would resolve a doubt are still noted. The untold heading of a vehicle that is
    parked or comes from beside the road gives way where the contact takes clearly odd driving. In a report without
    numbered actors the other side of a corner is also used where the first one hides a stated maneuver, in any report
    where the first one takes driving out of the lanes: the words fit both. In one without numbered actors the end of a
    corner (or the flank of a front corner along a told flank) is also used where the first one takes odd driving.
    """
    most = doubt(first.behavior, first.planned, first.oddity) if first.behavior else 0.0
    out = _out_of_lanes(first.behavior, first.planned, facts, graph) if first.behavior else 0
    most += _OUT * out
    if most <= 0.0:
        return LeastDoubted(facts, "", ())
    hidden = first.behavior is not None and _hides(first.behavior, first.planned)
    tried = [TriedReading("the first reading", most)]
    best: tuple[float, CrashFacts, str] = (most, facts, "")
    for other in [one for one in hypotheses(facts) if may_be(one.facts)][:MOST]:
        left = _left(other, behave, graph)
        if left is None:
            continue
        tried.append(TriedReading(other.words, left))
        gives_way = other.open or most >= _UNMET or (other.corner and hidden) or (other.either and out > 0)
        gives_way |= (other.heading and most >= _FORCED) or (other.eases and most >= ODD_FROM)
        if gives_way and left < ODD_FROM and left + other.price < best[0]:
            best = (left + other.price, other.facts, other.words)
        if left <= 0.0 and gives_way:
            break
    if best[0] >= _UNMET and (met := _by_force(facts, behave, graph)):
        best = (met[1], met[0].facts, met[0].words)
        tried.append(TriedReading(f"{met[0].words}, by force", met[1]))
    return LeastDoubted(best[1], best[2], tuple(tried))


def _by_force(
    facts: CrashFacts, behave: Callable[[CrashFacts], BehaviorSpec], graph: LaneGraph
) -> tuple[Hypothesis, float] | None:
    """A reading without slowing, for which the declared contact comes about at least in odd driving."""
    for other in hypotheses(facts):
        left = _left(other, behave, graph, by_force=True) if other.words.endswith(ONWARD) else None
        if left is not None and left < _UNMET:
            return other, left
    return None


def _hides(behavior: BehaviorSpec, motions: Sequence[Trajectory]) -> bool:
    """Whether one of the first pair, before its contact, turns in a straight maneuver, or hardly turns in a turn."""
    sizes = {a.id: size_m(a) for a in behavior.actors}
    touches = first_touches(motions, sizes)
    pair = {name for c in behavior.contacts[:1] for name in (c.striker, c.struck)}
    return any(
        _turned_otherwise(actor.maneuver, track, touches.get(actor.id))
        for actor, track in zip(behavior.actors, motions, strict=True)
        if actor.id in pair
    )


def _turned_otherwise(maneuver: Maneuver, track: Trajectory, touch: int | None) -> bool:
    """Whether a track turns otherwise than its maneuver before its first touch, a sample; None: all along."""
    heading = np.asarray(track.heading_rad)[: None if touch is None else touch + 1]
    turned = float(np.unwrap(heading)[-1] - heading[0]) if len(heading) else 0.0
    if maneuver in TURNING:
        return (-turned if maneuver == "turn_right" else turned) < TURNED_RAD
    return abs(turned) > _AWRY_RAD.get(maneuver, math.inf)


def _left(
    other: Hypothesis, behave: Callable[[CrashFacts], BehaviorSpec], graph: LaneGraph, *, by_force: bool = False
) -> float | None:
    """The doubt on another reading; None where it cannot be placed on the roads."""
    try:
        behavior = behave(other.facts)
        planned = plan(behavior, graph, by_force=by_force)
    except (InvalidOutput, Refused):
        return None
    out = _out_of_lanes(behavior, planned.trajectories, other.facts, graph)
    return doubt(behavior, planned.trajectories, planned.oddity) + _OUT * out


def _out_of_lanes(behavior: BehaviorSpec, motions: Sequence[Trajectory], facts: CrashFacts, graph: LaneGraph) -> int:
    """Vehicles that drive out of the lanes of their direction and are not told to, as the validator `places` has it."""
    return sum(1 for _ in untold_places(graph, motions, actor_infos(behavior), facts))
