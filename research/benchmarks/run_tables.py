"""What commands share that print one table of a runs folder, a row for each config."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

Figures = TypeVar("Figures")


def by_config(
    runs: Path, configs: Sequence[str], figures: Callable[[], Figures], count: Callable[[Path, Figures], None]
) -> dict[str, Figures]:
    """The figures of all configs in a runs folder, or of those named; `count` adds a case's folder to them."""
    folders = [runs / c for c in configs] or sorted(p for p in runs.iterdir() if any(p.glob("*/result.json")))
    found = {folder.name: figures() for folder in folders}
    for folder in folders:
        for file in sorted(folder.glob("*/result.json")):
            count(file.parent, found[folder.name])
    return found


def options_of(about: str | None, arguments: Sequence[str] | None, cases: str = "") -> argparse.Namespace:
    """What a command was given: `runs`, `configs` and, where there is help for it, `cases`; ends without a folder."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=Path, help="the folder given to --out")
    parser.add_argument("configs", nargs="*", help="config names; default: all")
    if cases:
        parser.add_argument("--cases", action="store_true", help=cases)
    options = parser.parse_args(arguments)
    if not options.runs.is_dir():
        raise SystemExit(f"{options.runs}: no such folder; give the one that `sgcad evaluate --out` wrote")
    return options


def show(table: str) -> None:
    """Print a table."""
    sys.stdout.write(table + "\n")
