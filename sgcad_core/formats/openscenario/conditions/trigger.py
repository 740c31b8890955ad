"""Triggers: condition groups with edges and delays, counted in steps of the clock.

What is not supported raises Unsupported when it is compiled, not when it is reached. Knows no action.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from sgcad_core.formats.openscenario.conditions.rules import BY_ENTITY, BY_VALUE, Test
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.playing.timed_motion import EPSILON
from sgcad_core.formats.openscenario.reading.elements import XmlNode

_EDGES: dict[str, Callable[[bool, bool], bool]] = {
    "rising": lambda before, now: now and not before,
    "falling": lambda before, now: before and not now,
    "risingOrFalling": lambda before, now: before is not now,
}


class Trigger:
    """Condition groups, any of which fires when all of its conditions do. `missing`: what no trigger means."""

    def __init__(self, node: XmlNode | None, missing: bool) -> None:
        groups = node.children("ConditionGroup") if node else []
        self._groups = [[_Condition(c) for c in g.children("Condition")] for g in groups]
        self._missing = missing
        self.entities: tuple[str, ...] = ()
        """Entities whose conditions made it fire."""

    def __bool__(self) -> bool:
        """Whether there is any condition at all."""
        return bool(self._groups)

    def fires(self, scene: Scene) -> bool:
        """Evaluate every condition once (their histories need it)."""
        return self.moment(scene) is not None if self._groups else self._missing

    def moment(self, scene: Scene) -> float | None:
        """When it fired, seconds: between steps if it waits for a time only, else now; None if it does not."""
        held = [[c.holds(scene) for c in group] for group in self._groups]  # all of them: edges need every step
        fired = [group for group, holds in zip(self._groups, held, strict=True) if all(holds)]
        self.entities = tuple(dict.fromkeys(name for group in fired for c in group for name in c.entities))
        return min((max((c.moment(scene) for c in group), default=scene.t_s) for group in fired), default=None)

    def close(self) -> None:
        """Note every edge that could not come because its condition held from the first."""
        for group in self._groups:
            for condition in group:
                condition.close()

    def reset(self) -> None:
        """Forget what was seen: the next execution waits anew."""
        for group in self._groups:
            for condition in group:
                condition.reset()


class _Condition:
    """One condition with its edge, delay and history."""

    def __init__(self, node: XmlNode) -> None:
        self.edge = node.choice("conditionEdge", ("none", *_EDGES), "none")
        self.delay_s = node.number("delay", 0.0)
        if not 0 <= self.delay_s <= 3600:
            raise node.fault("attribute 'delay' must lie within 0 and 3600 s", f"{self.delay_s:g}")
        self.entities: list[str] = []
        self._node, self._came = node, False
        self._held_from_s: float | None = None
        self.test = self._test(node)
        self.time_s = _time_waited_for(node)
        self.reset()

    def reset(self) -> None:
        """Forget its history."""
        self.before: bool | None = None
        self.fired: list[int] = []

    def moment(self, scene: Scene) -> float:
        """When it began to hold, as exactly as is known."""
        return scene.t_s if self.time_s is None else min(self.time_s + self.delay_s, scene.t_s)

    def holds(self, scene: Scene) -> bool:
        """Evaluate it at this step."""
        now = self.test(scene)
        fires = now if self.edge == "none" else self.before is not None and _EDGES[self.edge](self.before, now)
        if now and self.before is None and self._held_from_s is None:
            self._held_from_s = scene.t_s
        self.before = now
        if fires:
            self._came = True
            self.fired.append(scene.step)
        due = scene.step - math.ceil(self.delay_s / scene.dt_s - EPSILON)
        self.fired = [step for step in self.fired if step >= due]
        return due in self.fired

    def close(self) -> None:
        """Note a rising edge that never came, though the condition held: from before it was looked at."""
        if self.edge == "rising" and self._held_from_s is not None and not self._came:
            why = f"it holds already at {self._held_from_s:g} s, when it is looked at first"
            self._node.note("the rising edge of this condition never comes", why, 'write conditionEdge="none"')

    def _test(self, node: XmlNode) -> Test:
        children = node.children("ByValueCondition", "ByEntityCondition")
        if len(children) != 1:
            raise node.fault("needs one <ByValueCondition> or <ByEntityCondition>", str(len(children)))
        if children[0].tag == "ByEntityCondition":
            return self._by_entity(children[0])
        return BY_VALUE.compile(children[0].only())

    def _by_entity(self, node: XmlNode) -> Test:
        triggering = node.need("TriggeringEntities")
        names = [ref.text("entityRef") for ref in triggering.children("EntityRef")]
        if not names:
            raise triggering.fault("names no entity", remedy="add an <EntityRef>")
        quantifier = any if triggering.choice("triggeringEntitiesRule", ("any", "all")) == "any" else all
        test = BY_ENTITY.compile(node.need("EntityCondition").only())

        def tested(scene: Scene) -> bool:
            members = [m for name in names for m in scene.members(name, triggering)]
            held = [scene.bodies[m].present and test(scene, m) for m in members]  # all: standing still is timed
            self.entities = [m for m, holds in zip(members, held, strict=True) if holds]
            return quantifier(held)

        return tested


def _time_waited_for(node: XmlNode) -> float | None:
    for time in (c.find("SimulationTimeCondition") for c in node.children("ByValueCondition")):
        if time and time.text("rule") in ("greaterThan", "greaterOrEqual"):
            return time.number("value")
    return None
