"""Coded narratives held against the rules' reading, field by field.

A line of a pool has a `text` and codes: `network`, `vehicles`, `events`. What is compared is the behavior that the
rules put on their layout, before any planning. Knows no simulation and no file format of roads.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from research.rows.numbered_rows import lanes_told
from sgcad_core.errors import Refused
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import Reading, read
from sgcad_core.reading.text.compass import COMPASS
from sgcad_core.records.specs import BehaviorSpec, Contact, RoadLayout
from sgcad_core.roads.layout import road_spec

FIELDS = (
    "drawn", "vehicles", "intersection", "lanes", "relative_heading", "maneuver", "first_pair", "first_sides",
    "first_thing", "later_events", "control",
)  # fmt: skip
_NO_THING = {"rollover", "jackknife", "noncollision", "ground", "fell_out", "own_trailer", "occupant", None}
_TERRAIN = {"curb", "ditch", "embankment"}
"""May be read as a thing or not; no part of the comparison."""
_TERRAIN_WORD = re.compile(r"\b(?:curb|ditch|culvert|embankment)s?$")
_LETTERS = {"pedestrian": "P", "bicycle": "BP", "nonmotorist": "PB", "animal": "AP"}
_SIDES = {"front", "back", "left", "right"}
_WORDS = {"P": "person", "B": "cyclist", "A": "animal"}
_THING_ID = re.compile(r"\b([A-UW-Z])\d+\b")
_AT_VEHICLE = re.compile(r"V\d+")
_FACTS = {
    "drawn": r"\b\B", "vehicles": r"vehicles\.V\d+\.kind", "intersection": r"junction\.|roads\.",
    "lanes": r"roads\..*(?:lanes|one_way|divided|median)|approaches\.", "relative_heading": r"vehicles\.V[12]\.heading",
    "maneuver": r"{actor}\.maneuver", "first_pair": r"contacts\.0\.", "first_sides": r"contacts\.0\.",
    "first_thing": r"contacts\.0\.|others\.", "later_events": r"contacts\.[1-9]|impacts\.",
    "control": r"junction\.control",
}  # fmt: skip
"""The facts that a field's value rests on."""
_STANDS = {"stopped", "parked"}
_TURNS = {"turn_left", "turn_right", "u_turn"}
_SHIFTS = {"left": {"lane_change_left", "crossing_centerline", "overtaking"}, "right": {"lane_change_right"}}
_OF_CODE = {
    "stopped": _STANDS, "parked": _STANDS, "turn_left": {"turn_left"}, "turn_right": {"turn_right"},
    "u_turn": {"u_turn", "turn_left"}, "backing": {"backing"},
    "lane_change_left": _SHIFTS["left"] | {"merge"}, "lane_change_right": _SHIFTS["right"] | {"merge"},
    "lane_change": _SHIFTS["left"] | _SHIFTS["right"] | {"merge"}, "crossing_centreline": _SHIFTS["left"],
}  # fmt: skip
"""Maneuvers that fit a code; codes that are not here are not judged or have a rule of their own."""


class Verdict(NamedTuple):
    """One field of a case: what is coded, what was read, whether they agree, and the rules that it rests on."""

    field: str
    want: str
    got: str
    right: bool
    rules: tuple[str, ...] = ()


@dataclass(frozen=True)
class Drawn:
    """What the rules make of a text; `behavior` is None where they refuse it."""

    reading: Reading
    layout: RoadLayout
    behavior: BehaviorSpec | None
    refusal: str = ""

    @property
    def contacts(self) -> Sequence[Contact]:
        """In the order in which they are to come about."""
        return self.behavior.contacts if self.behavior else ()

    def rules(self, field: str, actor: str = "") -> tuple[str, ...]:
        """The rules of the facts that a field rests on."""
        pattern = re.compile(_FACTS[field].replace("{actor}", actor))
        found = (f.rule for f in self.reading.facts if pattern.search(f.field))
        return tuple(dict.fromkeys(found))


def drawn(text: str) -> Drawn:
    """The rules' reading of a text on its layout."""
    return drawn_of(read(text))


