"""A reading of a numbered report with what a model's answer to the whole report knows better, field by field.

Rules and model make different errors: the rules miss wordings, the model's values are sometimes those of another
sentence. Where both agree that is the value. Where they differ, or the rules have none,
`sgcad_core.reading.second_reader.combiner` says how likely the model is right; its figures are fitted on reports that
are not scored (`research.benchmarks.texts.coded_fusion`, of fields that no code judges `.outside`). A road is
then laid out with the model's legs or lanes only if every actor can drive on it as read. Every value that is taken is a
fact of the basis "model".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, cast

from sgcad_core.kinds import DRIVEWAY, FOUR_LEG, RAMP, T
from sgcad_core.reading.actors.people_objects import OtherFacts
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.layout.answered_layout import carries, junction_of, legs_added, short_of_told
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts, uncounted
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.second_reader.answered_values import TakenValue, as_taken, controlled, facts_of, model_claims
from sgcad_core.reading.second_reader.combiner import FILLS, model_right, needed
from sgcad_core.reading.second_reader.field_claims import (
    Claim,
    Claims,
    kind_of,
    rules_claim,
    sayable,
    vehicles_of,
)
from sgcad_core.reading.second_reader.learned_support import support_of
from sgcad_core.reading.second_reader.numbered.fuse_numbered import moved
from sgcad_core.records.facts import Fact
from sgcad_core.records.specs import Area, Compass, RoadLayout

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading
    from sgcad_core.records.second_reader import Answered, Opinion, Weights

SURE = 0.9
"""How sure the model must be of each part of a contact that the rules cannot read."""
_ROAD = ("legs", "lanes", "turns", "curve")
"""Fields that a layout carries and no fact of a road holds."""
_KEPT = ("heading", "curve")
"""Fields of which a told value stays: of five told headings that the model replaced in 300 development reports none
became right, and three became wrong."""
_LEARNED = ("none", FOUR_LEG, T, DRIVEWAY, RAMP)
"""Kinds of junctions whose layouts the embedded model has learned; of a ramp without the lane in which one merges."""


def fused_with_answer(reading: Reading, opinion: Opinion) -> Reading:
    """The reading with what the model's answers to the whole report know better; as it is where they are of no use."""
    if opinion.answered is None or reading.crash.unnumbered or reading.crash.near_crash:
        return reading
    heard = sayable(model_claims(opinion.answered), reading.crash)
    gap = reading.crash.gap
    if gap is not None:
        reading = _filled(reading, opinion.answered, heard) if gap.unread else reading
        if reading.crash.gap is not None:
            return reading
    rules = rules_claim(reading)
    support = support_of(reading.crash, rules, heard, opinion.guesses)
    taken = fitting(decided(rules, heard, opinion.weights, opinion.takes, support), rules, heard)
    crash, used = _crash(reading.crash, taken)
    roads, laid = _roads(replace(reading.roads, crash=crash), taken, opinion.answered)
    if not (used | laid):
        return reading
    crash, seated = _seated(roads, taken, rules, heard, opinion.weights)
    taken |= seated
    used |= laid | seated.keys()
    facts = [fact for key in taken if key in used for fact in facts_of(key, taken[key], crash)]
    return _told(reading, crash, roads, facts)


def _seated(
    roads: RoadFacts, taken: Mapping[str, TakenValue], rules: Claims, heard: Claims, weights: Mapping[str, Weights]
) -> tuple[CrashFacts, dict[str, TakenValue]]:
    """The crash with the model's lanes on roads that its answer lays, and these lanes.

    A lane that no text tells is not the rules' there, even where both have the same: theirs followed from the number of
    lanes that they had assumed. Not of vehicles that the model has on another way.
    """
    found, weight = dict[str, TakenValue](), weights.get("lane")
    if weight is None:
        return roads.crash, found
    for v in roads.crash.vehicles:
        key, way = f"lane.{v.id}", heard.get(f"heading.{v.id}")
        rule, said = rules.get(key), heard.get(key)
        if key in taken or said is None or v.heading is None or (rule is not None and rule.told):
            continue
        if f"lanes.{axis_of(v.heading)}" not in roads.taken or (way is not None and way.value != v.heading):
            continue
        p = model_right(weight, said.p, 0.0, said.nats, said.told)
        if p >= FILLS:
            found[key] = as_taken(said, p)
    return replace(roads.crash, vehicles=tuple(_with_values(v, found) for v in roads.crash.vehicles)), found


def _told(reading: Reading, crash: CrashFacts, roads: RoadFacts, facts: Sequence[Fact]) -> Reading:
    """The reading with another crash on its roads; these facts are in the place of those of the same fields."""
    names = {fact.field for fact in facts}
    kept = tuple(fact for fact in reading.facts if fact.field not in names)
    return replace(reading, crash=crash, roads=replace(roads, crash=crash), facts=(*kept, *facts))


