"""An action under way, and what every family of actions shares: claims on a body, transitions, target speeds.

Knows no trigger.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import STEEPEST
from sgcad_core.formats.openscenario.reading.elements import XmlNode

Test = Callable[[Scene], bool]


@dataclass(eq=False)
class RunningAction:
    """An action under way. A newer action in the same domain of the same body ends it."""

    body: Body
    domains: tuple[str, ...]
    over: Test
    release_when_over: bool = True
    control: Callable[[Scene], None] | None = None
    """Runs at every step while it lasts, before the bodies move."""

    def done(self, scene: Scene) -> bool:
        """Whether it has ended; what it controlled is then free."""
        if not self._in_control():
            return True
        if over := self.over(scene):
            self.stop(self.release_when_over)
        return over

    def stop(self, release: bool = True) -> None:
        """End it."""
        for domain in self.domains:
            if self.body.owners.get(domain) is self:
                del self.body.owners[domain]
                if release:
                    self.body.release(domain)

    def claim(self) -> RunningAction:
        """Take control."""
        for domain in self.domains:
            self.body.owners[domain] = self
        return self

    def _in_control(self) -> bool:
        return all(self.body.owners.get(domain) is self for domain in self.domains)


ActionStart = Callable[[Scene, str], RunningAction]
"""Starts a private action for an actor."""
GlobalEffect = Callable[[Scene], None]
"""Carries out a global action."""
PRIVATE: Family[ActionStart] = Family("private action")
GLOBAL: Family[GlobalEffect] = Family("global action")


def control(scene: Scene) -> None:
    """Let every action that controls its body step by step do so."""
    for body in scene.bodies.values():
        for owner in dict.fromkeys(body.owners.values()):
            if isinstance(owner, RunningAction) and owner.control and not owner.over(scene):
                owner.control(scene)


def at_once(body: Body) -> RunningAction:
    """An action that has ended when it has begun."""
    return RunningAction(body, (), lambda scene: True)


def nested(family: Family[ActionStart], node: XmlNode) -> ActionStart:
    """Compile the one action that an element of a family holds."""
    return family.compile(node.only())


class Dynamics(NamedTuple):
    """Shape, dimension and value of a transition."""

    shape: str
    dimension: str
    value: float

    def seconds(self, first_mps: float, last_mps: float) -> float:
        """Duration of a change of speed; the shapes are symmetric, so a distance is covered at the mean speed.

        Where the speed changes its sign, both parts of the way count.
        """
        change = abs(last_mps - first_mps)
        if self.shape == "step" or not self.value:
            return 0.0
        if self.dimension == "time":
            return self.value
        if self.dimension == "rate":
            return STEEPEST[self.shape] * change / self.value
        if first_mps * last_mps < 0:
            return 2 * self.value * change / (first_mps**2 + last_mps**2)
        return 2 * self.value / abs(first_mps + last_mps) if change else 0.0


def dynamics(node: XmlNode) -> Dynamics:
    """Read a transition; without a span (value 0) it happens at once, whatever its shape."""
    shape = node.choice("dynamicsShape", STEEPEST)
    value = node.number("value", 0.0 if shape == "step" else None)
    dimension = node.choice("dynamicsDimension", ("time", "rate", "distance"), "time")
    if value < 0 and dimension == "rate":
        node.doubt("a rate has no sign: the target says where it leads", f"{value:g}", "leave the sign out")
        value = abs(value)
    if value < 0:
        raise node.fault("attribute 'value' must not be below 0", f"{value:g}")
    return Dynamics(shape if value or dimension == "rate" else "step", dimension, value)


def relative_speed(node: XmlNode, name: str, value: float, kind: str) -> Callable[[Scene], float]:
    """A speed relative to another entity's: a difference or a factor."""
    factor = node.choice(kind, ("delta", "factor"), "delta") == "factor"
    return lambda scene: scene.body(name, node).speed_mps * (value if factor else 1) + (0 if factor else value)
