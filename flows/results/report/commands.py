"""`sgcad table`, `sgcad report` and `sgcad score`: tables, figures and a page of a study. Answers go to stdout.

Heavy modules are imported inside, so that --help is quick.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from flows.results.report.plots import Plot
    from flows.results.table import Tables

TEXT_WIDTH = 120
"""Columns where the output is no terminal."""
PAGE = "report.html"

StudyPath = Annotated[Path, typer.Argument(help="A study's folder or its name, or a folder of runs.")]
Out = Annotated[Path, typer.Option("--out", "-o", help="Folder of the results, in which a study is found by name.")]
Truth = Annotated[Path | None, typer.Option("--truth", help="Folder of <case>.json; default: the study's own.")]
Only = Annotated[str, typer.Option("--only", help="Only cases whose name begins with this.")]


def table(
    study: StudyPath,
    out: Out = Path("runs"),
    truth: Truth = None,
    only: Only = "",
    csv: Annotated[
        Path | None, typer.Option("--csv", help="Write one figure per line to this file, in full precision.")
    ] = None,
    latex: Annotated[
        Path | None, typer.Option("--latex", help="Write the tables for LaTeX (booktabs) to this file.")
    ] = None,
) -> None:
    """Print a study's tables: every arm with n, 95 % intervals and paired tests, published figures apart."""
    from rich.console import Console

    from flows.results import writing

    tables = _tables(study, out, truth, only)
    console = Console(emoji=False, highlight=False)
    console.width = console.width if console.is_terminal else TEXT_WIDTH
    writing.show(tables, console)
    for file, write in ((csv, writing.as_csv), (latex, writing.as_latex)):
        if file:
            _write(file, write(tables).encode("utf-8"))
            typer.echo(f"written: {file}")


def report(
    study: StudyPath,
    out: Out = Path("runs"),
    truth: Truth = None,
    only: Only = "",
    html: Annotated[
        Path | None, typer.Option("--html", help="Path of the page; default: report.html in the study's folder.")
    ] = None,
    figures: Annotated[
        Path | None, typer.Option("--figures", help="Write the figures as PNG into this folder.")
    ] = None,
) -> None:
    """Write one HTML file with a study's tables, figures and cases; it needs no server and no network."""
    from flows.results.report.drive_frames import drive_frames
    from flows.results.report.page import page
    from flows.results.report.plots import plots_of
    from flows.results.report.scenes import scenes_of

    tables = _tables(study, out, truth, only)
    plots = [*plots_of(tables), *scenes_of(tables), *drive_frames(tables)]
    place = html or tables.study.folder / PAGE
    _write(place, page(tables, plots, place).encode("utf-8"))
    if figures:
        _write_figures(figures, plots)
    for line in (*tables.remarks, *(f"figure left out: {p.title}: {p.reason}" for p in plots if p.png is None)):
        typer.echo(line)
    typer.echo(f"look at: {place}")


def _tables(given: Path, out: Path, truth: Path | None, only: str) -> Tables:
    from flows.results.reading import find_study, load_study
    from flows.results.table import tables_of

    return tables_of(load_study(find_study(given, out), truth, only))


def _write_figures(folder: Path, plots: Iterable[Plot]) -> None:
    for plot in plots:
        if plot.png is not None:
            _write(folder / f"{plot.key}.png", plot.png)


def _write(file: Path, content: bytes) -> None:
    """Write a file. Raises ConfigError where that cannot be."""
    from sgcad_core.errors import ConfigError

    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    except OSError as fault:
        raise ConfigError(f"{file}: cannot be written ({fault.strerror}); choose another path") from fault


def score(
    runs: Annotated[Path, typer.Argument(help="The folder of one config's cases, such as runs/template.")],
    truth: Annotated[Path | None, typer.Argument(help="A folder of truth files, <case>.json.")] = None,
    labels: Annotated[
        Path | None, typer.Option("--labels", help="A folder of labels of the whole crash course.")
    ] = None,
    second: Annotated[
        Path | None, typer.Option("--second", help="A second reading of the same labels; only fields that agree count.")
    ] = None,
    only: Annotated[str, typer.Option("--only", help="Only cases whose name begins with this.")] = "",
    each: Annotated[bool, typer.Option("--cases", help="List the cases with a wrong field.")] = False,
    file: Annotated[Path | None, typer.Option("--json", help="Write all marks to a file.")] = None,
) -> None:
    """Compare runs with the truth of their cases: roads, motion, contacts, evasion, rest, later impacts."""
    from flows.results import label_scoring  # only where it is asked for: --help is to be quick

    scored = label_scoring.score(runs, truth, labels, second, only)
    if file:
        file.write_text(label_scoring.as_json(scored), encoding="utf-8")
    typer.echo(scored.text(each))
