"""The model describes the actors' driving and the contacts; code plans and writes the scenario.

The roads are part of the query, the crash evidence is the context, so that contrast amplifies the evidence only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from plugins.scenario_writer._planned import PlannedWriter
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, Finding, Passage, Query, RoadNetwork, Scenario
from sgcad_core.errors import ConfigError, InvalidOutput
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.sumo.net_xml import LaneGraph, parse_net
from sgcad_core.interfaces import Ask
from sgcad_core.reading.behavior.behavior import as_read, with_acts_read
from sgcad_core.reading.reading_with_acts import with_acts
from sgcad_core.records.specs import BehaviorSpec, RoadSpec
from sgcad_core.roads.describe import describe_network, road_ids


class SpecScenario(PlannedWriter):
    """Asks a model for a `BehaviorSpec` on the roads of the network, and plans the scenario from it."""

    asks_model: ClassVar[bool] = True
    prompt: str = Field("behavior", pattern=r"^[\w-]+$")
    """configs/prompts/<prompt>.md; its slot {roads} is filled."""
    roads: Literal["described", "layout"] = "described"
    """Content of that slot: the network in words, or the layout's JSON as it was answered (for small models)."""

    acts: bool = False
    """Ask for near crashes as well, and for what vehicles did beside their maneuvers (stops, evasion, rest), which the
    embedded model has not learned; else both are as the rules read them."""

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompt."""
        return (self.prompt,)

    def write(
        self,
        context: Context,
        passages: Sequence[Passage],
        findings: Sequence[Finding],
        ask: Ask,
        attempt: int,
        network: RoadNetwork,
    ) -> Scenario:
        """Asks, reads, plans and writes. Raises InvalidOutput with findings, Refused if the model declines."""
        roads = _roads(network)
        ids = road_ids(roads)
        query = Query(
            task=load_prompt(self.prompt, roads=self._shown(network, roads)),
            passages=tuple(passages),
            answer_schema=answer_schema(BehaviorSpec, enums={"road": ids, "exit_road": ids}, places=self.acts),
            attempt=attempt,
        )
        reading = context.reading
        behavior = parse_answer(ask(context, query).text, BehaviorSpec)
        if self.acts:
            reading = with_acts(reading, behavior)
        else:
            behavior = with_acts_read(as_read(behavior, reading.crash), reading.crash.driven, reading.signals)
        return compile_scenario(
            behavior, network, self.openscenario, self.encoding,
            may_skid=reading.lost_control, courses=reading.crash.driven, signals=reading.signals,
        )  # fmt: skip

    def _shown(self, network: RoadNetwork, roads: RoadSpec | LaneGraph) -> str:
        if self.roads == "described":
            return describe_network(roads)
        if network.layout is None:
            raise ConfigError(
                "scenario_writer.roads 'layout' needs a network that was answered as a layout; use road_writer "
                "'spec' with form 'layout', or roads 'described'"
            )
        return network.layout.model_dump_json()


def _roads(network: RoadNetwork) -> RoadSpec | LaneGraph:
    if network.spec is not None:
        return network.spec
    if network.net_xml is None:
        raise InvalidOutput("the road network has neither spec nor net.xml: no road to place an actor on")
    return parse_net(network.net_xml)