def decided(
    rules: Claims,
    model: Claims,
    weights: Mapping[str, Weights],
    takes: float,
    support: Mapping[str, float] = MappingProxyType({}),
) -> dict[str, TakenValue]:
    """The model's values that are taken: not those that both have, and none of a kind without weights; `support`: how
    much likelier than the rules' value the learned reader holds them."""
    found = {}
    for key, said in model.items():
        weight, rule = weights.get(kind_of(key)), rules.get(key)
        told = None if rule is None else rule.told
        kept = rule is not None and (agree(key, rule, said) or (bool(told) and kind_of(key) in _KEPT))
        if weight is None or kept:
            continue
        p = model_right(weight, said.p, told or 0.0, said.nats, said.told, learned=support.get(key, 0.0))
        if p >= needed(takes, told):
            found[key] = as_taken(said, p)
    return found


def fitting(taken: Mapping[str, TakenValue], rules: Claims, model: Claims) -> dict[str, TakenValue]:
    """Without lanes and ways out of vehicles that both readers have on other ways: they are of the model's way."""
    headings = {of: taken.get(f"heading.{of}", rules.get(f"heading.{of}")) for of in {*map(_whose, taken)}}
    elsewhere = {
        of
        for of, ours in headings.items()
        if ours is not None and (theirs := model.get(f"heading.{of}")) is not None and ours.value != theirs.value
    }
    return {
        key: one for key, one in taken.items() if kind_of(key) not in ("exit", "lane") or _whose(key) not in elsewhere
    }


def _whose(key: str) -> str:
    """ "V1" of "lane.V1"."""
    return key.partition(".")[2]


def same(key: str, one: Any, other: Any) -> bool:
    """Whether two values of a field are the same; a speed to one mph, since it is told in ranges and in km/h."""
    return abs(one - other) <= 1 if kind_of(key) == "speed" else bool(one == other)


def agree(key: str, rule: Claim, said: Claim) -> bool:
    """Whether the model's value is the rules' or one that what they read allows as well; lanes of the legs that both
    have."""
    if kind_of(key) in ("lanes", "turns"):
        ours, theirs = ({leg: rest for leg, *rest in claim.value} for claim in (rule, said))
        common = ours.keys() & theirs.keys()
        return bool(common) and all(ours[leg] == theirs[leg] for leg in common)
    return any(same(key, value, said.value) for value in (rule.value, *rule.also)) or bool({*rule.also} & {*said.also})


# ------------------------------------------------------------------ where the rules can read no crash
def _filled(reading: Reading, said: Answered, heard: Claims) -> Reading:
    """The reading with the model's whole crash, if the model is sure of the contact, its sides and both headings."""
    if not said.behavior.contacts or reading.roads.junction.kind not in _LEARNED:
        return reading
    first = said.behavior.contacts[0]
    sure = ("contact", "areas", *(f"heading.{id}" for id in (first.striker, first.struck) if id.startswith("V")))
    if any(key not in heard or heard[key].p < SURE for key in sure):
        return reading
    crash, known = reading.crash, {v.id: v for v in reading.crash.vehicles}
    vehicles = tuple(
        _with_values(known.get(actor.id) or VehicleFacts(actor.id, actor.kind), heard)
        for actor in said.behavior.actors
        if actor.id.startswith("V")
    )
    others = tuple(OtherFacts(a.id, a.kind, a.kind) for a in said.behavior.actors if not a.id.startswith("V"))
    contacts = tuple(
        ContactFacts(c.striker, c.struck, c.striker_area, c.struck_area, True) for c in said.behavior.contacts
    )
    crash = replace(crash, vehicles=vehicles, others=others, contacts=contacts, oriented=True, gap=None)
    facts = [fact for key in sure for fact in facts_of(key, as_taken(heard[key], heard[key].p), crash)]
    return _told(reading, crash, reading.roads, facts)


def _with_values(v: VehicleFacts, values: Mapping[str, Claim] | Mapping[str, TakenValue]) -> VehicleFacts:
    """A vehicle with the values that there are of it."""
    for name, change in _VEHICLE.items():
        if (one := values.get(f"{name}.{v.id}")) is not None:
            v = change(v, one.value)
    return v


# ------------------------------------------------------------------ motions and contacts
def _crash(crash: CrashFacts, taken: Mapping[str, TakenValue]) -> tuple[CrashFacts, set[str]]:
    """The crash with the values that fit into it, and their fields."""
    used = {key for v in crash.vehicles for name in _VEHICLE if (key := f"{name}.{v.id}") in taken}
    oriented = crash.oriented or any(kind_of(key) == "heading" for key in used)
    crash = replace(crash, vehicles=tuple(_with_values(v, taken) for v in crash.vehicles), oriented=oriented)
    for key in ("light", "weather", "surface"):
        if key in taken:
            crash = replace(crash, **{key: taken[key].value})
            used.add(key)
    met = _met(crash, taken)
    return (crash, used) if met is None else (replace(crash, contacts=met[0]), used | met[1])


