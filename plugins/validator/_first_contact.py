"""Compares the first contact that a scenario declares with the one that the narrative states.

The pair that touches and its sides are a question where a sentence states them. That a stated contact is declared at
all, with an actor of that kind, is no matter of reading: without it the case would be a false success.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from plugins.validator._told import as_question, quoted
from sgcad_core.case.records import Finding, Hold
from sgcad_core.findings import FindingFactory
from sgcad_core.kinds import UNNUMBERED
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.reading import Reading
from sgcad_core.records.specs import Area, BehaviorSpec, Contact

_finding = FindingFactory("behavior_narrative", where="contacts[0]")
_KINDS = {
    "V": "vehicle",
    UNNUMBERED: "vehicle",
    "T": "vehicle",
    "P": "person",
    "B": "person",
    "A": "animal",
    "O": "thing",
}
"""By the letter of an id."""


def stated_contact(facts: CrashFacts) -> ContactFacts | None:
    """The first contact that the text states; None for a near crash."""
    return None if facts.near_crash else next((c for c in facts.contacts if c.stated), None)


def contact_findings(
    behavior: BehaviorSpec, reading: Reading, severity: Literal["question", "note"]
) -> Iterator[Finding]:
    """At most one finding; `severity`: of sides that the text does not allow."""
    told = stated_contact(reading.crash)
    if told is None:
        return
    said = next(iter(_behind_things(behavior, reading.crash)), None)
    if said is None:
        if behavior.near_crash is None:  # else `near_crash_findings` says so
            found = _finding("the report tells a contact, but none is declared", "contacts", "", _declare(told),
                             holds=(*_first(told), *_acting(behavior, told, reading)))  # fmt: skip
            yield quoted(found, reading, [f"{_at(reading, told)}.{role}" for role in ("striker", "struck")])
    elif _pair(said) != _pair(told):
        yield _other_pair(behavior, said, told, reading)
    elif _sides(said) != _sides(told):
        yield _other_sides(behavior, said, told, reading, severity)


def _behind_things(behavior: BehaviorSpec, facts: CrashFacts) -> tuple[Contact, ...]:
    """The contacts without those with things that the report tells before the first one of two vehicles."""
    early = {impact.actor for impact in facts.impacts if impact.before}
    met = behavior.contacts
    while len(met) > 1 and met[0].striker in early and not met[0].struck.startswith("V"):
        met = met[1:]
    return met


def _other_pair(behavior: BehaviorSpec, said: Contact, told: ContactFacts, reading: Reading) -> Finding:
    """A question where the told pair meets later or the declared one is of the same kind; else to be repaired."""
    what = f"the report's first contact is between {told.striker} and {told.struck}"
    holds = (*_first(told), *_acting(behavior, told, reading))
    found = _finding(what, value=f"{said.striker} and {said.struck}", remedy=_declare(told), holds=holds)
    fields = [f"{_at(reading, told)}.{role}" for role in ("striker", "struck")]
    if _kinds(said) != _kinds(told) and all(_pair(c) != _pair(told) for c in behavior.contacts):
        return quoted(found, reading, fields)
    asked = as_question(found, reading, fields, f"{told.striker} and {told.struck}")
    return asked if asked.told else found.model_copy(update={"severity": "doubt"})


def _other_sides(
    behavior: BehaviorSpec, said: Contact, told: ContactFacts, reading: Reading, severity: Literal["question", "note"]
) -> Finding:
    allowed = all(side in _allowed(told)[name] for name, side in _sides(said).items())
    doubted = allowed and severity == "question" and _cornered(said, told) and _moves_as_told(told, behavior, reading)
    found = _finding("the report tells other sides of the first contact", value=_described(said),
                     remedy=_declare(told), severity="doubt" if doubted else "note",
                     holds=_first(told, doubted))  # fmt: skip
    if allowed or severity == "note":
        return found
    at = _at(reading, told)
    fields = [f"{at}.{role}" for role in ("striker_area", "struck_area", "striker")]
    return as_question(found, reading, fields, _described(told))


def _at(reading: Reading, told: ContactFacts) -> str:
    return f"contacts.{reading.crash.contacts.index(told)}"


def _pair(contact: Contact | ContactFacts) -> set[str]:
    return {contact.striker, contact.struck}


def _kinds(contact: Contact | ContactFacts) -> list[str]:
    return sorted(_KINDS.get(name[:1], "thing") for name in (contact.striker, contact.struck))


def _cornered(said: Contact, told: ContactFacts) -> bool:
    """Whether every side that differs is one of the two sides of a stated corner."""
    sides = _sides(told)
    return all(len(_allowed(told)[name]) == 2 for name, side in _sides(said).items() if side != sides[name])


def _moves_as_told(told: ContactFacts, behavior: BehaviorSpec, reading: Reading) -> bool:
    """Whether both vehicles move as stated: the side of a corner that was hit follows from that."""
    does = {actor.id: actor.maneuver for actor in behavior.actors}
    known = {name: reading.crash.vehicle(name) for name in (told.striker, told.struck)}
    return all(v is not None and v.heading_stated and does.get(name) == v.maneuver for name, v in known.items())


def _first(told: ContactFacts, decided: bool = False) -> tuple[Hold, ...]:
    """The first contact with the sides that the text allows; `decided`: of a corner the side that the paths suggest."""
    sides: dict[str, tuple[Area, ...]] = {"striker_area": told.striker_may, "struck_area": told.struck_may}
    if decided:
        likely: dict[str, Area] = {"striker_area": told.striker_area, "struck_area": told.struck_area}
        sides = {key: (likely[key],) if len(may) == 2 else may for key, may in sides.items()}
    pair = {"striker": (told.striker,), "struck": (told.struck,)}
    return (Hold(items="contacts", at=0, either=(pair | sides,)),)


def _acting(behavior: BehaviorSpec, told: ContactFacts, reading: Reading) -> Iterator[Hold]:
    """Each of the pair that is no actor yet, at its place among those of the report."""
    every = [v.id for v in reading.crash.vehicles] + [other.id for other in reading.crash.others]
    for name in sorted({told.striker, told.struck} - {actor.id for actor in behavior.actors}):
        if name in every:
            yield Hold(items="actors", at=every.index(name), either=({"id": (name,)},))


def _allowed(told: ContactFacts) -> dict[str, tuple[Area, ...]]:
    """Sides of each vehicle that the text allows: "left front" may be either."""
    return {told.striker: told.striker_may, told.struck: told.struck_may}


def _sides(contact: Contact | ContactFacts) -> dict[str, str]:
    return {contact.striker: contact.striker_area, contact.struck: contact.struck_area}


def _described(contact: Contact | ContactFacts) -> str:
    return f"{contact.striker_area} of {contact.striker}, {contact.struck_area} of {contact.struck}"


def _declare(told: ContactFacts) -> str:
    return f"declare striker {told.striker}, struck {told.struck}: {_described(told)}"
