"""`sgcad plugins list | show | new`: what is installed, and the beginning of one of your own."""

from __future__ import annotations

from typing import Annotated

import typer

plugins_app = typer.Typer(no_args_is_help=True, help="What is installed: `list`, `show NAME`, `new KIND NAME`.")


@plugins_app.command("list")
def plugins_list() -> None:
    """Every installed plugin, kind by kind."""
    from flows.catalogue import list_plugins

    list_plugins()


@plugins_app.command("show")
def plugins_show(name: Annotated[str, typer.Argument(help="A plugin's name, or kind/name.")]) -> None:
    """A plugin's job and its fields with types and defaults."""
    from flows.catalogue import show_plugin

    show_plugin(name)