def drawn_of(reading: Reading) -> Drawn:
    """A reading on its layout."""
    facts = reading.roads
    layout = layout_of_facts(facts)
    try:
        return Drawn(reading, layout, behavior_of_facts(facts.crash, road_spec(layout)))
    except Refused as refusal:
        return Drawn(reading, layout, None, str(refusal))


def verdicts(case: Mapping[str, Any], made: Drawn) -> list[Verdict]:
    """Every field that the codes state, held against the reading."""
    found = [_drawn(made), _vehicles(case, made)]
    found += [*_network(case["network"], made), *_maneuvers(case["vehicles"], made), *_events(case["events"], made)]
    return [v._replace(rules=v.rules or made.rules(v.field)) for v in found]


def _drawn(made: Drawn) -> Verdict:
    return Verdict("drawn", "drawn", made.refusal or "drawn", made.behavior is not None)


def _vehicles(case: Mapping[str, Any], made: Drawn) -> Verdict:
    want = sorted(v["id"] for v in case["vehicles"])
    got = sorted(a.id for a in made.behavior.actors if a.id.startswith("V")) if made.behavior else []
    return Verdict("vehicles", " ".join(want), " ".join(got), want == got)


# ------------------------------------------------------------------ roads
def _network(network: Mapping[str, Any], made: Drawn) -> Iterator[Verdict]:
    legs = made.layout.legs
    meets = len(legs) > 2 or bool(made.layout.accesses)
    if network["intersections"] is not None and network["told"]["intersection"]:
        want = network["intersections"] > 0
        yield Verdict("intersection", _yes(want), _yes(meets), want == meets)
    yield from (_lanes(road, made.layout) for road in network["roads"] if lanes_told(road))
    turn = network["relative_heading_v2_minus_v1"]
    if turn is not None:
        got = _relative(made)
        yield Verdict("relative_heading", str(turn), str(got), got == turn)
    kinds = {road["control"] for road in network["roads"] if road["told"]["control"]}
    if network["control"] in kinds & {"signal", "stop"}:
        have = {leg.control for leg in legs}
        yield Verdict("control", network["control"], " ".join(sorted(have)), network["control"] in have)


def _yes(junction: bool) -> str:
    return "junction" if junction else "no junction"


def _lanes(road: Mapping[str, Any], layout: RoadLayout) -> Verdict:
    ways = [(leg.lanes_in, leg.lanes_out) for leg in layout.legs]
    shown = f"{road['lanes_total']} {road['flow']}"
    return Verdict("lanes", shown, " ".join(map(str, sorted(_counts(road, ways)))), lanes_fit(road, ways))


def _counts(road: Mapping[str, Any], ways: Iterable[tuple[int, int]]) -> set[int]:
    both = road["lanes_scope"] == "both_directions"
    return {sum(way) for way in ways} if both else {n for way in ways for n in way if n}


def lanes_fit(road: Mapping[str, Any], ways: Iterable[tuple[int, int]]) -> bool:
    """Whether legs, each with its lanes in and out, have the coded number."""
    return bool(_counts(road, ways) & {road["lanes_total"], road["lanes_total"] - bool(road["twltl"])})


def _relative(made: Drawn) -> int | None:
    """How far clockwise the second vehicle's body is turned against the first one's, to 90 degrees."""
    bodies = [made.reading.crash.vehicle(v) for v in ("V1", "V2")]
    if made.behavior is None or any(v is None or v.heading is None for v in bodies):
        return None
    one, two = (COMPASS.index(v.heading) + 4 * (v.maneuver == "backing" and not v.faces) for v in bodies if v)
    return round((two - one) * 45 % 360 / 90) % 4 * 90


# ------------------------------------------------------------------ vehicles
def _maneuvers(coded: Iterable[Mapping[str, Any]], made: Drawn) -> Iterator[Verdict]:
    actors = {a.id: a for a in made.behavior.actors} if made.behavior else {}
    for vehicle in coded:
        want = vehicle["manoeuvre_resolved"]
        if not vehicle["told"] or not (want in _OF_CODE or want in ("straight", "negotiating_curve")):
            continue
        actor = actors.get(vehicle["id"])
        got = actor.maneuver if actor else "none"
        right = actor is not None and (got in _OF_CODE[want] if want in _OF_CODE else _goes_on(want, got))
        yield Verdict("maneuver", want, got, right, made.rules("maneuver", vehicle["id"]))


