"""Editable fields of a case: type, choices and present value.

Types and limits are those of the specs' own fields, so that nothing is written down twice. Knows specs; no file and no
network format.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal, cast

import yaml
from pydantic import BaseModel, TypeAdapter, ValidationError

from sgcad_core.case.records import Stage
from sgcad_core.errors import WrongEdit
from sgcad_core.kinds import JunctionKind
from sgcad_core.records.acts import ACT_FIELDS, Acts, Rest
from sgcad_core.records.edits import AS_READ, canonical
from sgcad_core.records.facts import Value
from sgcad_core.records.specs import Actor, BehaviorSpec, Compass, Contact, NearCrash, Node, Road, RoadSpec
from sgcad_core.revision.values import ACTOR_FIELDS, CONTACT_FIELDS, ROAD_FIELDS, value_of
from sgcad_core.system.yaml_faults import YAML_FAULTS

Form = Literal["integer", "number", "choice", "flag", "list", "actor", "road", "text"]


@dataclass(frozen=True)
class Editable:
    """A kind of field: `pattern` is its name with "*" for a road, an actor or a contact's number (from 0)."""

    pattern: str
    stage: Stage
    about: str
    """What it is, for people."""
    annotation: Any
    """The type that a value must have, as pydantic understands it."""
    refers: Literal["", "actor", "road"] = ""
    """What an id in it names, where it is one."""
    concerns: tuple[str, ...] = ()
    """Patterns (regular expressions) of `Finding.where` that concern it; "{}" stands for what "*" stands for."""

    @cached_property
    def _adapter(self) -> TypeAdapter[Any]:
        return TypeAdapter(self.annotation)

    @cached_property
    def schema(self) -> dict[str, Any]:
        """The JSON schema of a value."""
        return self._adapter.json_schema()

    @property
    def optional(self) -> bool:
        """Whether it may be left open (null): then the usual value, or the planner's choice, stands in."""
        return any(part.get("type") == "null" for part in self.schema.get("anyOf", ()))

    @property
    def _plain(self) -> dict[str, Any]:
        parts = [part for part in self.schema.get("anyOf", ()) if part.get("type") != "null"]
        return parts[0] if parts else self.schema

    @property
    def form(self) -> Form:
        """How a page would ask for it."""
        if self.refers:
            return self.refers
        plain = self._plain
        if "enum" in plain:
            return "choice"
        forms: dict[str, Form] = {"integer": "integer", "number": "number", "boolean": "flag", "array": "list"}
        return forms.get(plain.get("type", ""), "text")

    @property
    def choices(self) -> tuple[str, ...]:
        """Values that it may take, where they are few; of a list, those of its items."""
        plain = self._plain
        return tuple(plain.get("enum") or plain.get("items", {}).get("enum") or ())

    @property
    def least(self) -> float | None:
        """The least value of a number."""
        return cast("float | None", self._plain.get("minimum", self._plain.get("exclusiveMinimum")))

    @property
    def most(self) -> float | None:
        """The greatest value of a number."""
        return cast("float | None", self._plain.get("maximum"))

    def matches(self, field: str) -> str | None:
        """What "*" stands for in a field of this kind ("" without one); None: it is none."""
        found = re.fullmatch(re.escape(self.pattern).replace(r"\*", r"([A-Za-z0-9_]+)"), field)
        return None if found is None else "".join(found.groups())

    def concerned(self, field: str, where: str) -> bool:
        """Whether a finding at that place concerns a field of this kind."""
        name = re.escape(self.matches(field) or "")
        return any(re.fullmatch(pattern.replace("{}", name), where) for pattern in self.concerns)

    def parsed(self, field: str, raw: object) -> Value:
        """A value of the right type; texts are read as YAML. Raises WrongEdit naming field, value and what is meant."""
        if raw == AS_READ:
            return AS_READ
        value = raw
        if isinstance(raw, str) and self.form not in ("choice", "actor", "road", "text"):
            value = _yaml(field, raw)
        elif isinstance(raw, str) and self.optional and raw.lower() in ("null", "", "~"):
            value = None
        if self.form == "list" and isinstance(value, str):
            value = [part.strip() for part in value.split(",") if part.strip()]
        try:
            found = self._adapter.validate_python(value, strict=self.form in ("integer", "flag"))
        except ValidationError as fault:
            raise WrongEdit(f"{field}: {raw!r} is not possible: {self._wanted(str(raw), fault)}") from fault
        return cast("Value", found)

    def _wanted(self, raw: str, fault: ValidationError) -> str:
        if self.choices:
            near = difflib.get_close_matches(raw, self.choices, 1)
            return f"one of {', '.join(self.choices)}" + (f"; did you mean {near[0]!r}?" if near else "")
        if self.least is not None or self.most is not None:
            open_too = ", or null to leave it open" if self.optional else ""
            return f"{self.form} from {self.least:g} to {self.most:g}{open_too}"
        return "; ".join(error["msg"] for error in fault.errors()[:2])


