"""A second reader's opinion beside the rules', and which of both is taken, field by field.

Where both readers agree that is the answer. Where they differ, `sgcad_core.reading.second_reader.combiner` says how
likely the model's value is right, and it is taken from one half on. Where the rules have nothing it is taken from
`FILLS` on, below that nothing is said. Three figures a field, fitted on reports whose codes are known and which are
never scored (`python -m research.benchmarks.texts.fuse_weights`). Knows facts; no model.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, cast

from sgcad_core.kinds import ACTORS, FOUR_LEG, Maneuver
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.contacts.near_crash import NearCrashFacts
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.second_reader.combiner import FILLS, model_right
from sgcad_core.reading.second_reader.seven_question_gist import (
    FIELDS,
    SUBJECT,
    alike,
    areas,
    meeting,
    partner,
    rule_values,
)
from sgcad_core.records.facts import Fact
from sgcad_core.records.facts import Value as FactValue
from sgcad_core.records.second_reader import Opinion, Value
from sgcad_core.records.specs import Area

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading
    from sgcad_core.reading.second_reader.seven_question_gist import RuleValues

_PARTNER = "V2"
TURNS = ("turn_left", "turn_right", "u_turn")


class Decided(NamedTuple):
    """What is taken for a field: the value, how sure that is, and whether it is the model's against the rules'."""

    value: Value
    p: float
    changed: bool


def decide(opinion: Opinion, say: RuleValues) -> dict[str, Decided]:
    """The value of every field that a reader has one for."""
    found = {}
    for key in FIELDS:
        heard, weights = opinion.heard.get(key), opinion.weights.get(key)
        rule = say.values.get(key)
        if heard is None or weights is None:
            continue
        if rule is None:
            found[key] = Decided(heard.value, model_right(weights, heard.p, told=False), True)
        elif alike(rule, heard.value):
            found[key] = Decided(rule, heard.p if weights.agree is None else weights.agree, False)
        else:
            p = model_right(weights, heard.p, told=key in say.told)
            found[key] = Decided(heard.value, p, True) if p >= opinion.takes else Decided(rule, 1 - p, False)
    return found


# ------------------------------------------------------------------ taken over
def fused_with_gist(reading: Reading, opinion: Opinion) -> Reading:
    """The reading with what the second reader knows better; each change is a fact of the basis "model".

    Of numbered reports nothing is changed: the second reader is asked for the subject's first contact alone.
    """
    if not reading.crash.unnumbered:
        return reading
    decided = decide(opinion, rule_values(reading))
    crash, taken = with_contact(reading.crash, decided), []
    if crash is not reading.crash:
        taken = [_fact(key, decided[key]) for key in _NEEDED]
    for key, change in _CHANGES.items() if not taken else ():
        before, one = crash, decided.get(key)
        crash = change(crash, one) if one and one.changed else crash
        taken += [_fact(key, one)] if one and crash is not before else []
    junction, one = reading.roads.junction, decided.get("junction")
    if one and one.changed and one.value and junction.kind == "none":
        junction, taken = replace(junction, kind=FOUR_LEG), [*taken, _fact("junction", one)]
    roads = replace(reading.roads, crash=crash, junction=junction)
    return replace(reading, crash=crash, roads=roads, facts=(*reading.facts, *taken)) if taken else reading


def _fact(key: str, one: Decided) -> Fact:
    return model_fact(f"gist.{key}", one.value, one.p)


def model_fact(field: str, value: FactValue, p: float, told: bool = False, nats: float | None = None) -> Fact:
    """A value of the second reader's that is taken; `told`: it holds that the evidence tells it; `nats`: grounding."""
    return Fact(
        field=field, value=value, basis="model", status="stated" if told else "inferred", rule="second opinion",
        confidence=round(p, 3), nats=None if nats is None else round(nats, 3),
    )  # fmt: skip


