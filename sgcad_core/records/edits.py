"""Edits: facts of a crash given by a person, and which of several edits are effective.

Edits are a history: a later one of the same field takes the place of an earlier one, and one that says `AS_READ` gives
the field back to the reading. Knows which names mean the same field; no spec, no file.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime

from pydantic import AwareDatetime, Field

from sgcad_core.record_base import Record
from sgcad_core.records.facts import Fact, Value

AS_READ = "as_read"
"""The value of an edit that takes all earlier ones of its field back."""
RULE = "facts.yaml"
"""The `rule` of facts that a person gave."""
_NAMES = {
    "type": "kind", "lane": "start_lane", "road": "start_road", "direction": "start_direction", "exit": "exit_road",
    "speed": "speed_mph", "start_speed_mph": "speed_mph", "limit": "speed_limit_mph",
}  # fmt: skip
"""Shorter names, and those of written facts, of what an actor or a road has."""
_ACTORS = re.compile(r"(?:(?:actors|vehicles|others)\.)?([A-Za-z]\d+)(?:\.([\w.]+))?")


class Edit(Record):
    """A fact given by a person, which outranks every reader and writer."""

    field: str = Field(min_length=1, max_length=120)
    """A dotted name as result.json's facts have it, such as "roads.N.lanes_forward" (see `sgcad_core.revision`)."""
    value: Value
    who: str = Field("", max_length=120)
    when: AwareDatetime = Field(default_factory=lambda: datetime.now(UTC))
    why: str = Field("", max_length=1000)

    def line(self) -> str:
        """One line for people."""
        said = ", ".join(self.value) if isinstance(self.value, tuple) else self.value
        why = f": {self.why}" if self.why else ""
        return f"{self.field} = {said}  ({self.who or 'somebody'}, {self.when:%Y-%m-%d %H:%M}{why})"

    def fact(self) -> Fact:
        """It as a fact of the case."""
        told = {"field": self.field, "value": self.value, "basis": "person", "status": "stated"}
        return Fact.model_validate(told | {"rule": RULE, "confidence": 1.0})


def canonical(field: str) -> str:
    """A field's one name: actors under `vehicles` (V) or `others`, contacts[0] as contacts.0, short names in full."""
    name = re.sub(r"\[(\d+)\]", r".\1", field.strip())
    if actor := _ACTORS.fullmatch(name):
        group = "vehicles" if actor[1].upper().startswith("V") else "others"
        last = f".{_NAMES.get(actor[2], actor[2])}" if actor[2] else ""
        return f"{group}.{actor[1].upper()}{last}"
    head, _, last = name.rpartition(".")
    return f"{head}.{_NAMES.get(last, last)}" if head.startswith("roads.") else name


def effective(edits: Iterable[Edit]) -> tuple[Edit, ...]:
    """The last edit of every field, in the order in which the fields were first edited; none that was taken back."""
    last: dict[str, Edit] = {}
    for edit in edits:
        last[edit.field] = edit
    return tuple(edit for edit in last.values() if edit.value != AS_READ)


def values(edits: Iterable[Edit]) -> dict[str, Value]:
    """Field -> value of the effective edits."""
    return {edit.field: edit.value for edit in effective(edits)}


def of_contacts(given: Mapping[str, Value]) -> dict[int, dict[str, Value]]:
    """Of given fields those of contacts: number of the contact -> attribute -> value."""
    found: dict[int, dict[str, Value]] = {}
    for field, value in given.items():
        group, _, rest = field.partition(".")
        number, _, attribute = rest.partition(".")
        if group == "contacts" and number.isdigit():
            found.setdefault(int(number), {})[attribute] = value
    return found


def by_person(facts: Iterable[Fact], edits: Iterable[Edit]) -> tuple[Fact, ...]:
    """Facts with those that a person gave in the place of what was read or written; the others of them behind."""
    given = {edit.field: edit.fact() for edit in effective(edits)}
    found: list[Fact] = []
    for fact in facts:
        name = canonical(fact.field)
        if name not in given:
            found.append(fact)
        elif given[name] not in found:
            found.append(given[name])
    return (*found, *(fact for fact in given.values() if fact not in found))
