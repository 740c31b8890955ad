"""Compares a scenario's behavior with what the narrative states.

Vehicles, initial headings, maneuvers, exits of turns and the first contact. What a sentence states is a question, since
the rules may have misread it; an inferred fact gives a note, and of a corner the side that the stated paths make likely
gives a doubt. A stated contact without an actor of that kind in the scenario is to be repaired. Reads no diagram.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import ClassVar, Literal

from plugins.validator._courses import SIDES, UNNUMBERED, approaches, course, heading, held
from plugins.validator._first_contact import contact_findings, stated_contact
from plugins.validator._near_crash import near_crash_findings
from plugins.validator._told import about, as_question
from sgcad_core.case.records import Evidence, Finding, Hold, RoadNetwork, Scenario
from sgcad_core.findings import FindingFactory
from sgcad_core.interfaces import Validator
from sgcad_core.reading.behavior.exit_assignment import goes_tail_first, square_rad
from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.layout.road_ways import Way, apart, degree, exits, turn_of, ways_of
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.text.compass import angle_of, compass_of_angle
from sgcad_core.records.specs import BehaviorSpec, Maneuver, RoadSpec

_finding = FindingFactory("behavior_narrative")

_FAR_RAD = math.radians(70)
"""A heading that is more than a compass eighth (and a bend) off."""
_HARDLY_RAD = math.radians(20)
"""A smaller change of heading is no turn; a turn onto a ramp has 28 degrees."""
_STILL: tuple[Maneuver, ...] = ("stopped", "parked")
_ALONG: tuple[Maneuver, ...] = ("straight", "slowing", "stopped", "negotiating_curve")
_TURNS: tuple[Maneuver, ...] = ("turn_left", "turn_right", "u_turn")
_DEEDS: tuple[Maneuver, ...] = (
    "lane_change_left", "lane_change_right", "merge", "overtaking", "crossing_centerline", "departing_road_left",
    "departing_road_right", "backing",
)  # fmt: skip
"""Maneuvers beside turns and stops that a sentence may state."""
_ALIKE: tuple[tuple[Maneuver, ...], ...] = (
    ("overtaking", "crossing_centerline", "lane_change_left"), ("merge", "lane_change_left"),
    ("merge", "lane_change_right"),
)  # fmt: skip
"""Maneuvers that one course may be called by."""
_SPEED_MPH = 5
"""As far as a range's middle, or km/h rounded, may be off."""
_Ways = Mapping[tuple[str, Literal["forward", "backward"]], Way]
"""Ways of a road spec by road and direction."""


class BehaviorNarrative(Validator):
    """Checks that a scenario's behavior has the vehicles, headings, maneuvers and first contact of the narrative."""

    stage: ClassVar[str] = "scenario"
    version: ClassVar[str] = "6"

    areas: Literal["question", "note"] = "question"
    """Severity if the text does not allow a declared side of contact."""
    maneuvers: Literal["question", "note"] = "question"
    """Severity if a stated turn, stop or straight course is missed."""
    every: bool = True
    """Also asks about other stated maneuvers (lane changes, a crossed center line, backing ...) and told speeds."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Contradictions, vehicles first; nothing for scenarios without a behavior or texts without vehicles."""
        if not isinstance(artifact, Scenario) or artifact.behavior is None:
            return []
        reading = evidence.report.reading
        if not reading.crash.vehicles:
            return []
        behavior = artifact.behavior
        found = list(_vehicles(behavior, reading))
        spec = evidence.network.spec if evidence.network else None
        if spec is not None:
            ways = {(w.road.id, w.direction): w for w in ways_of(spec)}
            found += [*_headings(behavior, reading, spec, ways), *_following(behavior, reading, spec, ways)]
            found += _exits(behavior, reading, spec, ways)
        deeds = list(_maneuvers(behavior, reading, spec, _differs if self.every else _contradicts))
        asked = self.maneuvers == "question"
        found += deeds if asked else [f.model_copy(update={"severity": "note"}) for f in deeds]
        found += _speeds(behavior, reading) if self.every else ()
        return [*found, *contact_findings(behavior, reading, self.areas), *near_crash_findings(behavior, reading)]


