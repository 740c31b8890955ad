"""A reading with a person's facts in place of those read, so that all its users follow them.

Writers by rules, validators and results then follow a person as they follow the text: a heading, a maneuver, a contact
counts as stated. What no reading holds (lanes of one leg, a start road) is laid over the specs later
(`sgcad_core.revision`). Knows no road network.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from sgcad_core.kinds import kind_of_letter
from sgcad_core.reading.actors.people_objects import OtherFacts
from sgcad_core.reading.contacts.contact_records import AREAS, ContactFacts
from sgcad_core.reading.contacts.near_crash import NearCrashFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.motion.absolute_headings import turned_vehicle
from sgcad_core.reading.reading_with_acts import crash_saying, saying
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.text.compass import between
from sgcad_core.records.acts import ACT_FIELDS, Acts, with_said
from sgcad_core.records.edits import Edit, by_person, canonical, effective, of_contacts, values
from sgcad_core.records.facts import Fact, Value
from sgcad_core.records.specs import Area

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading

_OF_READING = ("vehicles.", "others.", "contacts.", "conditions.", "junction.", "near_crash")
"""Beginnings of the fields that a reading holds too."""
_SETTLED = {
    "start_lane": ("lane", "lane_word"), "maneuver": ("meant_maneuver",), "from_rest": ("from_stop",),
    "evasion": ("evasion.brakes", "evasion.steers", "evasion.none"),
}  # fmt: skip
"""Field of an actor -> facts of the text that say no more once a person gave it."""
_SKY = ("light", "weather", "surface")
Given = Mapping[str, Value]


def with_edits(reading: Reading, edits: Sequence[Edit]) -> Reading:
    """The reading as a person has it; the same one without edits. Never raises: what does not fit is left out."""
    if not effective(edits):
        return reading
    given = values(edits)
    crash = _crash(reading.crash, given)
    roads = replace(_roads(reading.roads, given), crash=crash)
    made = replace(reading, crash=crash, roads=roads, facts=_facts(reading.facts, edits), edits=tuple(edits))
    return saying(made, _acts(crash, given))


def holds(crash: CrashFacts, edits: Sequence[Edit]) -> bool:
    """Whether nothing in a reading of the crash contradicts what people say."""
    return not edits or _crash(crash, values(edits)) == crash


def _facts(facts: Sequence[Fact], edits: Sequence[Edit]) -> tuple[Fact, ...]:
    """Facts with the person's; those of the text that these settle are gone."""
    here = [edit for edit in effective(edits) if edit.field.startswith(_OF_READING)]
    gone = {f"{head}.{name}" for edit in here for head, _, last in [edit.field.rpartition(".")]
            for name in _SETTLED.get(last, ())}  # fmt: skip
    kept = (f for f in facts if f.field not in gone and canonical(f.field) not in gone)
    return by_person(kept, here)


# ------------------------------------------------------------------ crash
def _crash(crash: CrashFacts, given: Given) -> CrashFacts:
    crash = _cast(crash, given)
    for name in [v.id for v in crash.vehicles]:
        crash = _with_vehicle(crash, name, {k: v for k, v in _of_actor(given, name).items() if k != "present"})
    others = tuple(replace(o, kind=_of_actor(given, o.id).get("kind", o.kind)) for o in crash.others)  # type: ignore[arg-type]
    crash = _contacts(replace(crash, others=others), given)
    sky: dict[str, Any] = {n: given[f"conditions.{n}"] for n in _SKY if f"conditions.{n}" in given}
    return crash_saying(replace(crash, **sky), _acts(crash, given))


def _of_actor(given: Given, name: str) -> dict[str, Value]:
    """The edited fields of an actor."""
    group = f"{'vehicles' if name.startswith('V') else 'others'}.{name}."
    return {field.removeprefix(group): value for field, value in given.items() if field.startswith(group)}


def _cast(crash: CrashFacts, given: Given) -> CrashFacts:
    """The crash with the added actors and without the removed ones."""
    for field, value in given.items():
        group, _, rest = field.partition(".")
        name, _, attribute = rest.partition(".")
        if group not in ("vehicles", "others") or attribute != "present":
            continue
        known = name in {v.id for v in crash.vehicles} | {o.id for o in crash.others}
        if value and not known and name.startswith("V"):
            crash = replace(crash, vehicles=(*crash.vehicles, VehicleFacts(name, kind_of_letter("V"))))
        elif value and not known and (name[0] in "PB" or given.get(f"{group}.{name}.kind")):
            kind: Any = given.get(f"{group}.{name}.kind") or kind_of_letter(name[0])
            crash = replace(crash, others=(*crash.others, OtherFacts(name, kind, str(kind))))
        elif not value and known:
            crash = _without(crash, name)
    return crash


def _without(crash: CrashFacts, name: str) -> CrashFacts:
    return replace(
        crash, vehicles=tuple(v for v in crash.vehicles if v.id != name),
        others=tuple(o for o in crash.others if o.id != name),
        contacts=tuple(c for c in crash.contacts if name not in (c.striker, c.struck)),
        impacts=tuple(i for i in crash.impacts if name not in (i.actor, i.other)),
        courses={who: told for who, told in crash.courses.items() if who != name},
    )  # fmt: skip


