"""The plugin classes: entry points, imported when named.

Built-in and third-party plugins are found in the same way (`sgcad.<kind>` groups). Knows no plugin.
"""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

from pydantic import PydanticUserError

from sgcad_core import foreign_plugins, interfaces
from sgcad_core.entry_points import catalogue, unreadable
from sgcad_core.errors import ConfigError
from sgcad_core.near_names import did_you_mean

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from sgcad_core.interfaces import Plugin

BASES: dict[str, type[Plugin]] = {
    base.kind: base
    for base in (
        interfaces.ReportReader, interfaces.Retriever, interfaces.Backbone, interfaces.Decoder,
        interfaces.RoadWriter, interfaces.ScenarioWriter, interfaces.Validator, interfaces.Simulator,
        interfaces.Driver, interfaces.Tracker,
    )
}  # fmt: skip


@cache
def plugin_class(kind: str, name: str) -> type[Plugin]:
    """Import one plugin. Raises ConfigError naming the nearest and all installed names."""
    known = catalogue(kind)
    if name not in known:
        told = f"unknown {kind} {name!r}.{did_you_mean(name, known)} Installed: {', '.join(known) or 'none'}"
        raise ConfigError("; ".join([told, *unreadable()]))
    found, where = _imported(kind, name, known[name]), f"{kind} {name!r} ({known[name].value})"
    if not (isinstance(found, type) and issubclass(found, BASES[kind])):
        raise ConfigError(f"{where} is no {BASES[kind].__name__}: derive it from that class")
    if lacks := foreign_plugins.class_faults(found, BASES[kind]):
        raise ConfigError(f"{where}: {'; '.join(lacks)}")
    return found


def _imported(kind: str, name: str, point: EntryPoint) -> object:
    """The object that an entry point names. Any failure of a third-party module is reported as its fault."""
    where = f"{kind} {name!r} ({point.value})"
    try:
        return point.load()
    except (ImportError, AttributeError) as fault:
        raise ConfigError(f"{where} cannot be imported: {fault}") from fault
    except PydanticUserError as fault:
        raise ConfigError(f"{where} is no valid plugin class: {_plainly(fault)}") from fault
    except (Exception, SystemExit) as fault:
        raise ConfigError(f"{where} fails while it is imported: {type(fault).__name__}: {fault}") from fault


def _plainly(fault: PydanticUserError) -> str:
    """Pydantic's complaint about a class; of a field without a type, with the line that mends it."""
    first = str(fault).splitlines()[0]
    if fault.code == "model-field-missing-annotation" and (named := re.search(r"`(\w+) = (.*?)`", first)):
        field, value = named.groups()
        return f"the field {field!r} has no type: write `{field}: float = {value}`, or whatever type it has"
    return first