# ------------------------------------------------------------------ vehicles
def _vehicles(behavior: BehaviorSpec, reading: Reading) -> Iterator[Finding]:
    """Every vehicle of the report is an actor, and no other vehicle number is."""
    told = [v.id for v in reading.crash.vehicles]
    acting = [a.id for a in behavior.actors if a.id.startswith("V") or a.id in told]
    for v in reading.crash.vehicles:
        if v.id not in acting:
            named = " ".join(str(w) for w in (v.year, v.make, v.model) if w)
            found = _finding(f"the report's vehicle {v.id} is missing", "actors", ", ".join(acting) or "none",
                             f"add {v.id}{f', the {named}' if named else ''}", "doubt",
                             tuple(Hold(items="actors", at=i, either=({"id": (name,)},))
                                   for i, name in enumerate(told)))  # fmt: skip
            asked = as_question(found, reading, about(reading, f"vehicles.{v.id}"), v.id)
            yield asked if asked.told else found
    for name in acting:
        if name not in told:
            yield _finding("the report numbers no such vehicle", "actors", name,
                           f"keep to {', '.join(told)}; other road users are P, B or O", "doubt",
                           (_unnumbered(name, told, behavior),))  # fmt: skip


def _unnumbered(name: str, told: list[str], behavior: BehaviorSpec) -> Hold:
    """Behind the places of the numbered vehicles the actor gets another kind of id; before them, any known id."""
    at = next(i for i, actor in enumerate(behavior.actors) if actor.id == name)
    if at >= len(told):
        return Hold(items="actors", at=at, either=({"id": UNNUMBERED},))
    return Hold(items="actors", either=({"id": (*told, *UNNUMBERED)},))


# ------------------------------------------------------------------ headings
def _headings(behavior: BehaviorSpec, reading: Reading, spec: RoadSpec, ways: _Ways) -> Iterator[Finding]:
    for actor in behavior.actors:
        fact, way = reading.crash.vehicle(actor.id), ways.get((actor.road, actor.direction))
        if fact is None or way is None or fact.heading is None or not fact.heading_stated:
            continue
        wanted = angle_of(fact.heading) - square_rad(fact, way)
        along = (way.start_rad, way.end_rad, way.heading_rad)
        off = min(apart(h, wanted) for h in along)
        if fact.maneuver == "backing":  # it may face along its way or go along it backward
            off = min(off, *(apart(h, wanted + math.pi) for h in along))
        if off > _FAR_RAD:
            found = _finding(
                f"{actor.id} first travels {compass_of_angle(way.heading_rad)}, but the report says {fact.heading}",
                f"{actor.id}.road", compass_of_angle(way.heading_rad),
                _better_ways(wanted, tuple(ways.values()), spec),
                holds=courses(fact, spec),
            )  # fmt: skip
            yield as_question(found, reading, [f"vehicles.{actor.id}.heading"], fact.heading)


def _following(behavior: BehaviorSpec, reading: Reading, spec: RoadSpec, ways: _Ways) -> Iterator[Finding]:
    """In a stated rear-end crash of two vehicles that do not turn, both head the same way."""
    facts, told = reading.crash, stated_contact(reading.crash)
    if told is None or (told.striker_area, told.struck_area) != ("front", "back"):
        return
    if max(len(told.striker_may), len(told.struck_may)) > 2:  # a side that the text leaves open
        return
    acting = {actor.id: actor for actor in behavior.actors}
    pair = [(facts.vehicle(name), acting.get(name)) for name in (told.struck, told.striker)]
    both = [(v, a, ways.get((a.road, a.direction))) for v, a in pair if v is not None and a is not None]
    if len(both) < 2 or any(v.maneuver not in _ALONG or a.maneuver not in _ALONG for v, a, _ in both):
        return
    for (leader, _, way), (v, actor, own) in (both, both[::-1]):
        if v.heading_stated or way is None or own is None or apart(way.heading_rad, own.heading_rad) <= _FAR_RAD:
            continue
        other = leader.heading if leader.heading_stated else compass_of_angle(way.heading_rad)
        found = _finding(
            f"the front of {told.striker} meets the rear of {told.struck}, but they head different ways",
            f"{v.id}.road", f"{actor.road}, {actor.direction}",
            f"start {v.id} where {leader.id} starts, heading {other}",
            holds=courses(replace(v, heading=other, heading_stated=True), spec),
        )  # fmt: skip
        at = f"contacts.{facts.contacts.index(told)}"
        yield as_question(found, reading, [f"{at}.struck_area", f"{at}.striker_area"], f"a rear-end crash, {other}")
        return


def _better_ways(wanted: float, ways: tuple[Way, ...], spec: RoadSpec) -> str:
    """Ways in that direction, approaches to a junction first."""
    fitting = sorted(heading(ways, wanted), key=lambda w: -degree(w.to_node, spec))
    named = [f"{w.road.id} {w.direction}" for w in fitting[:4]]
    return f"start it on {' or '.join(named)}" if named else "start it on the road nearest to that direction"


