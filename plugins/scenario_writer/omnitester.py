"""OmniTester's vehicle half: an interpreter describes the actors' driving, a vehicle generator writes SUMO routes.

The scenario is a .rou.xml that SUMO's own driver models execute, so a crash happens only if their parameters make them
ignore other vehicles. Beside it the model declares actors and contact. Faults come back through the refinement loop.
Knows the lane graph, no planner.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field, PrivateAttr

from plugins.scenario_writer._network_words import edge_lines
from plugins.scenario_writer.code import CodedActor, Declaration
from sgcad_core.asking.case_cache import CaseCache
from sgcad_core.asking.fenced_blocks import xml_document
from sgcad_core.asking.prompts import MAX_ANSWER, answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import ActorInfo, Context, Finding, Passage, Query, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.routes_xml import route_actors
from sgcad_core.interfaces import Ask, ScenarioWriter
from sgcad_core.kinds import actor_kind
from sgcad_core.records.specs import Spec


class VehicleInterpretation(Spec):
    """The interpreter's answer; the reasoning is the first field, so that it is written first."""

    reasoning: str = Field(description="step by step: who, from where to where, how fast, what happens when")
    vehicles: str = Field(min_length=1, description="every actor and the contact in plain sentences")


class RoutesAnswer(Declaration):
    """The envelope: the declaration and the route file in one JSON object."""

    routes: str = Field(description="the whole XML document with root <routes>")


class OmnitesterVehicles(ScenarioWriter):
    """Asks a model twice: for a description of the actors and the contact, then for SUMO routes made from it.

    form is how the routes are answered (fenced blocks or a JSON envelope).
    """

    asks_model: ClassVar[bool] = True
    form: Literal["envelope", "fenced"] = "fenced"
    _seen: CaseCache[VehicleInterpretation] = PrivateAttr(default_factory=CaseCache)

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompts of both questions, and the words on the form of the answer."""
        return ("omnitester_roles", "omnitester_vehicles", f"omnitester_{self.form}")

    def write(
        self,
        context: Context,
        passages: Sequence[Passage],
        findings: Sequence[Finding],
        ask: Ask,
        attempt: int,
        network: RoadNetwork,
    ) -> Scenario:
        """Interprets (once for each case), generates and reads. Raises InvalidOutput with findings, Refused."""
        if network.net_xml is None:
            raise InvalidOutput("the road network has no net.xml: no edge to drive on")
        edges = edge_lines(parse_net(network.net_xml))
        seen = self._seen.of(context, attempt, lambda: _interpret(context, ask, attempt, edges))
        query = Query(
            task=load_prompt("omnitester_vehicles", answer=load_prompt(f"omnitester_{self.form}"), edges=edges),
            passages=tuple(passages),
            answer_schema=answer_schema(RoutesAnswer) if self.form == "envelope" else None,
            attempt=attempt,
        )
        declared, routes = _read(ask(Context(narrative=seen.vehicles), query).text)
        sizes = {m.id: (m.length_m, m.width_m) for m in route_actors(routes)}
        return Scenario(
            routes_xml=routes,
            actors=tuple(_actor(a, sizes.get(a.id, (None, None))) for a in declared.actors),
            declared=declared.contacts[0] if declared.contacts else None,
        )


def _interpret(context: Context, ask: Ask, attempt: int, edges: str) -> VehicleInterpretation:
    schema = answer_schema(VehicleInterpretation)
    query = Query(task=load_prompt("omnitester_roles", edges=edges), answer_schema=schema, attempt=attempt)
    return parse_answer(ask(context, query).text, VehicleInterpretation)


def _actor(actor: CodedActor, size: tuple[float | None, float | None]) -> ActorInfo:
    usual = actor_kind(actor.kind).size
    length, width = size[0] or usual[0], size[1] or usual[1]  # a missing size is a finding of its own
    return ActorInfo(id=actor.id, type=actor.kind, length_m=length, width_m=width, maneuver=actor.maneuver)


def _read(answer: str) -> tuple[Declaration, str]:
    """Declaration and route file, in whichever form they came. Raises Refused, InvalidOutput."""
    document = xml_document(answer, "routes") if len(answer) <= MAX_ANSWER else ""
    if document and '"routes"' not in answer:
        return parse_answer(answer.replace(document, ""), Declaration), document
    envelope = parse_answer(answer, RoutesAnswer)
    return envelope, envelope.routes.strip()
