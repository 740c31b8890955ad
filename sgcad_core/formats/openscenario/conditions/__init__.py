"""OpenSCENARIO triggers as functions of the scene: one module a family of conditions."""

from sgcad_core.formats.openscenario.conditions import by_value, kinematic, spatial
from sgcad_core.formats.openscenario.conditions.rules import BY_ENTITY, BY_VALUE
from sgcad_core.formats.openscenario.conditions.trigger import Trigger

MODULES = (by_value, kinematic, spatial)
"""Importing them fills the families."""

__all__ = ["BY_ENTITY", "BY_VALUE", "Trigger"]
