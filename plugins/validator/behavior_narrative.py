"""Compares a scenario's behavior with what the narrative states.

Vehicles, initial headings, maneuvers, exits of turns and the first contact. Only what the text states is asked again;
an inferred fact gives a note, and of a corner the side that the stated paths make likely gives a doubt. Reads no
diagram.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import ClassVar, Literal

from plugins.validator._courses import SIDES, UNNUMBERED, approaches, course, heading, held
from plugins.validator._near_crash import near_crash_findings
from sgcad_core.case.records import Evidence, Finding, Hold, RoadNetwork, Scenario
from sgcad_core.findings import FindingFactory
from sgcad_core.interfaces import Validator
from sgcad_core.reading.behavior.exit_assignment import goes_tail_first, square_rad
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.layout.road_ways import Way, apart, degree, exits, turn_of, ways_of
from sgcad_core.reading.text.compass import angle_of, compass_of_angle
from sgcad_core.records.specs import Area, BehaviorSpec, Contact, Maneuver, RoadSpec

_finding = FindingFactory("behavior_narrative")

_FAR_RAD = math.radians(70)
"""A heading that is more than a compass eighth (and a bend) off."""
_HARDLY_RAD = math.radians(20)
"""A smaller change of heading is no turn; a turn onto a ramp has 28 degrees."""
_STILL: tuple[Maneuver, ...] = ("stopped", "parked")
_ALONG: tuple[Maneuver, ...] = ("straight", "slowing", "stopped", "negotiating_curve")
_TURNS: tuple[Maneuver, ...] = ("turn_left", "turn_right", "u_turn")
_Ways = Mapping[tuple[str, Literal["forward", "backward"]], Way]
"""Ways of a road spec by road and direction."""


class BehaviorNarrative(Validator):
    """Checks that a scenario's behavior has the vehicles, headings, maneuvers and first contact of the narrative."""

    stage: ClassVar[str] = "scenario"
    version: ClassVar[str] = "4"

    areas: Literal["repair", "note"] = "repair"
    """Severity if the text does not allow a declared side of contact."""
    maneuvers: Literal["repair", "note"] = "repair"
    """Severity if a stated turn, stop or straight course is missed."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Contradictions, vehicles first; nothing for scenarios without a behavior or texts without vehicles."""
        if not isinstance(artifact, Scenario) or artifact.behavior is None:
            return []
        facts = evidence.report.reading.crash
        if not facts.vehicles:
            return []
        behavior = artifact.behavior
        found = list(_vehicles(behavior, facts))
        spec = evidence.network.spec if evidence.network else None
        if spec is not None:
            ways = {(w.road.id, w.direction): w for w in ways_of(spec)}
            found += [*_headings(behavior, facts, spec, ways), *_following(behavior, facts, spec, ways)]
            found += _exits(behavior, facts, spec, ways)
        found += _maneuvers(behavior, facts, spec, self.maneuvers)
        return [*found, *_contact(behavior, facts, self.areas), *near_crash_findings(behavior, facts)]


# ------------------------------------------------------------------ vehicles
def _vehicles(behavior: BehaviorSpec, facts: CrashFacts) -> Iterator[Finding]:
    """Every vehicle of the report is an actor, and no other vehicle number is."""
    told = [v.id for v in facts.vehicles]
    acting = [a.id for a in behavior.actors if a.id.startswith("V") or a.id in told]
    for v in facts.vehicles:
        if v.id not in acting:
            named = " ".join(str(w) for w in (v.year, v.make, v.model) if w)
            yield _finding(f"the report's vehicle {v.id} is missing", "actors", ", ".join(acting) or "none",
                           f"add {v.id}{f', the {named}' if named else ''}",
                           holds=tuple(Hold(items="actors", at=i, either=({"id": (name,)},))
                                       for i, name in enumerate(told)))  # fmt: skip
    for name in acting:
        if name not in told:
            yield _finding("the report numbers no such vehicle", "actors", name,
                           f"keep to {', '.join(told)}; other road users are P, B or O",
                           holds=(_unnumbered(name, told, behavior),))  # fmt: skip


def _unnumbered(name: str, told: list[str], behavior: BehaviorSpec) -> Hold:
    """Behind the places of the numbered vehicles the actor gets another kind of id; before them, any known id."""
    at = next(i for i, actor in enumerate(behavior.actors) if actor.id == name)
    if at >= len(told):
        return Hold(items="actors", at=at, either=({"id": UNNUMBERED},))
    return Hold(items="actors", either=({"id": (*told, *UNNUMBERED)},))


