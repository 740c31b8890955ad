"""Conditions on time, storyboard states, parameters, variables and traffic signals."""

from __future__ import annotations

from sgcad_core.formats.openscenario.actions.world import seconds_of_day
from sgcad_core.formats.openscenario.conditions.rules import BY_VALUE, RULES, Test, rule, rule_of_text
from sgcad_core.formats.openscenario.playing.scene import TRANSITIONS, Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode

_STATES = ("standbyState", "runningState", "completeState")
BY_VALUE.refuses("UserDefinedValueCondition", remark="its value comes from outside", remedy="use a VariableCondition")


@BY_VALUE.plays("SimulationTimeCondition")
def _simulation_time(node: XmlNode) -> Test:
    holds = rule(node)
    return lambda scene: holds(scene.t_s)


@BY_VALUE.plays("TimeOfDayCondition", remark="needs a <TimeOfDay> in an EnvironmentAction; dates do not count")
def _time_of_day(node: XmlNode) -> Test:
    compare, clock_s = RULES[node.choice("rule", RULES)], seconds_of_day(node.text("dateTime"), node)
    return lambda scene: scene.clock_s is not None and compare(scene.clock_s + scene.t_s, clock_s)


@BY_VALUE.plays("StoryboardElementStateCondition")
def _element_state(node: XmlNode) -> Test:
    kind, ref = node.text("storyboardElementType"), node.label("storyboardElementRef")
    state = node.choice("state", (*_STATES, *TRANSITIONS))

    def test(scene: Scene) -> bool:
        stages = scene.named(kind, ref)
        node.spend("tests of conditions", len(stages))
        if not stages:
            known = ", ".join(s.path for s in scene.stages if s.kind == kind) or "none"
            raise node.fault(f"no storyboard element of type {kind!r} has this name", ref, f"there are: {known[:500]}")
        if state in _STATES:
            return any(s.state == state for s in stages)
        return any(scene.step - s.moments.get(state, -9) <= 1 for s in stages)

    return test


@BY_VALUE.plays("ParameterCondition", "VariableCondition")
def _value(node: XmlNode) -> Test:
    of_variable = node.tag == "VariableCondition"
    name, holds = node.text("variableRef" if of_variable else "parameterRef").lstrip("$"), rule_of_text(node)

    def test(scene: Scene) -> bool:
        values = scene.variables if of_variable else scene.parameters
        if name in values:
            return holds(values[name])
        if of_variable or name not in node.scope:
            node.doubt("no such value is declared", name, f"declared: {', '.join(values)[:500] or 'none'}")
            return False
        return holds(node.scope[name])

    return test


@BY_VALUE.plays("TrafficSignalCondition", remark="states that actions and controllers' phases set")
def _signal(node: XmlNode) -> Test:
    name, state = node.text("name"), node.text("state")
    return lambda scene: scene.signals.get(name) == state


@BY_VALUE.plays("TrafficSignalControllerCondition")
def _signal_controller(node: XmlNode) -> Test:
    name, phase = node.text("trafficSignalControllerRef"), node.text("phase")
    return lambda scene: scene.signals.get(f"controller {name}") == phase