def _goes_on(want: str, got: str) -> bool:
    return got not in _STANDS | {"backing"} and (want != "straight" or got not in _TURNS)


# ------------------------------------------------------------------ events
def _told_events(events: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    return [e for e in events if e["kind"] == "collision" and e["other"] not in _NO_THING and e["other"] != e["actor"]]


def kept_events(events: Iterable[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """The contacts that are compared, in order."""
    return [e for e in _told_events(events) if e["other"] not in _TERRAIN]


def _events(events: Sequence[Mapping[str, Any]], made: Drawn) -> Iterator[Verdict]:
    told, kept = _told_events(events), kept_events(events)
    if not kept:
        return
    first, met = kept[0], _behind_terrain(told, made)
    contact = met[0] if met else None
    right = _fits(first, contact)
    pair = is_vehicle(first["other"])
    shown = " > ".join(f"{c.striker} {c.struck}" for c in met[:1]) or made.refusal[:60] or "none"
    want = f"{first['actor']} {first['other']}"
    yield Verdict("first_pair" if pair else "first_thing", want, shown, right)
    if {first["actor_area"], *([first["other_area"]] if pair else [])} <= _SIDES:
        yield _sides(first, contact if right else None, pair)
    if later := _later(kept):
        yield _in_order(later, met[right:])


def _behind_terrain(told: Sequence[Mapping[str, Any]], made: Drawn) -> list[Contact]:
    """The contacts behind those with terrain that is coded before the first thing, whether it was read or not."""
    words = {other.id: other.word for other in made.reading.crash.others}
    met = list(made.contacts)
    first = next(event for event in told if event["other"] not in _TERRAIN)
    for event in told[: told.index(first)]:
        if (
            met
            and _fits(event, met[0])
            and (_TERRAIN_WORD.search(words.get(met[0].struck, "")) or not _fits(first, met[0]))
        ):
            met = met[1:]
    return met


def is_vehicle(name: str) -> bool:
    """Whether what was met has a number."""
    return bool(_AT_VEHICLE.fullmatch(name))


def _fits(event: Mapping[str, Any], contact: Contact | None) -> bool:
    """Whether a contact is of the coded vehicle with the coded one or kind of thing."""
    pair = (contact.striker, contact.struck) if contact else ()
    if event["actor"] not in pair:
        return False
    other = next(x for x in pair if x != event["actor"])
    return other == event["other"] if is_vehicle(event["other"]) else other[0] in _LETTERS.get(event["other"], "OT")


def _sides(event: Mapping[str, Any], contact: Contact | None, pair: bool) -> Verdict:
    want = [event["actor_area"], event["other_area"]][: 1 + pair]
    areas = {contact.striker: contact.striker_area, contact.struck: contact.struck_area} if contact else {}
    other = next((area for who, area in areas.items() if who != event["actor"]), None)
    got = [areas.get(event["actor"]), other][: 1 + pair]
    return Verdict("first_sides", " ".join(want), " ".join(map(str, got)), got == want)


def _later(events: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """The events behind the first one; the same two once more are left out."""
    met = [{events[0]["actor"], events[0]["other"]}]
    later = []
    for event in events[1:]:
        if (pair := {event["actor"], event["other"]}) not in met:
            met.append(pair)
            later.append(event)
    return later


def _in_order(later: Sequence[Mapping[str, Any]], met: Sequence[Contact]) -> Verdict:
    at = count = 0
    for event in later:
        hit = next((i for i in range(at, len(met)) if _fits(event, met[i])), None)
        if hit is not None:
            at, count = hit + 1, count + 1
    want = ", ".join(f"{e['actor']} {e['other']}" for e in later)
    got = ", ".join(f"{c.striker} {c.struck}" for c in met)
    return Verdict("later_events", want, got or "none", count == len(later))


def kind_of(shown: str) -> str:
    """A value with kinds for the ids of things: contacts with one kind of actor look alike."""
    return _THING_ID.sub(lambda m: _WORDS.get(m[1], "thing"), shown)
