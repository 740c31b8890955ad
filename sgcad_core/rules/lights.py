"""What the traffic signals of a map show over time, by connection: the plan of a scenario file.

The plan's controllers are numbered as in the map that is written beside it (`control_of`). Knows the lane graph and the
two files' terms; no actor.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from sgcad_core.formats.opendrive.signals import control_of, shown_in_turn
from sgcad_core.formats.opendrive.streets import streets
from sgcad_core.formats.xml import parse_xml
from sgcad_core.roads.lane_graph import Connection, LaneGraph


class Shown(NamedTuple):
    """What a signal shows at an instant, and for how long it has shown it."""

    state: str
    since_s: float


class Turn(NamedTuple):
    """What one controller shows in turn, from time 0 on and again: (seconds, state)."""

    phases: tuple[tuple[float, str], ...]

    def at(self, t_s: float) -> Shown | None:
        """What it shows at a time; None where it has no duration."""
        cycle = sum(seconds for seconds, _ in self.phases)
        if cycle <= 0:
            return None
        rest = t_s % cycle
        for number, (seconds, state) in enumerate(self.phases):
            if rest < seconds:
                return Shown(state, rest + self._before(number, state))
            rest -= seconds
        return None

    def _before(self, number: int, state: str) -> float:
        """Seconds for which the phases before one show its state too; at most a cycle."""
        total = 0.0
        for back in range(1, len(self.phases)):
            seconds, shown = self.phases[number - back]
            if shown != state:
                break
            total += seconds
        return total


@dataclass(frozen=True, eq=False)
class Lights:
    """The plan by program and what a connection shows in turn on the map."""

    turns: Mapping[tuple[str, tuple[str, ...]], Turn]
    graph: LaneGraph

    def at(self, link: Connection, t_s: float) -> Shown | None:
        """What the signal of a connection shows; None where the plan does not say."""
        turn = self.turns.get((link.light, shown_in_turn(self.graph, link)))
        return turn.at(t_s) if turn else None


def lights_of(graph: LaneGraph, xosc: str | None) -> Lights | None:
    """The plan of a scenario file; None where it has none. Raises InvalidOutput where the file is no XML."""
    if not graph.programs or not xosc:
        return None
    root = parse_xml(xosc, "scenario.xosc")
    told = {
        str(c.get("name")): tuple(
            (float(p.get("duration", 0.0)), next((str(s.get("state")) for s in p.iterfind("TrafficSignalState")), ""))
            for p in c.iterfind("Phase")
        )
        for c in root.iterfind("RoadNetwork/TrafficSignals/TrafficSignalController")
    }
    if not told:
        return None
    turns = {
        (c.program, tuple(next(iter(p.states.values()), "") for p in c.phases)): Turn(told[c.id])
        for c in control_of(graph, streets(graph)).controllers
        if c.id in told
    }
    return Lights(turns, graph)
