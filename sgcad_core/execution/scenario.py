"""Compiles a behavior on a road network into an executable scenario. Knows the planner and the scenario writer."""

from __future__ import annotations

from collections.abc import Mapping

from sgcad_core.case.records import ActorInfo, Finding, Hold, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.signals import signal_times
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_ENCODING, DEFAULT_VERSION, Encoding, Version
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.planner import plan
from sgcad_core.records.course import NOTHING_TOLD, Courses
from sgcad_core.records.specs import BehaviorSpec, size_m

_finding = FindingFactory("scenario")


def compile_scenario(
    behavior: BehaviorSpec,
    network: RoadNetwork,
    version: Version = DEFAULT_VERSION,
    encoding: Encoding = DEFAULT_ENCODING,
    *,
    may_skid: bool = False,
    courses: Courses = NOTHING_TOLD,
    signals: Mapping[str, str] | None = None,
) -> Scenario:
    """Plans the motions of a behavior on the network and writes them in a version of OpenSCENARIO. Raises
    InvalidOutput.

    `encoding`: timed polylines, or maneuver events that people edit by hand.

    The notes list the changes of the planner; validators report a contact that is not the declared one. `may_skid`: the
    report states a loss of control. `courses`: stated evasion and rest by vehicle. `signals`: the stated signal state
    by vehicle id.
    """
    # the library that writes takes half a second to import, which a config's check need not wait for
    from sgcad_core.execution.event_encoding import write_editable
    from sgcad_core.formats.openscenario.writing.events import EventOptions
    from sgcad_core.formats.openscenario.writing.writer import Handles, origin_motion, write_xosc

    _check_ids(behavior)
    if network.net_xml is None:
        raise InvalidOutput("the road network has no net.xml: compile it before planning on it")
    planned = plan(behavior, parse_net(network.net_xml), may_skid=may_skid, courses=courses)
    actors = actor_infos(behavior)
    origins = [origin_motion(actor, move) for actor, move in zip(actors, planned.trajectories, strict=True)]
    turned = frozenset(who for who, told in courses.items() if told.signal_turned)
    crash_s = planned.contact.t_s if planned.contact else None
    times = signal_times(network, origins, signals or {}, crash_s, turned)
    plan_of = actors, planned.trajectories, behavior
    if encoding == "events":
        xosc = write_editable(*plan_of, EventOptions(planned.contact, network.xodr), version, times.controllers)
    else:
        handles = Handles(network.xodr)
        xosc = write_xosc(*plan_of, version=version, signals=times.controllers, handles=handles)
    return Scenario(
        xosc=xosc,
        actors=actors,
        behavior=behavior,
        declared=behavior.contacts[0] if behavior.contacts else None,
        near_crash=None if behavior.contacts else behavior.near_crash,
        planned=planned.trajectories,
        oddity=planned.oddity,
        notes=(*planned.notes, *times.notes),
    )


def actor_infos(behavior: BehaviorSpec) -> tuple[ActorInfo, ...]:
    """The actors as result.json names them."""
    sized = ((a, *size_m(a)) for a in behavior.actors)
    return tuple(
        ActorInfo(id=a.id, type=a.kind, length_m=length, width_m=width, maneuver=a.maneuver)
        for a, length, width in sized
    )


def _check_ids(behavior: BehaviorSpec) -> None:
    """Raises InvalidOutput for actor ids used twice and for contacts of unknown actors or of one actor with itself."""
    ids = [actor.id for actor in behavior.actors]
    findings = [
        _finding(
            "two actors have this id", f"actors[{i}].id", name, "number them as the report does", holds=_next(i, ids)
        )
        for i, name in enumerate(ids)
        if name in ids[:i]
    ]
    known = f"one of {', '.join(ids)}"
    for i, contact in enumerate(behavior.contacts):
        for role in ("striker", "struck"):
            if (name := getattr(contact, role)) not in ids:
                findings.append(
                    _finding("no such actor", f"contacts[{i}].{role}", name, known, holds=_in_place(name, ids))
                )
        if contact.striker == contact.struck:
            findings.append(
                _finding(
                    "an actor cannot strike itself", f"contacts[{i}]", contact.striker, known, holds=_another(i, ids)
                )
            )
    findings += _near_crash(behavior, ids, known)
    if findings:
        raise InvalidOutput("; ".join(f.line() for f in findings), findings)


def _near_crash(behavior: BehaviorSpec, ids: list[str], known: str) -> list[Finding]:
    """Faults of a near crash: contacts beside it, unknown actors, one actor in conflict with itself."""
    near = behavior.near_crash
    if near is None:
        return []
    named = [("conflict.striker", near.conflict.striker), ("conflict.struck", near.conflict.struck)]
    named += [(f"evasions[{i}].actor", evasion.actor) for i, evasion in enumerate(near.evasions)]
    found = [
        _finding("no such actor", f"near_crash.{where}", name, known, holds=_in_place(name, ids))
        for where, name in named
        if name not in ids
    ]
    if near.conflict.striker == near.conflict.struck:
        what = "an actor cannot be in conflict with itself"
        found.append(_finding(what, "near_crash.conflict", near.conflict.striker, known))
    if behavior.contacts:
        remedy = "a crash has contacts and no near crash; where nobody touches, leave contacts empty"
        found.append(_finding("contacts are declared as well", "near_crash", len(behavior.contacts), remedy))
    return found


def _next(place: int, ids: list[str]) -> tuple[Hold, ...]:
    """The next free number instead of a used one."""
    taken = sum(name[0] == ids[place][0] for name in dict.fromkeys(ids[:place]))
    return (_named(place, f"{ids[place][0]}{taken + 1}"),)


def _in_place(name: str, ids: list[str]) -> tuple[Hold, ...]:
    """An actor that only a contact names: vehicles are placed by their number, others behind the vehicles."""
    place = int(name[1:]) - 1 if name.startswith("V") else sum(other.startswith("V") for other in ids)
    return (_named(place, name),) if 0 <= place <= len(ids) else ()


def _another(place: int, ids: list[str]) -> tuple[Hold, ...]:
    """Any other actor for each possible striker."""
    names = dict.fromkeys(ids)
    either = tuple({"striker": (name,), "struck": tuple(other for other in names if other != name)} for name in names)
    return (Hold(items="contacts", at=place, either=either),) if len(names) > 1 else ()


def _named(place: int, name: str) -> Hold:
    return Hold(items="actors", at=place, either=({"id": (name,)},))
