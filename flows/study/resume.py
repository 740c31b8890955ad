"""A study begun before, found again by its name alone: which file, which cases, which overrides it was given.

    again.before(Path("alpha"), Path("runs"))      # what runs/studies/alpha/study.json remembers

What a new command says goes before what is remembered. Reads study.json only.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from flows.case_files.find_cases import safe_id
from flows.study.plan import DOCUMENT, folder_of
from sgcad_core.errors import ConfigError


@dataclass(frozen=True)
class Before:
    """What a study was given when it was begun; empty where none was."""

    file: Path
    cases: tuple[Path, ...] = ()
    truth: Path | None = None
    overrides: tuple[str, ...] = ()


def before(asked: Path, out: Path) -> Before:
    """What is remembered of a study, named by its file or its name. Raises ConfigError: its cases are gone."""
    document = folder_of(safe_id(asked.stem), out) / DOCUMENT
    try:
        about = json.loads(document.read_text(encoding="utf-8"))
        again, truth = about["again"], about["truth"]
        known = Before(
            Path(again["file"]), tuple(map(Path, again["cases"])), Path(truth) if truth else None, tuple(again["set"])
        )
    except (OSError, ValueError, KeyError, TypeError):
        return Before(asked)
    if asked.is_file() and asked.resolve() != known.file:
        return Before(asked)  # another study of the same name: its own cases, or none
    return known if known.file.is_file() else Before(asked, known.cases, known.truth, known.overrides)


def cases_of(known: Before, named: tuple[Path, ...]) -> tuple[Path, ...]:
    """The folders named now, else those remembered. Raises ConfigError where a remembered one is gone."""
    if named:
        return named
    if gone := [str(folder) for folder in known.cases if not folder.exists()]:
        raise ConfigError(f"the study was begun with {', '.join(gone)}, which is gone: name the folder with --cases")
    return known.cases
