"""Plugins and configs in words: `sgcad plugins list|show`, `sgcad check`. Prints to stdout."""

from __future__ import annotations

import inspect
import json
from typing import Any

from rich.console import Console
from rich.table import Table

from flows.terminal import escape
from sgcad_core.config import SINGLE, Config
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Plugin
from sgcad_core.registry import KINDS, catalogue, plugin_class

TRAITS = ("asks_model", "needs_prior", "gives_logits", "stage")


def list_plugins() -> None:
    """All installed names with where they come from; imports none of them."""
    table = Table("kind", "name", "from")
    for kind in KINDS:
        for name, point in catalogue(kind).items():
            table.add_row(kind, name, f"{point.dist.name if point.dist else '?'}: {point.value}")
    _console().print(table)


def show_plugin(name: str) -> None:
    """Fields of every plugin of that name. Raises ConfigError naming what is installed."""
    kind, _, bare = name.rpartition("/")
    found = [k for k in KINDS if bare in catalogue(k) and kind in ("", k)]
    if not found:
        known = sorted({f"{k}/{n}" for k in KINDS for n in catalogue(k)})
        raise ConfigError(f"no plugin {name!r}; installed: {', '.join(known)}")
    for k in found:
        _show(k, bare, plugin_class(k, bare))


def _show(kind: str, name: str, plugin: type[Plugin]) -> None:
    console = _console()
    console.print(f"[bold]{kind}/{escape(name)}[/] version {escape(plugin.version)}")
    console.print(escape(inspect.cleandoc(plugin.__doc__ or "")))
    found = {trait: getattr(plugin, trait, None) for trait in TRAITS}
    traits = {trait: value for trait, value in found.items() if isinstance(value, bool | str)}
    if traits:
        console.print(escape(", ".join(f"{t}: {v}" for t, v in traits.items())))
    table = Table("field", "type", "default", "about")
    for field, schema in _fields(plugin).items():
        default = json.dumps(schema.get("default", "(required)"))
        table.add_row(field, escape(_type(schema)), escape(default), escape(str(schema.get("description", ""))))
    console.print(table if table.row_count else "no fields")


def _fields(plugin: type[Plugin]) -> dict[str, dict[str, Any]]:
    fields: dict[str, dict[str, Any]] = plugin.model_json_schema().get("properties", {})
    return fields


def _type(schema: dict[str, Any]) -> str:
    if "anyOf" in schema:
        return " or ".join(_type(part) for part in schema["anyOf"])
    if "enum" in schema:
        return " | ".join(map(str, schema["enum"]))
    bounds = {"minimum": ">=", "maximum": "<=", "exclusiveMinimum": ">", "exclusiveMaximum": "<"}
    limits = [f"{sign} {schema[key]}" for key, sign in bounds.items() if key in schema]
    return " ".join([str(schema.get("type", "any")), *limits])


def describe_config(config: Config) -> None:
    """Say what a config that passed its check would do."""
    console = _console()
    console.print(f"{escape(config.name)}: fine; seed {config.seed}, at most {config.max_attempts} attempts a stage")
    table = Table("kind", "plugin", "fields")
    for kind in SINGLE:
        if (plugin := getattr(config, kind)) is not None:
            table.add_row(kind, *_row(plugin))
    for entry in config.drive.drivers if config.drive else ():
        table.add_row("driver", *_row(entry.driver))
    for plugin in config.validators:
        table.add_row(f"validator ({plugin.stage})", *_row(plugin))
    console.print(table)


def _row(plugin: Plugin) -> tuple[str, str]:
    fields = plugin.model_dump(mode="json")
    return escape(type(plugin).__name__), escape(", ".join(f"{k}={v}" for k, v in fields.items()))


def _console() -> Console:
    return Console(emoji=False, highlight=False)
