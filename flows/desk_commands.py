"""`sgcad desk`: what people do with finished cases. `open` shows them in a browser and is what `sgcad desk RUNS` means;
`export` makes data of what they mended.

Everything heavy is imported inside, so that --help is quick.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from flows.desk.command import open_desk


class OpensFolders(TyperGroup):
    """A group of commands that takes a folder where a command is expected: then it is `open`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """`desk RUNS --open` is `desk open RUNS --open`; `desk` alone opens the usual folder."""
        first = args[0] if args else ""
        opens = first not in self.commands and first not in ctx.help_option_names
        return super().parse_args(ctx, ["open", *args] if opens else args)


desk_app = typer.Typer(
    cls=OpensFolders,
    help="Finished cases in people's hands. `sgcad desk RUNS` opens a results folder in a browser: it is short for "
    "`sgcad desk open RUNS` and takes the same options.",
)
desk_app.command("open")(open_desk)


@desk_app.command()
def export(
    runs: Annotated[Path, typer.Argument(help="The folder of one config's cases, such as runs/template.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the pairs, the truth and the training rows.")],
) -> None:
    """What people mended, as data: pairs (read, mended), truth files for `sgcad score`, training rows."""
    from flows.desk.export_edits import export as write

    for line in write(runs, out):
        typer.echo(line)
