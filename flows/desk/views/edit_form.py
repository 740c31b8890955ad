"""The editable fields of a case among its facts, each at its thing.

Made from the revision's list of fields, so that a new kind of field appears here without changes.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

from flows.desk.views.case_view import FactRow, Group, order_of, thing_of, title_of
from flows.desk.views.field_words import name_of, shown
from sgcad_core.records.edits import Edit, canonical
from sgcad_core.records.specs import Compass
from sgcad_core.revision import CaseField

PRESENT = ".present"
SEVERAL = 2
"""A finding that concerns more fields of a thing than this concerns the thing."""
Findings = Mapping[str, Sequence[str]]
"""Findings by field; under "" those of no field."""
_NEW = {"V": "vehicle", "P": "pedestrian", "B": "cyclist", "O": "object"}
"""Kinds of actors that can be added, by the letter of their ids."""


@dataclass(frozen=True)
class Addition:
    """One thing that can be added: its label and the edits that add it."""

    words: str
    edits: str


def groups_with(
    groups: Sequence[Group], fields: Sequence[CaseField], edits: Iterable[Edit], findings: Findings
) -> list[Group]:
    """The facts by thing, those that can be changed marked, and the editable fields without a fact."""
    known = {field.name: field for field in fields}
    given = {edit.field: edit for edit in edits}
    rows: dict[str, list[FactRow]] = {}
    seen: set[str] = set()
    for group in groups:
        for row in group.facts:
            name = canonical(row.field)
            field = known.get(name)
            if field is not None and name in seen:
                continue  # an older name of the same field
            seen.add(name)
            rows.setdefault(group.thing, []).append(_row(row, field, given.get(name), findings) if field else row)
    for field in fields:
        if field.name not in seen and not field.name.endswith(PRESENT):
            row = _row(_empty(field), field, given.get(field.name), findings)
            rows.setdefault(thing_of(field.name), []).append(row)
    remove = {thing_of(name): name for name in known if name.endswith(PRESENT) and not name.startswith("contacts")}
    return [_group(thing, rows[thing], remove.get(thing, "")) for thing in sorted(rows, key=order_of)]


def _group(thing: str, rows: Sequence[FactRow], remove: str) -> Group:
    """A thing's rows; a finding of many fields is shown once for the thing, and at fields edited by a person."""
    count = Counter(line for row in rows for line in row.findings)
    whole = tuple(line for line, number in count.items() if number > SEVERAL)
    kept = [replace(row, findings=tuple(line for line in row.findings if line not in whole or row.basis == "person"))
            for row in rows]  # fmt: skip
    return Group(thing, title_of(thing), _ordered(kept), remove, whole)


def _ordered(rows: Sequence[FactRow]) -> tuple[FactRow, ...]:
    """Rows with a value before open ones."""
    return tuple(sorted(rows, key=lambda row: not row.basis))


def _empty(field: CaseField) -> FactRow:
    return FactRow(field.name, name_of(field.name), shown(field.name, field.value), "", "", 0.0)


def _row(row: FactRow, field: CaseField, edit: Edit | None, findings: Findings) -> FactRow:
    """A row that can be changed; a person's value wins, and what is wrong with it is said there."""
    told = tuple(dict.fromkeys((*row.findings, *findings.get(field.name, ()))))
    row = replace(row, field=field.name, findings=told, edit=_asked(field))
    if edit is None:
        return row
    return replace(row, value=shown(field.name, edit.value), basis="person", status="stated", confidence=1.0)


def _asked(field: CaseField) -> str:
    """Description of a field's input for the page, as JSON."""
    kind = field.kind
    value = list(field.value) if isinstance(field.value, tuple) else field.value
    asked: dict[str, Any] = {
        "form": kind.form, "about": kind.about, "optional": kind.optional, "value": value,
        "choices": list(field.choices), "least": kind.least, "most": kind.most,
    }  # fmt: skip
    return json.dumps({key: entry for key, entry in asked.items() if entry not in (None, [])} | {"value": value})


# ------------------------------------------------------------------ what can be added
def additions(fields: Sequence[CaseField]) -> Iterator[Addition]:
    """Actors, a contact if there are two actors, and compass legs without a road."""
    actors = [field.name.split(".")[1] for field in fields if field.name.endswith(PRESENT) and _is_actor(field.name)]
    for letter, words in _NEW.items() if actors else ():
        numbers = [int(name[1:]) for name in actors if name[0] == letter and name[1:].isdigit()]
        name = f"{letter}{max(numbers, default=0) + 1}"
        yield Addition(f"{words} {name}", json.dumps({canonical(f"actors.{name}.present"): True}))
    contacts = [field for field in fields if field.name.startswith("contacts.") and field.name.endswith(PRESENT)]
    if contacts and len(actors) > 1:
        number, pair = len(contacts), (actors[0], actors[-1])
        edits = {f"contacts.{number}.striker": pair[0], f"contacts.{number}.struck": pair[1]}
        yield Addition(f"contact {number + 1}", json.dumps(edits))
    legs = {field.name.split(".")[1] for field in fields if field.name.startswith("roads.")}
    for point in get_args(Compass) if legs else ():
        if point not in legs:
            yield Addition(f"road {point}", json.dumps({f"roads.{point}.present": True}))


def _is_actor(name: str) -> bool:
    return name.startswith(("vehicles.", "others."))
