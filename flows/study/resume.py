"""The file, cases and overrides of a study started before, read from study.json by the study's name.

    resume.former_arguments(Path("alpha"), Path("runs"))      # from runs/studies/alpha/study.json

Arguments of the new command override them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from flows.case_files.find_cases import safe_id
from flows.study.plan import DOCUMENT, folder_of
from sgcad_core.errors import ConfigError


@dataclass(frozen=True)
class FormerArguments:
    """The arguments with which a study was started; empty if it is new."""

    file: Path
    cases: tuple[Path, ...] = ()
    truth: Path | None = None
    overrides: tuple[str, ...] = ()


def former_arguments(asked: Path, out: Path) -> FormerArguments:
    """The arguments with which a study, given by file or name, was started."""
    document = folder_of(safe_id(asked.stem), out) / DOCUMENT
    try:
        about = json.loads(document.read_text(encoding="utf-8"))
        again, truth = about["again"], about["truth"]
        known = FormerArguments(
            Path(again["file"]), tuple(map(Path, again["cases"])), Path(truth) if truth else None, tuple(again["set"])
        )
    except (OSError, ValueError, KeyError, TypeError):
        return FormerArguments(asked)
    if asked.is_file() and asked.resolve() != known.file:
        return FormerArguments(asked)  # another study of the same name: its own cases, or none
    return known if known.file.is_file() else FormerArguments(asked, known.cases, known.truth, known.overrides)


def cases_of(known: FormerArguments, named: tuple[Path, ...]) -> tuple[Path, ...]:
    """The folders named now, else the former ones. Raises ConfigError where a former one is gone."""
    if named:
        return named
    if gone := [str(folder) for folder in known.cases if not folder.exists()]:
        raise ConfigError(f"the study was started with {', '.join(gone)}, which is gone: name the folder with --cases")
    return known.cases
