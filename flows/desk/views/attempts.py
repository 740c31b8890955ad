"""The writers' attempts of a case, with what was found wrong in each."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flows.desk.views.folder_files import is_there, json_of
from sgcad_core.system.report_files import leads_inside

ATTEMPT = re.compile(r"(road|scenario)-\d{2,4}")
ATTEMPT_FILES = ("prompt.txt", "answer.txt", "findings.json")
MOST = 200
"""Attempts on a page; a stage has at most ten."""
_EMPTY = 2
"""Bytes of a file that holds nothing: `[]`, or a line's end."""


@dataclass(frozen=True)
class Attempt:
    """One attempt of a writer: its folder's name, what was found, which files there are to read."""

    name: str
    findings: tuple[str, ...]
    files: tuple[str, ...]
    seconds: float | None = None


def attempts_of(folder: Path) -> Iterator[Attempt]:
    """The writers' attempts in their order."""
    stages = {"road": 0, "scenario": 1}
    if not leads_inside(folder / "attempts", folder):
        return
    places = [p.name for p in (folder / "attempts").glob("*-*") if ATTEMPT.fullmatch(p.name)]
    for name in sorted(places, key=lambda n: (stages[n.partition("-")[0]], n))[:MOST]:
        place = f"attempts/{name}"
        found, about = json_of(folder, f"{place}/findings.json"), json_of(folder, f"{place}/attempt.json")
        lines = (_finding(f) for f in found if isinstance(f, dict)) if isinstance(found, list) else ()
        files = (file for file in ATTEMPT_FILES if _has_text(folder, f"{place}/{file}"))
        yield Attempt(name, tuple(lines), tuple(files), _seconds(about))


def _has_text(folder: Path, name: str) -> bool:
    return is_there(folder, name) and (folder / name).stat().st_size > _EMPTY


def _seconds(about: Any) -> float | None:
    seconds = about.get("seconds") if isinstance(about, dict) else None
    return float(seconds) if isinstance(seconds, float) else None


def _finding(found: Mapping[str, Any]) -> str:
    parts = [str(found.get(name) or "") for name in ("what", "where", "value", "remedy")]
    what, where, value, remedy = parts
    return f"{what}{f' at {where}' if where else ''}{f': {value}' if value else ''}{f' – {remedy}' if remedy else ''}"
