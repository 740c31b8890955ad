"""Descriptions of plugins and configs on stdout, for `sgcad plugins show` and `sgcad check`."""

from __future__ import annotations

import inspect
import json
import re
from typing import Any

from rich.console import Console
from rich.table import Table

from flows.batch.tracking import machine
from flows.terminal import escape
from sgcad_core.config import SINGLE, Config
from sgcad_core.entry_points import KINDS, catalogue
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.interfaces import Plugin
from sgcad_core.registry import plugin_class

MEMORY_MARGIN = 1.1
"""Memory needed over that of the weights, for caches and activations."""
TRAITS = ("asks_model", "needs_prior", "gives_logits", "stage")


def show_plugin(name: str) -> None:
    """Print the fields of every plugin of a name. Raises ConfigError naming the installed plugins."""
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
    """Print a checked config: its plugins and their fields."""
    console = _console()
    based = f"; extends {escape(config.extends)}" if config.extends else ""
    limits = f"seed {config.seed}, at most {config.max_attempts} attempts a stage"
    console.print(f"{escape(config.name)}: valid{based}; {limits}", soft_wrap=True)
    table = Table("kind", "plugin", "fields")
    for kind in SINGLE:
        if (plugin := getattr(config, kind)) is not None:
            table.add_row(kind, *_row(config.raw[kind], plugin))
    for driven in config.drive.drivers if config.drive else ():
        table.add_row("driver", *_row(driven.raw, driven.driver))
    for entry, plugin in zip(config.raw.get("validators") or (), config.validators, strict=True):
        table.add_row(f"validator ({plugin.stage})", *_row(entry, plugin))
    console.print(table)
    for line in (*served(config), memory_warning(config)):
        if line:
            console.print(escape(line), soft_wrap=True)


def served(config: Config) -> tuple[str, ...]:
    """What the server behind the backbone offers, asked now. Raises ConfigError if it lacks what the decoder needs."""
    if config.backbone is None or config.decoder is None:
        return ()
    try:
        return config.backbone.offers(config.decoder)
    except MissingTool as fault:  # a config is right before its server runs
        return (f"backbone: {fault}",)


# ------------------------------------------------------------------ memory
def memory_warning(config: Config, there: dict[str, Any] | None = None) -> str:
    """A warning if the weights are known not to fit, else an empty text. `there`: the machine as of `hardware`."""
    need = config.backbone.weights_gb() if config.backbone else None
    if need is None:
        return ""
    on_cards = getattr(config.backbone, "gpu_layers", -1) != 0
    device = str(getattr(config.backbone, "device", "auto" if on_cards else "cpu"))
    gb, where = memory_for(there or machine.hardware(), device)
    if need * MEMORY_MARGIN <= gb:
        return ""
    return (
        f"{config.name}: will not fit this machine: the weights take about {need:.0f} GB and caches more; {where}"
        f"{_remedy(config)}"
    )


def memory_for(there: dict[str, Any], device: str) -> tuple[float, str]:
    """Decimal GB that weights can have on a device, and that in words."""
    cards = [float(found[1]) * 2**20 / 1e9 for card in there["gpus"] if (found := re.search(r"(\d+) MiB", card))]
    if cards and device != "cpu":
        return sum(cards), f"there are {len(cards)} graphics cards with {sum(cards):.0f} GB together"
    gb = there["memory_gib"] * 2**30 / 1e9
    cards_told = "the config asks for the processor" if cards else "there is no graphics card"
    return gb, f"{cards_told}, and {gb:.0f} GB of memory"


def _remedy(config: Config) -> str:
    if getattr(config.backbone, "quantization", "") == "none":
        return "; try --set backbone.quantization=int4, a smaller model, or a server (openai.yaml)"
    return "; choose a smaller model, or a server (openai.yaml)"


# ------------------------------------------------------------------ printing
def _row(entry: Any, plugin: Plugin) -> tuple[str, str]:
    """The plugin's name in the YAML, and its fields."""
    name, fields = entry["name"] if isinstance(entry, dict) else entry, plugin.model_dump(mode="json")
    return escape(str(name)), escape(", ".join(f"{k}={v}" for k, v in fields.items()))


def _console() -> Console:
    return Console(emoji=False, highlight=False)
