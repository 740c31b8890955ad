"""The plugin catalogue: entry points, read once, imported when named.

Built-ins come through the same door as strangers (`sgcad.<kind>` groups). Knows no plugin.
"""

from __future__ import annotations

import difflib
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING

from sgcad_core import interfaces
from sgcad_core.errors import ConfigError

if TYPE_CHECKING:
    from sgcad_core.interfaces import Plugin

BASES: dict[str, type[Plugin]] = {
    base.kind: base
    for base in (
        interfaces.ReportReader, interfaces.Retriever, interfaces.Backbone, interfaces.Decoder,
        interfaces.RoadWriter, interfaces.ScenarioWriter, interfaces.Validator, interfaces.Simulator,
        interfaces.Driver, interfaces.Tracker,
    )
}  # fmt: skip
KINDS: tuple[str, ...] = tuple(BASES)


@cache
def catalogue(kind: str) -> dict[str, EntryPoint]:
    """Installed plugins of a kind by name; imports none of them."""
    return {point.name: point for point in sorted(entry_points(group=f"sgcad.{kind}"), key=lambda p: p.name)}


@cache
def plugin_class(kind: str, name: str) -> type[Plugin]:
    """Import one plugin. Raises ConfigError naming the nearest and all installed names."""
    known = catalogue(kind)
    if name not in known:
        near = difflib.get_close_matches(name, known, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise ConfigError(f"unknown {kind} {name!r}.{hint} Installed: {', '.join(known) or 'none'}")
    try:
        found = known[name].load()
    except (ImportError, AttributeError) as fault:
        raise ConfigError(f"{kind} {name!r} ({known[name].value}) cannot be imported: {fault}") from fault
    if not (isinstance(found, type) and issubclass(found, BASES[kind])):
        raise ConfigError(
            f"{kind} {name!r} ({known[name].value}) is no {BASES[kind].__name__}: derive it from that class"
        )
    return found
