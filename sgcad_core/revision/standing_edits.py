"""Edits without effect on the written specs, and why.

Compares values with specs of any writer; changes nothing. Knows specs; no file and no planner.
"""

from __future__ import annotations

from collections.abc import Sequence

from sgcad_core.case.records import Finding, Stage
from sgcad_core.findings import FindingFactory
from sgcad_core.records.edits import Edit, effective
from sgcad_core.records.specs import BehaviorSpec, RoadSpec
from sgcad_core.revision.actors import goes
from sgcad_core.revision.fields import kind_of
from sgcad_core.revision.values import actor_of, contacts_of, legs_of, road_of, value_of, way_of

SOURCE = "facts"
_finding = FindingFactory(SOURCE)


def unapplied_edits(
    edits: Sequence[Edit], stage: Stage, road: RoadSpec | None, behavior: BehaviorSpec | None = None
) -> list[Finding]:
    """One finding (a doubt) for every effective edit of a stage that its specs do not show."""
    found = []
    for edit in effective(edits):
        if kind_of(edit.field).stage == stage and (reason := fault(edit, road, behavior)):
            remedy = f"take it back: --set {edit.field}=as_read, or give another value"
            found.append(_finding(f"what a person says does not stand: {reason}", edit.field, edit.value, remedy,
                                  "doubt"))  # fmt: skip
    return found


def fault(edit: Edit, road: RoadSpec | None, behavior: BehaviorSpec | None) -> str:
    """The reason why an edit has no effect; "" where it has."""
    group, _, rest = edit.field.partition(".")
    if road is None and behavior is None:
        return "the writer of this config gives no spec that could be changed; use one of `spec`, `template`, `rules`"
    if group in ("vehicles", "others") and behavior is not None:
        return _actor_fault(edit, rest.partition(".")[0], road, behavior)
    now = value_of(edit.field, road, behavior)
    if now == edit.value:
        return ""
    if group in ("roads", "junction") and road is not None:
        return _road_fault(edit, rest.partition(".")[0], road)
    if group == "contacts" and behavior is not None:
        return _contact_fault(edit, rest.partition(".")[0], behavior)
    if group == "near_crash":
        return "there is no contact that could have been avoided"
    return f"it stays {now}"


def _road_fault(edit: Edit, name: str, road: RoadSpec) -> str:
    if edit.field.startswith("junction."):
        if edit.field == "junction.control":
            return f"no junction of this network can have it ({len(legs_of(road))} roads meet)"
        return f"this network cannot be drawn so; it has {value_of(edit.field, road, None)}"
    if edit.field.endswith(".present"):
        if edit.value:
            return "a leg is added by its bearing, such as roads.NE.present"
        return "the last road cannot be taken away, nor a piece of a roundabout"
    if road_of(road, name) is None:
        return f"there is no road {name}; there are {', '.join(r.id for r in road.roads)}"
    return "a road needs a lane, and a list of turns one entry a lane"


def _actor_fault(edit: Edit, name: str, road: RoadSpec | None, behavior: BehaviorSpec) -> str:
    actor, attribute = actor_of(behavior, name), edit.field.rpartition(".")[2]
    if attribute == "present":
        stands = (actor is not None) == edit.value
        return "" if stands else "a scenario has 1 to 12 actors, named V, P, B, A, T or O and a number"
    if actor is None:
        known = ", ".join(a.id for a in behavior.actors)
        return f"there is no {name}; there are {known}; --set {edit.field.rpartition('.')[0]}.present=true adds it"
    way = way_of(actor, road) if road else None
    if attribute == "heading":
        fits = way is None or goes(way, edit.value)  # type: ignore[arg-type]
        return "" if fits else f"no road carries traffic to the {edit.value}"
    if value_of(edit.field, road, behavior) == edit.value:
        return ""
    if attribute == "start_lane" and way is not None:
        return f"road {way.road.id} has {way.lanes} lane(s) that way"
    if attribute in ("start_road", "exit_road"):
        roads = ", ".join(r.id for r in road.roads) if road else "unknown"
        return f"no such road, or none with lanes that way; there are {roads}"
    return f"it stays {value_of(edit.field, road, behavior)}"


def _contact_fault(edit: Edit, number: str, behavior: BehaviorSpec) -> str:
    count, names = len(contacts_of(behavior)), ", ".join(a.id for a in behavior.actors)
    if int(number) >= count:
        return f"there are {count} contacts, numbered from 0; a further one needs striker and struck of {names}"
    return f"two of {names} touch, and one cannot strike itself"
