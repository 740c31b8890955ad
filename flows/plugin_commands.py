"""`sgcad plugins list | show | new` and `sgcad check`: the installed plugins, a new one, a config of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flows.terminal import escape

LONGEST = 300

plugins_app = typer.Typer(
    no_args_is_help=True, help="Installed plugins: `list`, `show NAME`; a new one: `new KIND NAME`."
)


@plugins_app.command("list")
def plugins_list() -> None:
    """List every installed plugin by kind, and what is wrong with their packages; imports none of them."""
    from rich.console import Console
    from rich.table import Table

    from sgcad_core.entry_points import KINDS, catalogue, distribution, point_fault, unreadable

    console, table, gone = Console(emoji=False, highlight=False), Table("kind", "name", "from"), list(unreadable())
    for kind in KINDS:
        for name, point in catalogue(kind).items():
            origin = f"{distribution(point.dist)}: {point.value}"
            if fault := point_fault(point):
                gone.append(f"{kind}/{name} is registered by {origin}, which {fault}: reinstall that package")
            else:
                table.add_row(kind, _short(name), _short(origin))
    console.print(table)
    for line in gone:
        console.print(_short(line), soft_wrap=True)


def _short(text: str) -> str:
    """The text for a terminal; a stranger's name may be as long as a book."""
    return escape(text if len(text) <= LONGEST else f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}")


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


def check(
    config: Annotated[Path, typer.Argument(help="The YAML of a config or of a study.")],
    overrides: Annotated[
        list[str] | None, typer.Option("--set", help="Override KEY=VALUE, such as decoder.alpha=0.3.")
    ] = None,
) -> None:
    """Check a config, or all arms of a study, without starting anything."""
    from flows.catalogue import describe_config
    from flows.study_file import spec
    from flows.study_file.arm_config import load_config

    if study_file := spec.study_in(config):
        from flows.study import plan

        typer.echo(plan.described(spec.load_study(study_file), tuple(overrides or ())))
        return
    describe_config(load_config(config, tuple(overrides or ())))