def _with_vehicle(crash: CrashFacts, name: str, fields: Mapping[str, Value]) -> CrashFacts:
    """One vehicle's edited fields; a heading turns all vehicles where all were only relative to one another."""
    known = crash.vehicle(name)
    if known is None or not fields:
        return crash
    changed = replace(known, **_update(known, fields))
    vehicles = tuple(changed if v.id == name else v for v in crash.vehicles)
    heading: Any = fields.get("heading")
    if heading is None:
        return replace(crash, vehicles=vehicles)
    if not crash.oriented and known.heading:
        turn = between(known.heading, heading)
        vehicles = tuple(v if v.id == name else turned_vehicle(v, turn) for v in vehicles)
    return replace(crash, vehicles=vehicles, oriented=True)


def _acts(crash: CrashFacts, given: Given) -> dict[str, Acts]:
    """What a person says of vehicles' acts, where it is possible together; a null leaves open what was read."""
    found = {}
    for v in crash.vehicles:
        fields = {field: value for field, value in _of_actor(given, v.id).items() if field in ACT_FIELDS}
        with suppress(ValidationError):
            if acts := with_said(None, fields):
                found[v.id] = acts
    return found


def _update(known: VehicleFacts, fields: Mapping[str, Value]) -> dict[str, Any]:
    update: dict[str, Any] = {k: fields[k] for k in ("kind", "speed_mph") if k in fields}
    if "heading" in fields:
        update |= {"heading": fields["heading"], "heading_stated": True, "exit_heading": None}
    if "maneuver" in fields and fields["maneuver"] != known.maneuver:
        update |= {"maneuver": fields["maneuver"], "meant": None, "from_stop": False, "exit_heading": None}
    if "maneuver" in fields:
        update |= {"maneuver_stated": True}
    if "start_lane" in fields:
        update |= {"lane": fields["start_lane"], "lane_word": None}
    return update


# ------------------------------------------------------------------ contacts
def _contacts(crash: CrashFacts, given: Given) -> CrashFacts:
    """Contacts as edited, numbered as a behavior has them: those of two vehicles, where there are any."""
    ids = {v.id for v in crash.vehicles}
    between_vehicles = [c for c in crash.contacts if {c.striker, c.struck} <= ids]
    met = list(between_vehicles or crash.contacts)
    known = ids | {o.id for o in crash.others}
    for number, fields in sorted(of_contacts(given).items()):
        if fields.get("present") is False:
            met[number : number + 1] = []
        elif number <= len(met) and (made := _contact(met[number] if number < len(met) else None, fields, known)):
            met[number : number + 1] = [made]
    beside = [c for c in crash.contacts if c not in met and not (between_vehicles and {c.striker, c.struck} <= ids)]
    told = any(field.startswith("contacts.") for field in given)
    gap = None if told and met and not (crash.gap and crash.gap.roads_too and not crash.vehicles) else crash.gap
    return replace(crash, contacts=(*met, *beside), near_crash=_near(crash, given, bool(met)), gap=gap)


def _near(crash: CrashFacts, given: Given, met: bool) -> NearCrashFacts | None:
    avoided = given.get("near_crash", crash.near_crash is not None)
    if not (avoided and met):
        return None
    near = crash.near_crash or NearCrashFacts()
    clearance: Any = given.get("near_crash.clearance_m", near.clearance_m)
    return replace(near, clearance_m=clearance, stated=near.stated or "near_crash" in given)


def _contact(known: ContactFacts | None, fields: Mapping[str, Value], ids: set[str]) -> ContactFacts | None:
    """A contact with the edited fields; naming one of both turned around turns their sides too."""
    said: dict[str, Any] = {k: v for k, v in fields.items() if k != "present"}
    start = known or ContactFacts("", "", "front", "front", False)
    if known and (said.get("striker") == known.struck or said.get("struck") == known.striker):
        start = replace(known, striker=known.struck, struck=known.striker,
                        striker_area=known.struck_area, struck_area=known.striker_area,
                        striker_may=known.struck_may, struck_may=known.striker_may)  # fmt: skip
    made = replace(start, **said, stated=True)
    if made.striker == made.struck or not {made.striker, made.struck} <= ids:
        return known
    for side in ("striker", "struck"):
        if f"{side}_area" in said:
            made = _may(made, side, (said[f"{side}_area"],))
        elif known is None or getattr(made, side) not in (known.striker, known.struck):
            made = _may(made, side, AREAS)
    return replace(made, areas_stated=len(made.striker_may) == len(made.struck_may) == 1)


def _may(contact: ContactFacts, side: str, areas: tuple[Area, ...]) -> ContactFacts:
    return replace(contact, striker_may=areas) if side == "striker" else replace(contact, struck_may=areas)


# ------------------------------------------------------------------ roads
def _roads(roads: RoadFacts, given: Given) -> RoadFacts:
    """The junction as a person has it: one that is named so can be drawn, whatever the text calls it."""
    junction, update = roads.junction, dict[str, Any]()
    if "junction.kind" in given:
        update = {"kind": given["junction.kind"], "stated": True, "unsupported": (), "offset": False}
        if given["junction.kind"] != junction.kind:
            update |= {"stem": None, "stem_stated": False}
        if given["junction.kind"] == "none":
            update |= {"control": "none", "stopped": ()}
    if "junction.stem" in given:
        update |= {"stem": given["junction.stem"], "stem_stated": True}
    if "junction.control" in given:
        update |= {"control": given["junction.control"]}
    taken = roads.taken - {"legs"} if {"junction.kind", "junction.stem"} & given.keys() else roads.taken
    return replace(roads, junction=replace(junction, **update), taken=taken) if update else roads
