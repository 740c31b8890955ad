"""`sgcad plugins list | show | new`: the installed plugins, and the template of a new one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

plugins_app = typer.Typer(
    no_args_is_help=True, help="Installed plugins: `list`, `show NAME`; a new one: `new KIND NAME`."
)


@plugins_app.command("list")
def plugins_list() -> None:
    """List every installed plugin by kind."""
    from flows.catalogue import list_plugins

    list_plugins()


@plugins_app.command("show")
def plugins_show(name: Annotated[str, typer.Argument(help="A plugin's name, or kind/name.")]) -> None:
    """Show a plugin's description and its fields with types and defaults."""
    from flows.catalogue import show_plugin

    show_plugin(name)


@plugins_app.command("new")
def plugins_new(
    kind: Annotated[str, typer.Argument(help="One of the kinds of `sgcad plugins list`.")],
    name: Annotated[str, typer.Argument(help="Its name in a YAML: lower-case letters, digits, _.")],
    into: Annotated[Path, typer.Option("--into", help="Folder to write the package into.")] = Path(),
) -> None:
    """Write a package with a working plugin, its test and a config that uses it."""
    from flows.scaffolding import new

    files = new(kind, name, into)
    for file in files:
        typer.echo(str(file))
    folder = files[0].parent
    typer.echo(f"next: pip install -e {folder} && python -m pytest {folder}/tests && sgcad check {folder}/{name}.yaml")
