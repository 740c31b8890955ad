"""Checks that scenario, net.xml and xodr agree, and that the declared crash is the one that happens."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, Literal

import numpy as np

from sgcad_core.case.records import (
    ActorInfo,
    Evidence,
    Finding,
    ObservedContact,
    RoadNetwork,
    Scenario,
    Trajectory,
    sizes_of,
)
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.contact import (
    CLEARANCE_TOLERANCE_M,
    UNTOLD_CLEARANCE_M,
    avoided,
    closest_approach,
    first_contact,
    realised,
)
from sgcad_core.execution.starts import START_M, off_lane
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.agreement import network_disagreements
from sgcad_core.formats.openscenario.playing.player import entity_boxes, play
from sgcad_core.formats.sumo.net_xml import LaneGraph, parse_net
from sgcad_core.interfaces import Validator
from sgcad_core.records.specs import Contact

_finding = FindingFactory("agreement")

SIZE_M = 1e-3


class Agreement(Validator):
    """Checks that the three files of a case agree with each other and with the declared contact or near crash."""

    stage: ClassVar[str] = "scenario"
    unrealised: Literal["repair", "note"] = "repair"
    """Severity if another contact than the declared one comes first."""

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """Disagreements; files that another validator reports as unreadable are skipped."""
        if not isinstance(artifact, Scenario) or artifact.xosc is None:
            return []
        network = evidence.network
        try:
            boxes = entity_boxes(artifact.xosc)
            motions = artifact.planned or play(artifact.xosc, network.xodr if network else None)
            graph = parse_net(network.net_xml) if network and network.net_xml else None
            found = network_disagreements(graph, network.xodr) if graph and network and network.xodr else []
        except InvalidOutput:
            return []
        found += _actor_findings(artifact.actors, {name: box[:2] for name, box in boxes.items()})
        found += _contact_actors(artifact)
        if found:
            return found
        contact = first_contact(motions, sizes_of(artifact.actors))
        found += _starts(artifact.actors, motions, graph, contact) if graph else []
        return [*found, *self._contact(artifact.declared, contact), *self._near_crash(artifact, motions, contact)]

    def _contact(self, declared: Contact | None, seen: ObservedContact | None) -> Iterator[Finding]:
        """Nothing if the declared contact is the first; without a declared one, a note on any contact."""
        if declared is None and seen is not None:  # of a near crash `_near_crash` says more
            yield _finding("a contact happens that is not declared", "contacts", _seen(seen), "declare it", "note")
        elif declared is not None and not realised(declared, seen):
            what = f"the first contact is not the declared one ({_declared(declared)})"
            remedy = "change lanes, exit roads, maneuvers or the contact so that these sides can meet first"
            yield _finding(what, "contacts[0]", _seen(seen), remedy, self.unrealised)

    def _near_crash(
        self, scenario: Scenario, motions: Sequence[Trajectory], seen: ObservedContact | None
    ) -> Iterator[Finding]:
        """Nothing if there is no contact and the pair comes as near as declared."""
        near = scenario.near_crash
        if near is None:
            return
        pair = near.conflict.striker, near.conflict.struck
        closest = closest_approach(motions, sizes_of(scenario.actors), pair)
        if seen is not None:
            remedy = "change the evasion, lanes or maneuvers so that nobody touches anybody"
            yield _finding("a near crash ends in a contact", "near_crash", _seen(seen), remedy, self.unrealised)
        elif closest is not None and not avoided(near, seen, closest):
            told = f"the declared {near.closest_m:g} m (within {CLEARANCE_TOLERANCE_M:g} m)"
            least, most = UNTOLD_CLEARANCE_M
            what = f"the closest approach is not {told if near.clearance_m else f'within {least:g} to {most:g} m'}"
            value = f"{closest.clearance_m:.2f} m at {closest.t_s:.2f} s"
            remedy = "change roads, maneuvers, the conflict or the evasion so that the two come into conflict"
            yield _finding(what, "near_crash.clearance_m", value, remedy, self.unrealised)


# ------------------------------------------------------------------ actors
def _actor_findings(actors: Sequence[ActorInfo], boxes: dict[str, tuple[float, ...]]) -> list[Finding]:
    """Ids and sizes in the .xosc against the scenario's actors."""
    names = [a.id for a in actors]
    if sorted(names) != sorted(boxes):
        remedy = f"write one entity an actor: {', '.join(names)}"
        return [_finding("the .xosc has other entities than the scenario", "Entities", ", ".join(boxes), remedy)]
    sized = [(a, (a.length_m, a.width_m), boxes[a.id]) for a in actors]
    return [
        _finding(f"the box of {a.id} is not its size", f"ScenarioObject {a.id!r}", f"{box} m", f"make it {size} m")
        for a, size, box in sized
        if not np.allclose(size, box, atol=SIZE_M, rtol=0)
    ]


def _contact_actors(scenario: Scenario) -> list[Finding]:
    names = [a.id for a in scenario.actors]
    contacts = scenario.behavior.contacts if scenario.behavior else ()
    every = [scenario.declared, *contacts] if scenario.declared else list(contacts)
    every += [scenario.near_crash.conflict] if scenario.near_crash else []
    missing = {n for c in every if c for n in (c.striker, c.struck) if n not in names}
    return [
        _finding("a declared contact names no actor", "contacts", name, f"one of {', '.join(names)}")
        for name in sorted(missing)
    ]


def _starts(
    actors: Sequence[ActorInfo], motions: Sequence[Trajectory], graph: LaneGraph, contact: ObservedContact | None
) -> list[Finding]:
    """Actors that drive before the first contact and do not start in a lane."""
    remedy = f"start it within {START_M:g} m of a lane's center"
    return [
        _finding(f"{name} does not start in a lane", name, f"{away:.1f} m away", remedy)
        for name, away in off_lane(actors, motions, graph, contact)
    ]


# ------------------------------------------------------------------ words
def _declared(contact: Contact) -> str:
    return f"{contact.striker} {contact.striker_area} into {contact.struck} {contact.struck_area}"


def _seen(contact: ObservedContact | None) -> str:
    if contact is None:
        return "nothing touches"
    sides = f"{contact.actor} {contact.actor_area} and {contact.other} {contact.other_area}"
    return f"{sides} at {contact.t_s:.2f} s"