def _touched(crash: CrashFacts, one: Decided) -> CrashFacts:
    if not meeting(crash):
        return crash
    return replace(crash, near_crash=None if one.value else NearCrashFacts())


def _subject(crash: CrashFacts, one: Decided) -> CrashFacts:
    return _moved(crash, SUBJECT, cast("Maneuver", one.value))


def _other(crash: CrashFacts, one: Decided) -> CrashFacts:
    contact = meeting(crash)
    return _moved(crash, partner(contact), cast("Maneuver", one.value)) if contact else crash


def _moved(crash: CrashFacts, id: str, maneuver: Maneuver) -> CrashFacts:
    """With another maneuver of a vehicle; where it was to turn to belongs to the maneuver before."""
    vehicle = crash.vehicle(id)
    if vehicle is None or maneuver == "other":
        return crash
    gone = {"exit_heading": None, "meant": None, "from_stop": False} if maneuver not in TURNS else {}
    changed = replace(vehicle, maneuver=maneuver, maneuver_stated=True, **gone)  # type: ignore[arg-type]
    return replace(crash, vehicles=tuple(changed if v is vehicle else v for v in crash.vehicles))


def _mine(crash: CrashFacts, one: Decided) -> CrashFacts:
    return _touching(crash, cast("Area", one.value), None)


def _theirs(crash: CrashFacts, one: Decided) -> CrashFacts:
    return _touching(crash, None, cast("Area", one.value))


def _touching(crash: CrashFacts, mine: Area | None, theirs: Area | None) -> CrashFacts:
    """With another side of one of both; the side is then the only one that the text allows."""
    contact = meeting(crash)
    if contact is None:
        return crash
    was = areas(contact)
    sides = mine or was[0], theirs or was[1]
    striker, struck = sides if contact.striker == SUBJECT else sides[::-1]
    may = {"striker_may": (striker,)} if (mine is None) != (contact.striker == SUBJECT) else {"struck_may": (struck,)}
    changed = replace(contact, striker_area=striker, struck_area=struck, **may)  # type: ignore[arg-type]
    return replace(crash, contacts=(changed, *crash.contacts[1:]))


_CHANGES: Mapping[str, Callable[[CrashFacts, Decided], CrashFacts]] = {
    "touched": _touched, "subject": _subject, "other": _other, "subject_area": _mine, "other_area": _theirs,
}  # fmt: skip
_NEEDED = (*_CHANGES, "met")


def with_contact(crash: CrashFacts, decided: Mapping[str, Decided]) -> CrashFacts:
    """A crash whose contact the rules cannot read, with the one that the second reader is sure of; else unchanged."""
    if not (crash.gap and crash.gap.unread) or not all(key in decided and decided[key].p >= FILLS for key in _NEEDED):
        return crash
    value = {key: decided[key].value for key in _NEEDED}
    met = ACTORS.get(str(value["met"]))
    if met is None or not met.motor or not crash.vehicles or crash.vehicles[0].id != SUBJECT:
        return crash
    them = next((v for v in crash.vehicles if v.id == _PARTNER), VehicleFacts(_PARTNER, met.id))
    me, them = (
        replace(v, maneuver=cast("Maneuver", value[key]), maneuver_stated=True)
        for v, key in ((crash.vehicles[0], "subject"), (them, "other"))
    )
    rest = tuple(v for v in crash.vehicles if v.id not in (SUBJECT, _PARTNER))
    contact = _contact(cast("Area", value["subject_area"]), cast("Area", value["other_area"]))
    near = None if value["touched"] else NearCrashFacts()
    return replace(crash, vehicles=(me, them, *rest), contacts=(contact,), near_crash=near, gap=None)


def _contact(mine: Area, theirs: Area) -> ContactFacts:
    """The striker is the one that touches with its front; of two fronts or none the other vehicle."""
    if mine == "front" and theirs != "front":
        return ContactFacts(SUBJECT, _PARTNER, mine, theirs, True)
    return ContactFacts(_PARTNER, SUBJECT, theirs, mine, True)
