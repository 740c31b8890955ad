"""A crash in seven words: what a second reader is asked beside the rules, and what the rules say of it.

Of the first contact alone, and of no place. The subject is the actor V1 (the vehicle whose report it is, or the first
by number), the other one is the actor that it met first, or nearly met. Knows readings and no model.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from pydantic import Field

from sgcad_core.kinds import ACROSS_LANES, ACTORS, Maneuver, kind_of_letter
from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.records.answer_schema import Spec
from sgcad_core.records.second_reader import Value
from sgcad_core.records.specs import ActorKind, Area

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading

SUBJECT = "V1"


class Gist(Spec):
    """The first contact, or the one that was avoided; field order is answer order, descriptions are prompt text."""

    touched: bool = Field(description="false: a near crash, in which nobody touches")
    met: ActorKind = Field(description="what the subject met; an animal is an object")
    subject: Maneuver = Field(description="what the subject V1 did right before, not what it did in the end")
    other: Maneuver = Field(description="what the other one did right before")
    subject_area: Area = Field(description="side of the subject that was touched or would have been")
    other_area: Area
    junction: bool = Field(description="whether it happened at a junction, driveway or ramp")


FIELDS: tuple[str, ...] = tuple(Gist.model_fields)
"""In the order of the answer."""
_ALIKE: tuple[frozenset[Value], ...] = (
    frozenset({"stopped", "parked"}),
    frozenset({"straight", "slowing", "negotiating_curve"}),
    frozenset({"lane_change_left", "lane_change_right", "merge"}),
)
"""Values that make no difference to whether both readers agree."""
_SHOWN: tuple[frozenset[Value], ...] = (
    frozenset({"straight", "slowing", "negotiating_curve", "overtaking", "crossing_centerline",
               "departing_road_left", "departing_road_right"}),
    frozenset(ACROSS_LANES),
    frozenset({"turn_left", "u_turn"}),
)  # fmt: skip
"""Maneuvers that codes of incident reports do not tell apart: driven up to the contact they may look the same."""


def alike(one: Value, other: Value) -> bool:
    """Whether two values of a field mean the same motion or the same sort of partner."""
    same = one == other or any({one, other} <= some for some in _ALIKE)
    return same or (_is_in_traffic(one) and _is_in_traffic(other))


def _is_in_traffic(value: Value) -> bool:
    """Whether a value is a motor vehicle or its trailer, which makes no difference either."""
    record = ACTORS.get(str(value))
    return record is not None and (record.motor or record.pulled)


def shown_alike(one: Value, other: Value) -> bool:
    """Whether two values of a field may come to the same motion up to the contact."""
    return alike(one, other) or any({one, other} <= some for some in _SHOWN)


class RuleValues(NamedTuple):
    """The rules' value of every field that they have one for, and the fields that the text tells outright."""

    values: Mapping[str, Value]
    told: frozenset[str]


def meeting(crash: CrashFacts) -> ContactFacts | None:
    """The contact that the gist is of: the first one, if it can be read and the subject has a part in it."""
    first = crash.contacts[0] if crash.contacts and not crash.gap else None
    return first if first and SUBJECT in (first.striker, first.struck) else None


def partner(contact: ContactFacts) -> str:
    """The actor that the subject met."""
    return contact.struck if contact.striker == SUBJECT else contact.striker


def areas(contact: ContactFacts) -> tuple[Area, Area]:
    """The subject's side and the other's."""
    mine, theirs = contact.striker_area, contact.struck_area
    return (mine, theirs) if contact.striker == SUBJECT else (theirs, mine)


def rule_values(reading: Reading) -> RuleValues:
    """The values of a reading by the rules; without a contact of the subject none for its partner."""
    crash, junction = reading.crash, reading.roads.junction
    values: dict[str, Value] = {"junction": junction.kind not in ("none", "parking_lot")}
    told = {"junction"} if junction.stated else set()
    if (me := crash.vehicle(SUBJECT)) is not None:
        values["subject"] = me.maneuver
        told |= {"subject"} if me.maneuver_stated else set()
    if (contact := meeting(crash)) is not None:
        more, sure = _of_contact(crash, contact)
        values |= more
        told |= sure
    return RuleValues(values, frozenset(told))


def _of_contact(crash: CrashFacts, contact: ContactFacts) -> tuple[dict[str, Value], set[str]]:
    """Values that a contact of the subject has, and which of them are told."""
    near, name = crash.near_crash, partner(contact)
    mine, theirs = areas(contact)
    kinds = {other.id: other.kind for other in crash.others}
    them = crash.vehicle(name)
    kind: ActorKind = them.kind if them else kinds.get(name, kind_of_letter("O"))
    values: dict[str, Value] = {"touched": near is None, "subject_area": mine, "other_area": theirs, "met": kind}
    told = {"met"} | ({"subject_area", "other_area"} if contact.areas_stated else set())
    told |= {"touched"} if contact.stated and (near is None or near.stated) else set()
    if them is not None:
        values["other"] = them.maneuver
        told |= {"other"} if them.maneuver_stated else set()
    return values, told
