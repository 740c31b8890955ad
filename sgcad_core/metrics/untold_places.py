"""Which vehicles drive off the lanes of their direction before the contact, and are not told to.

Compares where a motion drives (`lane_places`) with what a report tells of the vehicle: a maneuver that leaves the lane,
a swerve, a loss of control, a start from beside the road. Knows the reading; no validator and no file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.case.records import ActorInfo, Trajectory, sizes_of
from sgcad_core.kinds import Maneuver, actor_kind
from sgcad_core.metrics.drivability import STEP_S, first_touches
from sgcad_core.metrics.labels.observed_crash import BEFORE_S
from sgcad_core.metrics.lane_places import PLACES, Place, lane_steps
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.records.course import CourseTold
from sgcad_core.roads.lane_graph import LaneGraph

MOST_S = 0.5
"""Time off its lanes that costs nothing: less is a corner that is cut, or the last instants before the contact."""
_OUTSIDE: tuple[Place, ...] = ("opposing", "off", "beside")
_ALLOWED: Mapping[Maneuver, tuple[Place, ...]] = {
    "crossing_centerline": _OUTSIDE, "departing_road_left": _OUTSIDE, "departing_road_right": ("off", "beside"),
    "overtaking": ("opposing",), "u_turn": _OUTSIDE, "parked": _OUTSIDE, "backing": _OUTSIDE,
}  # fmt: skip
"""Places out of its lanes that a maneuver tells. A vehicle that backs faces against its way; one that is parked may
face any way."""
_SHOULDER: tuple[Place, ...] = ("off", "beside")
_OTHER_ORIGIN: tuple[Place, ...] = ("beside",)
"""The same of where it comes from: a shoulder, or a road or place that joins."""
WORDS: Mapping[Place, str] = {"opposing": "on the wrong side of the road", "off": "off the lanes",
                              "beside": "beside the lanes for cars"}  # fmt: skip


class Untold(NamedTuple):
    """A vehicle that is off the lanes of its direction: where most of that time, how long, whether it starts there, and
    the sample of its first contact (None: there is none)."""

    actor: str
    place: Place
    seconds: float
    starts: bool
    until: int | None = None

    def words(self) -> str:
        """For people: "2.4 s on the wrong side of the road before its contact"."""
        return f"{self.seconds:.1f} s {WORDS[self.place]} before its contact"


def untold_places(
    graph: LaneGraph, motions: Sequence[Trajectory], actors: Sequence[ActorInfo], facts: CrashFacts, lost: bool = False
) -> Iterator[Untold]:
    """One for each such vehicle, in the order of the motions; only what has wheels and drives in lanes is judged.

    `lost`: the report tells a loss of control, of whichever vehicle.
    """
    infos = {actor.id: actor for actor in actors}
    touches = first_touches(motions, sizes_of(actors))
    ends = min(touches.values(), default=None)
    for motion in motions:
        info = infos.get(motion.actor)
        if info is None or not judged(info):
            continue
        until = touches.get(motion.actor, ends)
        codes = lane_steps(graph, motion.pose[:until]).codes
        found = _counted(codes, info, allowed(info, facts, lost))
        if found is not None:
            yield found._replace(until=until)


def judged(actor: ActorInfo) -> bool:
    """Whether an actor has to keep to lanes: people, animals, things, trailers and bicycles do not."""
    record = actor_kind(actor.type)
    return record.wheeled and not (record.keeps_right or record.pulled)


def _counted(codes: NDArray[np.int_], actor: ActorInfo, told: tuple[frozenset[Place], ...]) -> Untold | None:
    """The untold time off its lanes, from the codes of the places up to its contact; None where it is short."""
    if not len(codes):
        return None
    early, late = told
    bad = _codes(set(_OUTSIDE) - set(early))
    counted = np.isin(codes, bad)
    recent = round(BEFORE_S / STEP_S)
    counted[-recent:] &= np.isin(codes[-recent:], _codes(set(_OUTSIDE) - set(late)))
    seconds = float(counted.sum()) * STEP_S
    if seconds <= MOST_S:
        return None
    most = int(np.bincount(codes[counted]).argmax())
    return Untold(actor.id, PLACES[most], round(seconds, 2), bool(counted[0]))


def _codes(places: set[Place]) -> list[int]:
    return [PLACES.index(place) for place in places]


# ------------------------------------------------------------------ what is told
def allowed(actor: ActorInfo, facts: CrashFacts, lost: bool) -> tuple[frozenset[Place], frozenset[Place]]:
    """Places out of its lanes in which the report has a vehicle: all the way to its contact, and in the last seconds
    before it."""
    if _loses_control(actor.id, facts, lost):
        return frozenset(_OUTSIDE), frozenset(_OUTSIDE)
    course = facts.driven.get(actor.id, CourseTold())
    if course.departs or course.moves:
        return frozenset(_OUTSIDE), frozenset(_OUTSIDE)
    vehicle = facts.vehicle(actor.id)
    told = set(_ALLOWED.get(actor.maneuver, ()))
    told |= set(_ALLOWED.get(vehicle.maneuver, ()) if vehicle else ())
    if vehicle and vehicle.origin:
        told |= set(_SHOULDER if vehicle.origin == "shoulder" else _OTHER_ORIGIN)
    told |= {"off", "beside"} if actor.id in facts.gore else set()
    late = set(told)
    if _steers(actor.id, facts):
        late |= set(_OUTSIDE)
    if _meets_thing(actor.id, facts):
        late |= {"off", "beside"}
    return frozenset(told), frozenset(late)


def _loses_control(actor: str, facts: CrashFacts, lost: bool) -> bool:
    """Whether a loss of control is told of this vehicle, or of none in particular."""
    named = {who for who, course in facts.courses.items() if course.lost_control}
    return actor in named if named else lost


def _steers(actor: str, facts: CrashFacts) -> bool:
    """Whether it is told to steer aside before its contact, or before the conflict of a near crash."""
    near = facts.near_crash.evasions if facts.near_crash else ()
    avoids = any(who == actor and "steering" in how for who, how in near)
    return avoids or bool(facts.courses.get(actor, CourseTold()).steers)


def _meets_thing(actor: str, facts: CrashFacts) -> bool:
    """Whether it strikes a thing first, which stands beside the road."""
    first = facts.first_contact(actor)
    early = any(impact.actor == actor and impact.before for impact in facts.impacts)
    return early or (first is not None and not first.struck.startswith("V"))
