"""One executed case as the modules of the account use it: reading, compiled roads, executed motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sgcad_core.account.records import Item
from sgcad_core.account.words import phrase
from sgcad_core.case.records import Execution, ObservedContact, RoadNetwork, Scenario, Trajectory, sizes_of
from sgcad_core.execution.contact import observe
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.plane import Size
from sgcad_core.metrics.labels.motion_label_match import Path
from sgcad_core.metrics.labels.observed_crash import Crash
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.reading_with_acts import with_acts
from sgcad_core.records.facts import Fact, Value
from sgcad_core.roads.compiled_facts import CompiledRoad, compiled_roads, roads_as_told
from sgcad_core.roads.lane_graph import LaneGraph


@dataclass(frozen=True)
class ExecutedCase:
    """One executed case: roads as compiled and motion as executed, not as a writer declares them."""

    reading: Reading
    network: RoadNetwork
    scenario: Scenario
    execution: Execution
    pictured: bool = False
    """Whether a drawing may show lanes that the text does not count."""

    @cached_property
    def said(self) -> Reading:
        """The reading with what the scenario's writer says of the vehicles' acts."""
        return with_acts(self.reading, self.scenario.behavior)

    @cached_property
    def graph(self) -> LaneGraph:
        """The compiled roads."""
        return parse_net(self.network.net_xml or "<net/>")

    @cached_property
    def drawn(self) -> list[CompiledRoad]:
        """The roads of the graph with their lanes and headings; those of a real place as the report knows them."""
        return roads_as_told(compiled_roads(self.graph), self.network.place)

    @cached_property
    def sizes(self) -> Mapping[str, Size]:
        """Length and width by actor, metres."""
        return sizes_of(self.scenario.actors)

    @cached_property
    def tracks(self) -> Mapping[str, Trajectory]:
        """Executed motion by actor."""
        return {track.actor: track for track in self.execution.trajectories if track.actor in self.sizes}

    @cached_property
    def crash(self) -> Crash:
        """The execution in the form of the label scorers."""
        paths = {name: Path(t.t_s, t.pose, self.sizes[name]) for name, t in self.tracks.items()}
        return Crash(paths, self.graph)

    @cached_property
    def told(self) -> Mapping[str, Fact]:
        """Facts read of the report, by name."""
        return {fact.field: fact for fact in self.reading.facts}

    def touch(self, t_s: float, pair: tuple[str, str]) -> ObservedContact:
        """A contact that begins at a time, with the sides that touch."""
        a, b = (self.tracks[name] for name in pair)
        return observe(a, b, int(np.abs(a.t_s - t_s).argmin()), self.sizes)

    def item(self, has: bool, field: str, value: Value, seen: Value = None, *, why: str = "", text: str = "") -> Item:
        """A stated item that the scenario has, or lacks and why; its sentence is that of the field's fact."""
        fact = self.told.get(field)
        place = (fact.start, fact.end) if fact else (None, None)
        subject = ".".join(field.split(".")[:2]) if field.startswith(("roads", "contacts", "impacts")) else ""
        subject = subject or (field.split(".")[1] if field.startswith(("vehicles", "others")) else field.split(".")[0])
        return Item(
            kind="has" if has else "lacks", field=field, subject=subject, value=value, seen=None if has else seen,
            text=text or phrase(field, value), reason="" if has else why, start=place[0], end=place[1],
        )  # fmt: skip


def is_stated(fact: Fact) -> bool:
    """Whether a sentence or an edit states the fact; inferred facts are not stated."""
    return fact.basis == "person" or (fact.basis == "text" and fact.status == "stated")