def _yaml(field: str, raw: str) -> object:
    try:
        return yaml.safe_load(raw)
    except YAML_FAULTS as fault:
        raise WrongEdit(f"{field}: {raw!r} is no value: {fault}") from fault


def _annotation(model: type[BaseModel], name: str) -> Any:
    info = model.model_fields[name]
    return Annotated[(info.annotation, *info.metadata)] if info.metadata else info.annotation


_ACTS_MEAN = {
    "from_rest": "whether it stood, then moved on into its first contact", "signal": "what the signal showed to it",
    "evasion": "what it did to avoid its first contact", "lost_control": "whether it lost control",
    "departs": "side by which it left the road before its first contact", "spin": "how it turned after the contact",
    "spin_deg": "by how many degrees it turned", "rolls": "whether it rolled over",
    "roll_quarters": "quarter turns of the rollover", "rolls_to": "the side that led as it rolled over",
    "rest.where": "where it came to rest", "rest.side": "side of the road on which it came to rest",
    "rest.facing_deg": "where it faced at rest, clockwise from north", "rest.attitude": "the part it rests on",
    "rest.distance_m": "how far from its first contact it came to rest",
    "rest.lane": "the lane in which it came to rest, 1 at the right curb",
}  # fmt: skip
_AT_ROAD = (r"roads? (.*, )?{}(,.*| and .*)?", r"leg {}", r"roads\[.*\].*", r"legs(\[.*\].*)?")
_AT_ACTOR = (r"(actor )?{}", r"{}\.\w+", r".*\b{}\b.*")


def _roads() -> Iterator[Editable]:
    meaning = {
        "lanes_forward": "lanes towards the junction (towards the road's to_node), turn lanes counted",
        "lanes_backward": "lanes away from the junction (towards the road's from_node)",
        "turns_forward": "use of each lane towards the junction, from the right curb", "median": "what divides it",
        "turns_backward": "use of each lane at the road's other end, from the right curb",
        "center_turn_lane": "a two-way left-turn lane in its middle", "kind": "street, driveway or ramp",
        "minor": "whether it has the sign where the junction is controlled by signs",
        "speed_limit_mph": "the posted limit",
    }  # fmt: skip
    yield Editable("junction.kind", "road", "the kind of junction", JunctionKind, concerns=("junction", "legs.*"))
    yield Editable("junction.stem", "road", "where the leg lies that ends at the junction", Compass,
                   concerns=("junction", "legs.*"))  # fmt: skip
    yield Editable("junction.control", "road", "what controls the junction", _annotation(Node, "control"),
                   concerns=("junction",))  # fmt: skip
    yield Editable("roads.*.present", "road", "whether there is this road; a bearing adds a leg", bool,
                   concerns=(*_AT_ROAD, "junction"))  # fmt: skip
    for name in ROAD_FIELDS:
        yield Editable(f"roads.*.{name}", "road", meaning[name], _annotation(Road, name), concerns=_AT_ROAD)


def _actors() -> Iterator[Editable]:
    meaning = {
        "kind": "what it is", "maneuver": "what it did before the crash", "speed_mph": "its speed before the crash",
        "start_road": "road on which it starts", "start_direction": "its direction on that road",
        "start_lane": "its lane, 1 at the right curb", "exit_road": "road that it takes behind the junction",
        "length_m": "its length", "width_m": "its width",
    }  # fmt: skip
    for group in ("vehicles", "others"):
        yield Editable(f"{group}.*.present", "scenario", "whether it takes part", bool,
                       concerns=(*_AT_ACTOR, "actors.*"))  # fmt: skip
        yield Editable(f"{group}.*.heading", "scenario", "its heading before the crash", Compass, concerns=_AT_ACTOR)
        for name, field in ACTOR_FIELDS.items():
            refers: Literal["", "road"] = "road" if name in ("start_road", "exit_road") else ""
            yield Editable(f"{group}.*.{name}", "scenario", meaning[name], _annotation(Actor, field), refers,
                           _AT_ACTOR)  # fmt: skip
        for name in ACT_FIELDS if group == "vehicles" else ():
            part, _, last = name.rpartition(".")
            yield Editable(f"{group}.*.{name}", "scenario", _ACTS_MEAN[name], _annotation(Rest if part else Acts, last),
                           concerns=_AT_ACTOR)  # fmt: skip


