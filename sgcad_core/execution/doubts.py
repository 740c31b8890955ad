"""What our own checks doubt in a planned behavior, as one number, and the reading that is doubted least.

The checks are those of the validators `meeting` and `drivable`, and that the declared contact is the planned one; where
a report tells a loss of control, odd driving is no doubt. Plans in ordinary driving only: a reading that needs force is
no better than the first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from sgcad_core.errors import InvalidOutput, Refused
from sgcad_core.execution.contact import first_contact, realised
from sgcad_core.metrics.driving import WHEELED, driven, first_touches
from sgcad_core.narrative.facts import CrashFacts
from sgcad_core.narrative.hypotheses import Hypothesis, hypotheses
from sgcad_core.planner import plan
from sgcad_core.records import Scenario, Trajectory
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.specs import BehaviorSpec, size_m

ODD_FROM = 0.5
"""Oddity (`Plan.oddity`) from which a contact is doubted, as the validator `meeting` has it."""
_UNMET, _OVER = 10.0, 1.0
MOST = 4
"""Other readings that are planned."""


class Tried(NamedTuple):
    """One reading that was planned: in what it differs, and what is left of the doubt."""

    words: str
    doubt: float


class Least(NamedTuple):
    """The facts that are doubted least, which reading they are ("" the first), and what was tried."""

    facts: CrashFacts
    words: str
    tried: tuple[Tried, ...]

    def notes(self) -> list[str]:
        """What was tried, for result.json."""
        if not self.tried:
            return []
        first, *others = self.tried
        said = "; ".join(f"{one.words}: {one.doubt:.1f}" for one in others)
        kept = self.words or "the first reading"
        return [f"doubt {first.doubt:.1f} on the first reading; tried {said or 'no other'}; kept: {kept}"]


def doubt(behavior: BehaviorSpec, motions: Sequence[Trajectory], oddity: float) -> float:
    """0 where the declared pair meets as declared in ordinary driving; the more the less that is so."""
    sizes = {a.id: size_m(a) for a in behavior.actors}
    if behavior.contacts and not realised(behavior.contacts[0], first_contact(motions, sizes)):
        return _UNMET
    return (oddity if oddity >= ODD_FROM else 0.0) + _OVER * _undrivable(behavior, motions)


def _undrivable(behavior: BehaviorSpec, motions: Sequence[Trajectory]) -> int:
    """Vehicles that leave the limits of driving before anything touches them."""
    sizes = {a.id: size_m(a) for a in behavior.actors}
    touches = first_touches(motions, sizes)
    count = 0
    for actor, track in zip(behavior.actors, motions, strict=True):
        if actor.kind in WHEELED:
            motion = driven(track, sizes[actor.id][0], touches.get(actor.id), backing=actor.maneuver == "backing")
            count += bool(motion.excesses(behavior.surface))
    return count


def least_doubted(
    facts: CrashFacts,
    behave: Callable[[CrashFacts], BehaviorSpec],
    graph: LaneGraph,
    first: Scenario,
    may_be: Callable[[CrashFacts], bool] = lambda facts: True,
) -> Least:
    """The first reading, or of a few others the cheapest that leaves no doubt; `first`: the first as it was planned,
    `may_be`: whether another reading is possible at all (none that contradicts a person is).

    What the text tells gives way only where the declared contact does not come about at all: on the development reports
    a corner's other side and other headings resolved three doubts of seven, and each time the codes had it as it was
    first read. What would resolve a doubt is told all the same.
    """
    most = doubt(first.behavior, first.planned, first.oddity) if first.behavior else 0.0
    if most <= 0.0:
        return Least(facts, "", ())
    tried = [Tried("the first reading", most)]
    best: tuple[float, CrashFacts, str] = (most, facts, "")
    for other in [one for one in hypotheses(facts) if may_be(one.facts)][:MOST]:
        left = _left(other, behave, graph)
        if left is None:
            continue
        tried.append(Tried(other.words, left))
        gives_way = other.open or most >= _UNMET
        if gives_way and left < ODD_FROM and left + other.price < best[0]:
            best = (left + other.price, other.facts, other.words)
        if left <= 0.0 and gives_way:
            break
    return Least(best[1], best[2], tuple(tried))


def _left(other: Hypothesis, behave: Callable[[CrashFacts], BehaviorSpec], graph: LaneGraph) -> float | None:
    """The doubt that another reading leaves; None where it cannot be placed on the roads."""
    try:
        behavior = behave(other.facts)
        planned = plan(behavior, graph, by_force=False)
    except (InvalidOutput, Refused):
        return None
    return doubt(behavior, planned.trajectories, planned.oddity)
