"""Pages of the site that are made from the code: the command line, the fields of every plugin, the interfaces.

A hook of MkDocs (mkdocs.yml); writes no file into the checkout.
"""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterator
from typing import Any

import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from flows.catalogue import TRAITS, _fields, _type
from sgcad_core.config import SCALARS, Config
from sgcad_core.entry_points import KINDS, catalogue
from sgcad_core.interfaces import Plugin
from sgcad_core.registry import plugin_class


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated pages."""
    for name, lines in (("command-line", _commands()), ("plugins", _plugins()), ("interfaces", _interfaces())):
        files.append(File.generated(config, f"reference/{name}.md", content="\n".join(lines) + "\n"))
    return files


# ------------------------------------------------------------------ command line
def _commands() -> Iterator[str]:
    from flows.cli import app

    yield "# Command line\n"
    yield "Exit codes: 0 done (a refusal is a result), 1 a case failed or was exhausted, 2 bad input or configuration,"
    yield "and nothing was started, 130 interrupted.\n"
    yield from _command("sgcad", typer.main.get_command(app))


def _command(name: str, command: Any) -> Iterator[str]:
    inner = getattr(command, "commands", {})
    if not inner:
        yield f"## {name}\n"
        yield inspect.cleandoc(command.help or "") + "\n"
        yield "| argument or option | default | about |"
        yield "|---|---|---|"
        for parameter in command.params:
            words = parameter.metavar or str(parameter.name).upper()
            called = words if parameter.param_type_name == "argument" else ", ".join(parameter.opts)
            default = parameter.default if isinstance(parameter.default, str | int | float) else None
            shown = "" if default in (None, "", False) else str(default)
            yield f"| `{called}` | {shown} | {_cell(getattr(parameter, 'help', '') or '')} |"
        yield ""
    for word, one in sorted(inner.items()):
        yield from _command(f"{name} {word}", one)


# ------------------------------------------------------------------ plugins
def _plugins() -> Iterator[str]:
    yield "# Fields of every plugin\n"
    yield "A config names one plugin a kind and sets its fields; `sgcad plugins show NAME` prints the same.\n"
    yield "## Fields of a config itself\n"
    yield "| field | default |"
    yield "|---|---|"
    for name in SCALARS:
        yield f"| `{name}` | `{json.dumps(Config.model_fields[name].default)}` |"
    for kind in KINDS:
        yield f"\n## {kind}\n"
        for name, point in catalogue(kind).items():
            if point.value.startswith("plugins."):
                yield from _plugin(kind, name, plugin_class(kind, name))


def _plugin(kind: str, name: str, plugin: type[Plugin]) -> Iterator[str]:
    yield f"### {kind}: {name}\n"
    yield inspect.cleandoc(plugin.__doc__ or "") + "\n"
    traits = {trait: getattr(plugin, trait, None) for trait in TRAITS}
    told = [f"`{trait}` {value}" for trait, value in traits.items() if isinstance(value, bool | str)]
    if told:
        yield f"{', '.join(told)}.\n"
    fields = _fields(plugin)
    if not fields:
        yield "No fields.\n"
        return
    yield "| field | type | default | about |"
    yield "|---|---|---|---|"
    for field, schema in fields.items():
        default = json.dumps(schema["default"], ensure_ascii=False) if "default" in schema else "(required)"
        about = _cell(str(schema.get("description", "")))
        yield f"| `{field}` | {_cell(_type(schema))} | `{_cell(default)}` | {about} |"
    yield ""


def _cell(text: str) -> str:
    return " ".join(text.replace("|", "\\|").replace("<", "&lt;").split())


# ------------------------------------------------------------------ interfaces
def _interfaces() -> Iterator[str]:
    yield "# Interfaces\n"
    yield "The whole extension surface, and the records that its methods take and return.\n"
    for module in (
        "sgcad_core.interfaces",
        "sgcad_core.case.records",
        "sgcad_core.case.evidence",
        "sgcad_core.errors",
    ):
        yield f"::: {module}\n"
