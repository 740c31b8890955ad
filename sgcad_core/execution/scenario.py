"""A behavior on a road network becomes an executable scenario. Knows the planner and the scenario writer."""

from __future__ import annotations

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.events import Handover
from sgcad_core.formats.openscenario.writer import DEFAULT_ENCODING, DEFAULT_VERSION, Encoding, Version, write_xosc
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.planner import plan
from sgcad_core.records import ActorInfo, Finding, Hold, RoadNetwork, Scenario
from sgcad_core.specs import BehaviorSpec, size_m


def compile_scenario(
    behavior: BehaviorSpec,
    network: RoadNetwork,
    version: Version = DEFAULT_VERSION,
    encoding: Encoding = DEFAULT_ENCODING,
    *,
    may_skid: bool = False,
) -> Scenario:
    """Plan the behavior's motions on the network and write them in a version of OpenSCENARIO. Raises InvalidOutput.

    `encoding`: timed polylines, or maneuver events that people edit by hand.

    What the planner had to change stands in the notes; that the declared contact is not the planned one is
    for the validators to say. `may_skid`: the report tells that somebody lost control.
    """
    _check_ids(behavior)
    if network.net_xml is None:
        raise InvalidOutput("the road network has no net.xml: compile it before planning on it")
    planned = plan(behavior, parse_net(network.net_xml), may_skid=may_skid)
    actors = actor_infos(behavior)
    handover = Handover(planned.contact, network.xodr) if encoding == "events" else None
    return Scenario(
        xosc=write_xosc(actors, planned.trajectories, behavior, version=version, handover=handover),
        actors=actors,
        behavior=behavior,
        declared=behavior.contacts[0] if behavior.contacts else None,
        near_crash=None if behavior.contacts else behavior.near_crash,
        planned=planned.trajectories,
        oddity=planned.oddity,
        notes=planned.notes,
    )


def actor_infos(behavior: BehaviorSpec) -> tuple[ActorInfo, ...]:
    """The actors as result.json names them."""
    sized = ((a, *size_m(a)) for a in behavior.actors)
    return tuple(
        ActorInfo(id=a.id, type=a.kind, length_m=length, width_m=width, maneuver=a.maneuver)
        for a, length, width in sized
    )


def _check_ids(behavior: BehaviorSpec) -> None:
    """Raise InvalidOutput for actor ids used twice and for contacts of unknown actors or with oneself."""
    ids = [actor.id for actor in behavior.actors]
    findings = [
        _finding(f"actors[{i}].id", "two actors have this id", name, "number them as the report does", _next(i, ids))
        for i, name in enumerate(ids)
        if name in ids[:i]
    ]
    known = f"one of {', '.join(ids)}"
    for i, contact in enumerate(behavior.contacts):
        for role in ("striker", "struck"):
            if (name := getattr(contact, role)) not in ids:
                findings.append(_finding(f"contacts[{i}].{role}", "no such actor", name, known, _in_place(name, ids)))
        if contact.striker == contact.struck:
            findings.append(
                _finding(f"contacts[{i}]", "an actor cannot strike itself", contact.striker, known, _another(i, ids))
            )
    findings += _near_crash(behavior, ids, known)
    if findings:
        raise InvalidOutput("; ".join(f.line() for f in findings), findings)


def _near_crash(behavior: BehaviorSpec, ids: list[str], known: str) -> list[Finding]:
    """What is wrong with a near crash: contacts beside it, unknown actors, one actor in conflict with itself."""
    near = behavior.near_crash
    if near is None:
        return []
    named = [("conflict.striker", near.conflict.striker), ("conflict.struck", near.conflict.struck)]
    named += [(f"evasions[{i}].actor", evasion.actor) for i, evasion in enumerate(near.evasions)]
    found = [
        _finding(f"near_crash.{where}", "no such actor", name, known, _in_place(name, ids))
        for where, name in named
        if name not in ids
    ]
    if near.conflict.striker == near.conflict.struck:
        what = "an actor cannot be in conflict with itself"
        found.append(_finding("near_crash.conflict", what, near.conflict.striker, known))
    if behavior.contacts:
        remedy = "a crash has contacts and no near crash; where nobody touches, leave contacts empty"
        found.append(_finding("near_crash", "contacts are declared as well", str(len(behavior.contacts)), remedy))
    return found


def _next(place: int, ids: list[str]) -> tuple[Hold, ...]:
    """The next number in place of one that is taken."""
    taken = sum(name[0] == ids[place][0] for name in dict.fromkeys(ids[:place]))
    return (_named(place, f"{ids[place][0]}{taken + 1}"),)


def _in_place(name: str, ids: list[str]) -> tuple[Hold, ...]:
    """One that a contact names and no actor is: a vehicle belongs where its number says, others behind the vehicles."""
    place = int(name[1:]) - 1 if name.startswith("V") else sum(other.startswith("V") for other in ids)
    return (_named(place, name),) if 0 <= place <= len(ids) else ()


def _another(place: int, ids: list[str]) -> tuple[Hold, ...]:
    """Whoever strikes, somebody else is struck."""
    names = dict.fromkeys(ids)
    either = tuple({"striker": (name,), "struck": tuple(other for other in names if other != name)} for name in names)
    return (Hold(items="contacts", at=place, either=either),) if len(names) > 1 else ()


def _named(place: int, name: str) -> Hold:
    return Hold(items="actors", at=place, either=({"id": (name,)},))


def _finding(where: str, what: str, value: str, remedy: str, holds: tuple[Hold, ...] = ()) -> Finding:
    return Finding(source="scenario", what=what, where=where, value=value, remedy=remedy, holds=holds)