# ------------------------------------------------------------------ headings
def _headings(behavior: BehaviorSpec, facts: CrashFacts, spec: RoadSpec, ways: _Ways) -> Iterator[Finding]:
    for actor in behavior.actors:
        fact, way = facts.vehicle(actor.id), ways.get((actor.road, actor.direction))
        if fact is None or way is None or fact.heading is None or not fact.heading_stated:
            continue
        wanted = angle_of(fact.heading) - square_rad(fact, way)
        along = (way.start_rad, way.end_rad, way.heading_rad)
        off = min(apart(h, wanted) for h in along)
        if goes_tail_first(fact):  # it may face along its way or go along it backward
            off = min(off, *(apart(h, wanted + math.pi) for h in along))
        if off > _FAR_RAD:
            yield _finding(
                f"{actor.id} first travels {compass_of_angle(way.heading_rad)}, but the report says {fact.heading}",
                f"{actor.id}.road", f"{actor.road}, {actor.direction}",
                _better_ways(wanted, tuple(ways.values()), spec),
                holds=courses(fact, spec),
            )  # fmt: skip


def _following(behavior: BehaviorSpec, facts: CrashFacts, spec: RoadSpec, ways: _Ways) -> Iterator[Finding]:
    """In a stated rear-end crash of two vehicles that do not turn, both head the same way."""
    told = _stated_contact(facts)
    if told is None or (told.striker_area, told.struck_area) != ("front", "back"):
        return
    if max(len(told.striker_may), len(told.struck_may)) > 2:  # a side that the text leaves open
        return
    acting = {actor.id: actor for actor in behavior.actors}
    pair = [(facts.vehicle(name), acting.get(name)) for name in (told.struck, told.striker)]
    found = [(v, a, ways.get((a.road, a.direction))) for v, a in pair if v is not None and a is not None]
    if len(found) < 2 or any(v.maneuver not in _ALONG or a.maneuver not in _ALONG for v, a, _ in found):
        return
    for (leader, _, way), (v, actor, own) in (found, found[::-1]):
        if v.heading_stated or way is None or own is None or apart(way.heading_rad, own.heading_rad) <= _FAR_RAD:
            continue
        other = leader.heading if leader.heading_stated else compass_of_angle(way.heading_rad)
        yield _finding(
            f"the front of {told.striker} meets the rear of {told.struck}, but they head different ways",
            f"{v.id}.road", f"{actor.road}, {actor.direction}",
            f"start {v.id} where {leader.id} starts, heading {other}",
            holds=courses(replace(v, heading=other, heading_stated=True), spec),
        )  # fmt: skip
        return


def _better_ways(wanted: float, ways: tuple[Way, ...], spec: RoadSpec) -> str:
    """Ways in that direction, approaches to a junction first."""
    fitting = sorted(heading(ways, wanted), key=lambda w: -degree(w.to_node, spec))
    named = [f"{w.road.id} {w.direction}" for w in fitting[:4]]
    return f"start it on {' or '.join(named)}" if named else "start it on the road nearest to that direction"


# ------------------------------------------------------------------ maneuvers
def _maneuvers(
    behavior: BehaviorSpec, facts: CrashFacts, spec: RoadSpec | None, severity: Literal["repair", "note"]
) -> Iterator[Finding]:
    for actor in behavior.actors:
        fact = facts.vehicle(actor.id)
        if fact is None or not fact.maneuver_stated or not _contradicts(actor.maneuver, fact.maneuver):
            continue
        yield _finding(f"the report tells another maneuver of {actor.id}", f"{actor.id}.maneuver", actor.maneuver,
                       f"use {fact.maneuver}", severity, courses(fact, spec))  # fmt: skip


def _exits(behavior: BehaviorSpec, facts: CrashFacts, spec: RoadSpec, ways: _Ways) -> Iterator[Finding]:
    """A stated turn that goes straight on or to the other side at the end of its way; later turns are not judged."""
    every = tuple(ways.values())
    for actor in behavior.actors:
        fact, way = facts.vehicle(actor.id), ways.get((actor.road, actor.direction))
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
        yield _finding(
            f"{actor.id} would leave {actor.road} by {actor.exit_road}, which is no {actor.maneuver}",
            f"{actor.id}.exit_road", f"{actor.road} to {actor.exit_road}",
            f"leave by {' or '.join(leaves)}" if leaves else "start it on a road with that turn",
            holds=(held(actor.id, choices),),
        )  # fmt: skip


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


