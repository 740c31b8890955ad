"""What the signals beside each approach show while a run is played, for the player.

A signal is that of the traffic that goes straight on, where there is some; turn arrows of their own are not drawn.
Knows the lane graph and the scenario's plan.
"""

from __future__ import annotations

from typing import NamedTuple

from sgcad_core.case.records import Floats
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.rules.lights import Lights, lights_of


class SignalShown(NamedTuple):
    """An approach, and from which sample on its signal shows what: [[0, "red"], [84, "green"]]."""

    edge: str
    changes: list[tuple[int, str]]


def signals_shown(graph: LaneGraph, xosc: str | None, plan_s: Floats) -> list[SignalShown]:
    """All signals with a plan; `plan_s`: (n,) time of the plan at every sample. None are given where it is not told."""
    lights = lights_of(graph, xosc)
    return [] if lights is None else shown_by(lights, plan_s)


def shown_by(lights: Lights, plan_s: Floats) -> list[SignalShown]:
    """The signals of a plan."""
    found = []
    for edge in lights.graph.edges.values():
        links = [c for c in lights.graph.leaving(edge.id) if c.light]
        link = next((c for c in links if c.direction == "through"), links[0] if links else None)
        if link is None:
            continue
        states = [shown.state if (shown := lights.at(link, float(t))) else "" for t in plan_s]
        changes = [(k, s) for k, s in enumerate(states) if k == 0 or states[k - 1] != s]
        found.append(SignalShown(edge.id, changes))
    return found