def _crash() -> Iterator[Editable]:
    meaning = {
        "striker": "who strikes", "struck": "who is struck", "striker_area": "side of the striker that touches",
        "struck_area": "side of the struck that touches",
    }  # fmt: skip
    at = (r"contacts\[{}\].*", r"contacts", r"near_crash\.conflict.*")
    yield Editable("contacts.*.present", "scenario", "whether this contact happened", bool, concerns=at)
    for name in CONTACT_FIELDS:
        refers: Literal["", "actor"] = "actor" if name in ("striker", "struck") else ""
        yield Editable(f"contacts.*.{name}", "scenario", meaning[name], _annotation(Contact, name), refers, at)
    near = (r"near_crash.*", "contacts")
    yield Editable("near_crash", "scenario", "whether the first contact was avoided: nobody touches", bool,
                   concerns=near)  # fmt: skip
    yield Editable("near_crash.clearance_m", "scenario", "how near they came",
                   _annotation(NearCrash, "clearance_m"), concerns=near)  # fmt: skip
    for name in ("light", "weather", "surface"):
        yield Editable(f"conditions.{name}", "scenario", f"the {name}", _annotation(BehaviorSpec, name))


EDITABLE: tuple[Editable, ...] = (*_roads(), *_actors(), *_crash())
"""Every kind of field that a person may change."""


@dataclass(frozen=True)
class CaseField:
    """A field of one case."""

    name: str
    kind: Editable
    value: Value
    """What it is now."""
    choices: tuple[str, ...] = ()
    """What it may be in this case; () where it is no choice."""


def kind_of(field: str) -> Editable:
    """The kind of a field by its canonical name. Raises WrongEdit, with the nearest name, for one that is not known."""
    for kind in EDITABLE:
        if kind.matches(field) is not None:
            return kind
    near = difflib.get_close_matches(re.sub(r"(?<=\.)[A-Z0-9][A-Za-z0-9_]*(?=\.|$)", "*", field),
                                     [kind.pattern for kind in EDITABLE], 3)  # fmt: skip
    meant = f"; did you mean {' or '.join(near)}?" if near else ""
    raise WrongEdit(f"{field}: there is no such field{meant} `sgcad revise CASE --list` names them all")


def parsed_edit(field: str, raw: object) -> tuple[str, Value]:
    """Canonical name and typed value of an edit. Raises WrongEdit."""
    name = canonical(field)
    return name, kind_of(name).parsed(name, raw)


def fields_of(road: RoadSpec | None, behavior: BehaviorSpec | None) -> tuple[CaseField, ...]:
    """What can be changed of a case with these specs, with what it is now: junction, road by road, actor by actor,
    contact by contact, the rest."""
    roads = [r.id for r in road.roads if not r.circle] if road else []
    actors = [a.id for a in behavior.actors] if behavior else []
    found = [
        CaseField(name, kind, value_of(name, road, behavior), _choices(kind, roads, actors))
        for kind in EDITABLE
        for name in _names(kind, roads, actors, behavior)
    ]
    owners = list(dict.fromkeys(_owner(field.name) for field in found))
    return tuple(sorted(found, key=lambda field: owners.index(_owner(field.name))))


def _owner(name: str) -> str:
    """The road, actor or contact that a field is of."""
    parts = name.split(".")
    return ".".join(parts[:2]) if len(parts) > 2 else parts[0]


def _choices(kind: Editable, roads: Sequence[str], actors: Sequence[str]) -> tuple[str, ...]:
    return tuple(roads) if kind.refers == "road" else tuple(actors) if kind.refers == "actor" else kind.choices


def _names(kind: Editable, roads: Sequence[str], actors: Sequence[str], behavior: BehaviorSpec | None) -> Iterator[str]:
    """Names of a kind's fields in a case."""
    group = kind.pattern.partition(".")[0]
    if kind.stage == "road" and roads:
        yield from (kind.pattern.replace("*", r) for r in (roads if group == "roads" else [""]))
    elif behavior is not None and group in ("vehicles", "others"):
        mine = [a for a in actors if a.startswith("V") == (group == "vehicles")]
        yield from (kind.pattern.replace("*", a) for a in mine)
    elif behavior is not None and group == "contacts":
        count = 1 if behavior.near_crash else len(behavior.contacts)
        yield from (kind.pattern.replace("*", str(i)) for i in range(count))
    elif behavior is not None and kind.stage == "scenario":
        yield kind.pattern