def _contradicts(said: Maneuver, told: Maneuver) -> bool:
    """Whether it is another turn than stated, standing instead of moving, or a turn although none is stated."""
    if told in _TURNS or said in _TURNS:
        return said != told
    if told in _STILL or said in _STILL:
        return (told in _STILL) != (said in _STILL) and "slowing" not in (said, told)
    return False


# ------------------------------------------------------------------ contact
def _contact(behavior: BehaviorSpec, facts: CrashFacts, severity: Literal["repair", "note"]) -> Iterator[Finding]:
    told = _stated_contact(facts)
    if told is None or not _acted(told, behavior):
        return
    said = behavior.contacts[0] if behavior.contacts else None
    if said is None:
        yield _finding("the report tells a contact, but none is declared", "contacts", "", _declare(told),
                       holds=_first(told))  # fmt: skip
    elif {said.striker, said.struck} != {told.striker, told.struck}:
        yield _finding(f"the report's first contact is between {told.striker} and {told.struck}", "contacts[0]",
                       f"{said.striker} and {said.struck}", _declare(told), holds=_first(told))  # fmt: skip
    elif _sides(said) != _sides(told):
        allowed = all(side in _allowed(told)[name] for name, side in _sides(said).items())
        doubted = allowed and severity == "repair" and _cornered(said, told) and _moves_as_told(told, behavior, facts)
        yield _finding("the report tells other sides of the first contact", "contacts[0]", _described(said),
                       _declare(told), "doubt" if doubted else "note" if allowed else severity,
                       _first(told, doubted))  # fmt: skip


def _stated_contact(facts: CrashFacts) -> ContactFacts | None:
    """The first contact that the text states; None for a near crash."""
    return None if facts.near_crash else next((c for c in facts.contacts if c.stated), None)


def _cornered(said: Contact, told: ContactFacts) -> bool:
    """Whether every side that differs is one of the two sides of a stated corner."""
    sides = _sides(told)
    return all(len(_allowed(told)[name]) == 2 for name, side in _sides(said).items() if side != sides[name])


def _moves_as_told(told: ContactFacts, behavior: BehaviorSpec, facts: CrashFacts) -> bool:
    """Whether both vehicles move as stated: the side of a corner that was hit follows from that."""
    does = {actor.id: actor.maneuver for actor in behavior.actors}
    known = {name: facts.vehicle(name) for name in (told.striker, told.struck)}
    return all(v is not None and v.heading_stated and does[name] == v.maneuver for name, v in known.items())


def _first(told: ContactFacts, decided: bool = False) -> tuple[Hold, ...]:
    """The first contact with the sides that the text allows; `decided`: of a corner the side that the paths suggest."""
    sides: dict[str, tuple[Area, ...]] = {"striker_area": told.striker_may, "struck_area": told.struck_may}
    if decided:
        likely: dict[str, Area] = {"striker_area": told.striker_area, "struck_area": told.struck_area}
        sides = {key: (likely[key],) if len(may) == 2 else may for key, may in sides.items()}
    pair = {"striker": (told.striker,), "struck": (told.struck,)}
    return (Hold(items="contacts", at=0, either=(pair | sides,)),)


def _allowed(told: ContactFacts) -> dict[str, tuple[Area, ...]]:
    """Sides of each vehicle that the text allows: "left front" may be either."""
    return {told.striker: told.striker_may, told.struck: told.struck_may}


def _acted(told: ContactFacts, behavior: BehaviorSpec) -> bool:
    return {told.striker, told.struck} <= {a.id for a in behavior.actors}


def _sides(contact: Contact | ContactFacts) -> dict[str, str]:
    return {contact.striker: contact.striker_area, contact.struck: contact.struck_area}


def _described(contact: Contact | ContactFacts) -> str:
    return f"{contact.striker_area} of {contact.striker}, {contact.struck_area} of {contact.struck}"


def _declare(told: ContactFacts) -> str:
    return f"declare striker {told.striker}, struck {told.struck}: {_described(told)}"