# ------------------------------------------------------------------ maneuvers
def _maneuvers(
    behavior: BehaviorSpec, reading: Reading, spec: RoadSpec | None, differ: Callable[[Maneuver, Maneuver], bool]
) -> Iterator[Finding]:
    for actor in behavior.actors:
        fact = reading.crash.vehicle(actor.id)
        if fact is None or not fact.maneuver_stated or not differ(actor.maneuver, fact.maneuver):
            continue
        found = _finding(f"the report tells another maneuver of {actor.id}", f"{actor.id}.maneuver", actor.maneuver,
                         f"use {fact.maneuver}", holds=courses(fact, spec))  # fmt: skip
        yield as_question(found, reading, [f"vehicles.{actor.id}.maneuver"], fact.maneuver)


def _speeds(behavior: BehaviorSpec, reading: Reading) -> Iterator[Finding]:
    """A told speed that an actor lacks or that is far from its own."""
    for actor in behavior.actors:
        fact = reading.crash.vehicle(actor.id)
        if fact is None or fact.speed_mph is None or actor.maneuver in _STILL or not fact.speed_mph:
            continue
        if actor.speed_mph is None or abs(actor.speed_mph - fact.speed_mph) > _SPEED_MPH:
            said = "null" if actor.speed_mph is None else str(actor.speed_mph)
            found = _finding(f"the report tells a speed of {actor.id}", f"{actor.id}.speed_mph", said,
                             f"use {fact.speed_mph}")  # fmt: skip
            yield as_question(found, reading, [f"vehicles.{actor.id}.speed_mph"], fact.speed_mph)


def _exits(behavior: BehaviorSpec, reading: Reading, spec: RoadSpec, ways: _Ways) -> Iterator[Finding]:
    """A stated turn that goes straight on or to the other side at the end of its way; later turns are not judged."""
    every = tuple(ways.values())
    for actor in behavior.actors:
        fact, way = reading.crash.vehicle(actor.id), ways.get((actor.road, actor.direction))
        if fact is None or not fact.maneuver_stated or fact.maneuver != actor.maneuver or way is None:
            continue
        side = SIDES.get(actor.maneuver)
        taken = next((w for w in exits(way, every) if w.road.id == actor.exit_road), None)
        if side is None or taken is None or side * turn_of(way, taken) > _HARDLY_RAD:
            continue
        choices = [choice for choice in _choices(fact, spec) if choice.get("exit_road")]
        if not choices:  # the road as written has no such turn, whatever is asked again
            continue
        leaves = course(way, every, actor.maneuver)["exit_road"]
        found = _finding(
            f"{actor.id} would leave {actor.road} by {actor.exit_road}, which is no {actor.maneuver}",
            f"{actor.id}.exit_road", f"{actor.road} to {actor.exit_road}",
            f"leave by {' or '.join(leaves)}" if leaves else "start it on a road with that turn",
            holds=(held(actor.id, choices),),
        )  # fmt: skip
        yield as_question(found, reading, [f"vehicles.{actor.id}.maneuver"], fact.maneuver)


def courses(fact: VehicleFacts, spec: RoadSpec | None) -> tuple[Hold, ...]:
    """The starts, exits and maneuvers that a vehicle's stated heading and maneuver allow."""
    choices = _choices(fact, spec)
    return (held(fact.id, choices),) if choices != [{}] else ()


def _choices(fact: VehicleFacts, spec: RoadSpec | None) -> list[dict[str, tuple[str, ...]]]:
    """Those courses; [{}] if neither heading nor maneuver is stated."""
    does: dict[str, tuple[str, ...]] = {"maneuver": (fact.maneuver,)} if fact.maneuver_stated else {}
    every = ways_of(spec) if spec is not None else ()
    ways = every
    if fact.heading is not None and fact.heading_stated:
        told = angle_of(fact.heading)
        ways = heading(ways, told) + (heading(ways, told + math.pi) if goes_tail_first(fact) else ())
    ways = approaches(ways, spec) if spec is not None and fact.maneuver != "parked" else ways
    starts = [course(way, every, fact.maneuver) | does for way in ways]
    choices = [start for start in starts if start.get("exit_road") != ()]
    if not choices:  # the road as written has no such turn: what is left to hold is the start
        choices = [{k: v for k, v in start.items() if k != "exit_road"} for start in starts] or [does]
    return choices


def _differs(said: Maneuver, told: Maneuver) -> bool:
    """Whether it is another maneuver than stated, and not only another word for it."""
    if _contradicts(said, told):
        return True
    alike = any(said in words and told in words for words in _ALIKE)
    return said != told and told in _DEEDS and not alike


def _contradicts(said: Maneuver, told: Maneuver) -> bool:
    """Whether it is another turn than stated, standing instead of moving, or a turn although none is stated."""
    if told in _TURNS or said in _TURNS:
        return said != told
    if told in _STILL or said in _STILL:
        return (told in _STILL) != (said in _STILL) and "slowing" not in (said, told)
    return False
