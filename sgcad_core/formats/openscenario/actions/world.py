"""Global actions: surroundings, parameters and variables, traffic signals. Traffic drawn at random is refused."""

from __future__ import annotations

from collections.abc import Callable

from sgcad_core.formats.openscenario.actions.running import GLOBAL, GlobalEffect
from sgcad_core.formats.openscenario.playing.scene import Scene
from sgcad_core.formats.openscenario.reading.elements import XmlNode

GLOBAL.refuses(
    "TrafficAction", remark="sources, sinks and swarms draw traffic at random", remedy="write each vehicle as an entity"
)
GLOBAL.refuses("SetMonitorAction", remark="monitors watch for a test bench", remedy="leave the monitor out")


@GLOBAL.plays("EnvironmentAction", remark="weather, light and friction change no told motion")
def _environment(node: XmlNode) -> GlobalEffect:
    found = node.either("Environment")
    time = found.find("TimeOfDay")
    if time is None:
        return lambda scene: None
    clock_s = seconds_of_day(time.text("dateTime", ""), time)

    def effect(scene: Scene) -> None:
        scene.clock_s = clock_s - scene.t_s

    return effect


def seconds_of_day(date_time: str, blame: XmlNode) -> float:
    """Seconds since midnight of an ISO 8601 date and time. Raises InvalidOutput."""
    try:
        hour, minute, second = date_time.split("T")[1][:8].split(":")
        return int(hour) * 3600.0 + int(minute) * 60 + int(second)
    except (IndexError, ValueError) as fault:
        raise blame.fault("attribute 'dateTime' is no date and time", date_time, "2020-06-21T12:00:00") from fault


@GLOBAL.plays("ParameterAction", "VariableAction")
def _value(node: XmlNode) -> GlobalEffect:
    """Set a value that conditions read, or add to or multiply it."""
    of_variable = node.tag == "VariableAction"
    name = node.text("variableRef" if of_variable else "parameterRef").lstrip("$")
    change = _change(node.only())

    def effect(scene: Scene) -> None:
        values = scene.variables if of_variable else scene.parameters
        if name not in values:
            raise node.fault("no such value is declared", name, f"declared: {', '.join(values) or 'none'}")
        values[name] = change(values[name])

    return effect


def _change(node: XmlNode) -> Callable[[str], str]:
    if node.tag == "SetAction":
        value = node.text("value")
        return lambda old: value
    if node.tag != "ModifyAction":
        raise node.unsupported()
    rule = node.need("Rule").only()
    value_of = rule.number("value")
    if rule.tag not in ("AddValue", "MultiplyByValue"):
        raise rule.unsupported()

    def changed(old: str) -> str:
        try:
            number = float(old)
        except ValueError as fault:
            raise rule.fault("the value to modify is no number", old) from fault
        return repr(number + value_of if rule.tag == "AddValue" else number * value_of)

    return changed


@GLOBAL.plays(
    "InfrastructureAction", remark="states of signals are kept for conditions; no entity heeds them by itself"
)
def _infrastructure(node: XmlNode) -> GlobalEffect:
    child = node.need("TrafficSignalAction").only()
    if child.tag != "TrafficSignalStateAction":
        raise child.unsupported("the player does not start a controller's phase", "set the state of each signal")
    name, state = child.text("name"), child.text("state")

    def effect(scene: Scene) -> None:
        scene.signals[name] = state

    return effect


@GLOBAL.notes("UserDefinedAction", remark="a command of the user's own: nothing happens")
def _user_defined(node: XmlNode) -> GlobalEffect:
    return lambda scene: None
