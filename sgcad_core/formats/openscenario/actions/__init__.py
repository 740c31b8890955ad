"""OpenSCENARIO actions as functions that set a body's path and speed: one module a family.

What is not supported raises Unsupported when it is compiled, not when it is reached.
"""

from sgcad_core.formats.openscenario.actions import control, lateral, presence, routing, spacing, speed, world
from sgcad_core.formats.openscenario.actions.running import GLOBAL, PRIVATE, ActionStart, GlobalEffect, RunningAction
from sgcad_core.formats.openscenario.reading.elements import XmlNode

MODULES = (control, lateral, presence, routing, spacing, speed, world)
"""Importing them fills the families."""


def private_action(node: XmlNode) -> ActionStart:
    """Compile a <PrivateAction>."""
    return PRIVATE.compile(node.only())


def global_action(node: XmlNode) -> GlobalEffect:
    """Compile a <GlobalAction>."""
    return GLOBAL.compile(node.only())


__all__ = ["GLOBAL", "PRIVATE", "ActionStart", "GlobalEffect", "RunningAction", "global_action", "private_action"]
