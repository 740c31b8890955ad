"""Scenarios by rules: the narrative's facts placed on the network and planned, without a model.

The baseline without a model. Reads the narrative only: no diagram, no passages. Where the contact does not come about,
it changes what keeps it from that (`execution.mending`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar

from plugins.scenario_writer._planned import PlannedWriter, roads_of
from sgcad_core.case.records import Context, Finding, Passage, RoadNetwork, Scenario, Severity, sizes_of
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.mending import mended
from sgcad_core.execution.plan_score import least_doubted
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.interfaces import Ask
from sgcad_core.reading.behavior.behavior import behavior_of_facts, with_acts_read
from sgcad_core.reading.behavior.company import with_company
from sgcad_core.reading.behavior.passers_by import with_parked_rows, with_passers_by
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.layout.layout_facts import lane_notes
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.reading_with_edits import holds
from sgcad_core.records.course import Courses
from sgcad_core.records.specs import BehaviorSpec, RoadSpec


class Rules(PlannedWriter):
    """Plans vehicles, headings, maneuvers and contacts as the narrative states them, completed by inference."""

    asks_model: ClassVar[bool] = False
    mends: ClassVar[tuple[Severity, ...]] = ("repair",)
    version: ClassVar[str] = "5"

    try_others: bool = True
    """If the checks doubt the first plan: plan readings that differ in one weak fact, and keep the least doubted."""

    def write(
        self,
        context: Context,
        passages: Sequence[Passage],
        findings: Sequence[Finding],
        ask: Ask,
        attempt: int,
        network: RoadNetwork,
    ) -> Scenario:
        """Plans and writes the scenario. Raises Refused (no vehicles), InvalidOutput (no network)."""
        spec = roads_of(network)
        reading = context.reading
        facts = reading.crash
        scenario = self._compiled(facts, spec, network, reading)
        said: list[str] = []
        if self.try_others and network.net_xml and not reading.lost_control:
            least = least_doubted(
                reading.crash, lambda facts: behavior_of_facts(facts, spec), parse_net(network.net_xml), scenario,
                lambda facts: holds(facts, reading.edits),
            )  # fmt: skip
            said = least.notes()
            if least.words:
                facts = least.facts
                scenario = self._compiled(facts, spec, network, reading)
        if findings:
            scenario = self._mended(scenario, facts, network, reading)
        drawn = network.source == "written" and not (network.place and network.place.found)
        widened = lane_notes(reading.roads) if drawn else ()
        return scenario.model_copy(update={"notes": (*_inferred(reading.crash), *widened, *said, *scenario.notes)})

    def _compiled(self, facts: CrashFacts, spec: RoadSpec, network: RoadNetwork, reading: Reading) -> Scenario:
        """The scenario of one reading of the crash."""
        courses = facts.driven
        behavior = with_acts_read(behavior_of_facts(facts, spec), courses, reading.signals)
        behavior = with_passers_by(with_company(behavior, reading), reading, spec)
        behavior = with_parked_rows(behavior, reading, spec)
        return self._of_behavior(behavior, courses, network, reading)

    def _of_behavior(
        self, behavior: BehaviorSpec, courses: Courses, network: RoadNetwork, reading: Reading
    ) -> Scenario:
        return compile_scenario(
            behavior, network, self.openscenario, self.encoding,
            may_skid=reading.lost_control, courses=courses, signals=reading.signals,
        )  # fmt: skip

    def _mended(self, scenario: Scenario, facts: CrashFacts, network: RoadNetwork, reading: Reading) -> Scenario:
        """The scenario with the change that brings its contact about; itself where none does."""
        if scenario.behavior is None or network.net_xml is None:
            return scenario
        seen = first_contact(scenario.planned, sizes_of(scenario.actors))
        graph = parse_net(network.net_xml)
        found = mended(scenario.behavior, graph, seen, may_skid=reading.lost_control, courses=facts.driven)
        if found is None:
            return scenario
        other = self._of_behavior(found.behavior, facts.driven, network, reading)
        return other.model_copy(update={"notes": (f"mended: {found.words}", *other.notes)})


def _inferred(facts: CrashFacts) -> Iterator[str]:
    """Notes on facts that the text does not state."""
    for v in facts.vehicles:
        if not v.heading_stated:
            yield f"{v.id}'s heading is not told: inferred as {v.heading}" if v.heading else f"{v.id}'s heading is open"
    first = facts.contacts[0] if facts.contacts else None
    if first is None or not first.stated:
        yield "the contact is not told: the most plausible one stands in"
    elif not first.areas_stated:
        yield f"sides inferred: {first.striker_area} of {first.striker}, {first.struck_area} of {first.struck}"
