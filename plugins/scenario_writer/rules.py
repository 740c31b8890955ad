"""Scenarios by rules: the narrative's facts placed on the network and planned, without a model.

The baseline without a model. Reads the narrative only: no diagram, no passages; findings cannot change its answer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar

from plugins.scenario_writer._planned import PlannedWriter, roads_of
from sgcad_core.case.records import Context, Finding, Passage, RoadNetwork, Scenario
from sgcad_core.execution.plan_score import least_doubted
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.interfaces import Ask
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.reading_with_edits import holds
from sgcad_core.records.specs import RoadSpec


class Rules(PlannedWriter):
    """Plans vehicles, headings, maneuvers and contacts as the narrative states them, completed by inference."""

    asks_model: ClassVar[bool] = False
    version: ClassVar[str] = "3"

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
        scenario = self._compiled(reading.crash, spec, network, reading)
        said: list[str] = []
        if self.try_others and network.net_xml and not reading.lost_control:
            least = least_doubted(
                reading.crash, lambda facts: behavior_of_facts(facts, spec), parse_net(network.net_xml), scenario,
                lambda facts: holds(facts, reading.edits),
            )  # fmt: skip
            said = least.notes()
            if least.words:
                scenario = self._compiled(least.facts, spec, network, reading)
        return scenario.model_copy(update={"notes": (*_inferred(reading.crash), *said, *scenario.notes)})

    def _compiled(self, facts: CrashFacts, spec: RoadSpec, network: RoadNetwork, reading: Reading) -> Scenario:
        """The scenario of one reading of the crash."""
        return compile_scenario(
            behavior_of_facts(facts, spec),
            network,
            self.openscenario,
            self.encoding,
            may_skid=reading.lost_control,
            courses=facts.courses,
            signals=reading.signals,
        )


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
