"""`sgcad table` and `sgcad report`: from a study's folder to tables, figures and a page. Answers go to stdout."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from flows.results import writing
from flows.results.reading import Study, find_study, load_study
from flows.results.table import tables_of
from sgcad_core.errors import ConfigError

TEXT_WIDTH = 120
"""Columns where the output is no terminal."""


def table(given: Path, out: Path, truth: Path | None, only: str, files: dict[str, Path | None]) -> None:
    """Print a study's tables; `files` may name one under "csv" and one under "latex" to write too."""
    tables = tables_of(_study(given, out, truth, only))
    console = Console(emoji=False, highlight=False)
    console.width = console.width if console.is_terminal else TEXT_WIDTH
    writing.show(tables, console)
    for kind, write in (("csv", writing.as_csv), ("latex", writing.as_latex)):
        if file := files.get(kind):
            _write(file, write(tables))
            console.print(f"{kind}: {file}", soft_wrap=True, markup=False)


def _study(given: Path, out: Path, truth: Path | None, only: str) -> Study:
    return load_study(find_study(given, out), truth, only)


def _write(file: Path, text: str) -> None:
    """Write a text file. Raises ConfigError where that cannot be."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError as fault:
        raise ConfigError(f"{file}: cannot be written ({fault.strerror}); choose another place") from fault
