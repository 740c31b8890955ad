"""Phases of traffic signal controllers, as a file's <RoadNetwork> tells them: states of signals over time.

Kept for conditions; no entity heeds a signal by itself.
"""

from __future__ import annotations

from dataclasses import dataclass

from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode


@dataclass(frozen=True)
class _Controller:
    name: str
    delay_s: float
    phases: tuple[tuple[str, float, dict[str, str]], ...]

    def phase(self, t_s: float) -> tuple[str, dict[str, str]] | None:
        """Name and states at a time; phases repeat."""
        cycle = sum(duration for _, duration, _ in self.phases)
        if cycle <= 0 or t_s < self.delay_s:
            return None
        rest = (t_s - self.delay_s) % cycle
        for name, duration, states in self.phases:
            if rest < duration:
                return name, states
            rest -= duration
        return None


class SignalPlan:
    """All controllers of a file."""

    def __init__(self, root: XmlNode) -> None:
        network = root.find("RoadNetwork")
        holder = network.find("TrafficSignals") if network else None
        found = holder.children("TrafficSignalController") if holder else []
        delays = {c.text("name"): c.number("delay", 0.0) for c in found}
        self._controllers = [_controller(c, delays) for c in found]
        self._last: dict[str, str] = {}

    @property
    def phases(self) -> int:
        """How many phases a step may look at."""
        return sum(1 + len(controller.phases) for controller in self._controllers)

    def step(self, scene: Scene) -> None:
        """Set the states of this step; a state that an action set stands until the next phase."""
        for controller in self._controllers:
            phase = controller.phase(scene.t_s)
            if phase and self._last.get(controller.name) != phase[0]:
                self._last[controller.name] = phase[0]
                scene.signals[f"controller {controller.name}"] = phase[0]
                scene.signals.update(phase[1])


def _controller(node: XmlNode, delays: dict[str, float]) -> _Controller:
    phases = []
    for phase in node.children("Phase"):
        states = {s.text("trafficSignalId"): s.text("state") for s in phase.children("TrafficSignalState")}
        phases.append((phase.text("name"), phase.number("duration"), states))
    begin = node.number("delay", 0.0) + (delays.get(node.text("reference"), 0.0) if node.has("reference") else 0.0)
    return _Controller(node.text("name"), begin, tuple(phases))