def _met(crash: CrashFacts, taken: Mapping[str, TakenValue]) -> tuple[tuple[ContactFacts, ...], set[str]] | None:
    """The contacts with another first one, or with other sides of it."""
    if not crash.contacts or crash.gap:
        return None
    first, rest = crash.contacts[0], crash.contacts[1:]
    used = {key for key in ("contact", "areas") if key in taken}
    if "contact" in taken:
        pair = taken["contact"].value
        if not {*pair} <= vehicles_of(crash) or ("areas" not in taken and {*pair} != {first.striker, first.struck}):
            return None
        rest = tuple(c for c in crash.contacts if {c.striker, c.struck} != {*pair})
        sides = {first.striker: first.striker_area, first.struck: first.struck_area}
        first = replace(first, striker=pair[0], struck=pair[1], stated=True)
        if {*pair} == {*sides}:
            first = replace(first, striker_area=sides[pair[0]], struck_area=sides[pair[1]])
    if "areas" in taken:
        sides = cast("dict[str, Area]", dict(taken["areas"].value))
        if {*sides} != {first.striker, first.struck}:
            return None
        mine, theirs = sides[first.striker], sides[first.struck]
        first = replace(
            first, striker_area=mine, struck_area=theirs, areas_stated=True, striker_may=(mine,), struck_may=(theirs,)
        )
    return ((first, *rest), used) if used else None


_VEHICLE: Mapping[str, Callable[[VehicleFacts, Any], VehicleFacts]] = {
    "kind": lambda v, kind: replace(v, kind=kind),
    "maneuver": moved,
    "heading": lambda v, way: replace(v, heading=way, heading_stated=True),
    "exit": lambda v, way: replace(v, exit_heading=way),
    "lane": lambda v, lane: replace(v, lane=lane, lane_word=None),
    "speed": lambda v, mph: replace(v, speed_mph=mph),
}


# ------------------------------------------------------------------ roads
def _roads(facts: RoadFacts, taken: Mapping[str, TakenValue], said: Answered) -> tuple[RoadFacts, set[str]]:
    """The roads with the values that fit, and their fields."""
    if facts.junction.kind not in _LEARNED or facts.closed or facts.opening or facts.crash.gore:
        return facts, set()
    used, added = _laid(facts, {key for key in taken if kind_of(key) in _ROAD}, said.layout)
    if "legs" in used:
        facts = replace(facts, junction=junction_of(facts, said.layout))
    if "control" in taken:
        kind, stopped = controlled(taken["control"].value)
        facts = replace(facts, junction=replace(facts.junction, control=kind, stopped=stopped))
        used.add("control")
    for key in taken:
        name, _, axis = key.partition(".")
        if name in ("median", "limit") or (name == "lanes" and key in used):
            facts = _with_road(facts, cast("Compass", axis), _CHANGES[name], taken[key].value)
            used.add(key)
    laid = frozenset(key for key in used if kind_of(key) in _ROAD)
    return (replace(facts, answered=said.layout, taken=laid | added) if laid else facts), used


def _laid(facts: RoadFacts, keys: set[str], layout: RoadLayout) -> tuple[set[str], frozenset[str]]:
    """Which of these fields of the answered layout can be laid, and what comes with its legs."""
    if not keys:
        return set(), frozenset()
    ours = layout_of_facts(facts)
    short = short_of_told(facts, ours, layout)
    ramp = facts.junction.kind == RAMP
    keys = {key for key in keys if kind_of(key) not in ("lanes", "turns") or not (ramp or _whose(key) in short)}
    if keys and not carries(layout, facts.crash):
        return set(), frozenset()
    added = legs_added(ours, layout)
    if "legs" in keys:
        return keys, added
    return {key for key in keys if f"lanes.{_whose(key)}" not in added}, frozenset()


def _with_road(facts: RoadFacts, axis: Compass, change: Callable[[RoadFact, Any], RoadFact], value: Any) -> RoadFacts:
    """The facts with a change of the street on an axis; where none is told on it, with one."""
    known = any(road.axis == axis for road in facts.streets)
    roads = facts.roads if known else (*facts.roads, RoadFact(axis, "road", LaneFacts(), ()))
    streets = [road for road in roads if road.axis == axis and road in facts.streets] or [roads[-1]]
    return replace(facts, roads=tuple(change(road, value) if road is streets[0] else road for road in roads))


_CHANGES: Mapping[str, Callable[[RoadFact, Any], RoadFact]] = {
    "lanes": lambda road, _: uncounted(road),  # what the text seemed to count is not held against the network
    "median": lambda road, kind: replace(
        road, lanes=replace(road.lanes, median=None if kind == "none" else kind, divided=kind != "none")
    ),
    "limit": lambda road, mph: replace(road, speed_limit_mph=mph),
}
