"""What a folder of cases holds: its reports, and entries that are none, which are named and never dropped silently.

Beside case folders a loose text, XML or PDF is a case of its own, unless its name says that it is about the cases.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.system.report_files import LOCK, facts_file, read_regular

TEXTS = {"report.txt", "narrative.txt"}
SUFFIXES = {".txt", ".xml", ".pdf"}
ABOUT = ("readme", "license", "licence", "notice", "changelog", "copying", "index", "manifest", "sources")
"""Names, without suffix, of files about the cases of a folder."""
LEFT_OUT = "left_out.json"
"""In the folder of a config's results, and in a study's: entries of the folders of cases that are no case."""
MOST = 10_000
FEW = 5


class Inside(NamedTuple):
    """The reports of a folder, and the names of its other entries that are not hidden; facts of loose reports belong to
    these."""

    reports: list[Path]
    left: list[str]


def inside(folder: Path) -> Inside:
    """What a folder, or a single report, holds. Raises ConfigError where there is no case."""
    if not folder.exists():
        raise ConfigError(f"{folder}: no such folder; give a folder of case folders")
    try:
        entries = sorted(e for e in folder.iterdir() if not e.name.startswith(".")) if folder.is_dir() else []
    except OSError as fault:
        raise ConfigError(f"{folder}: cannot be listed: {fault.strerror}") from fault
    if folder.is_file() or any(e.name.lower() in TEXTS for e in entries):
        return Inside([folder], [e.name for e in entries if e.is_dir() and _holds_report(e)])
    reports = [e for e in entries if e.is_dir() or _is_report(e)]
    if not reports:
        raise ConfigError(f"{folder}: it contains no case; put each report into a folder of its own, as report.txt")
    own = {*reports, *map(facts_file, reports)}
    return Inside(reports, [e.name for e in entries if e not in own and e.suffix != LOCK])


def _holds_report(folder: Path) -> bool:
    """Whether a folder beside a report holds a report itself."""
    try:
        return any(e.name.lower() in TEXTS for e in folder.iterdir())
    except OSError:
        return False


def _is_report(file: Path) -> bool:
    """Whether a loose file is a report by its name; a link that leads nowhere is none."""
    return file.suffix.lower() in SUFFIXES and file.stem.lower() not in ABOUT and file.exists()


# ------------------------------------------------------------------ entries that are no case
def left_out(folders: Iterable[Path]) -> tuple[str, ...]:
    """Entries of folders of cases that are no case, as <folder>/<name>. Raises ConfigError like `inside`."""
    return tuple(f"{folder.resolve().name}/{name}" for folder in folders for name in inside(folder).left)


def left_out_line(names: Sequence[str]) -> str:
    """The entries in a line; empty where there are none."""
    if not names:
        return ""
    more = f" and {len(names) - FEW} more" if len(names) > FEW else ""
    kinds = ", ".join(sorted(SUFFIXES))
    told = ", ".join(name.encode("utf-8", "backslashreplace").decode() for name in names[:FEW])
    return f"left out, {len(names)} beside the cases: {told}{more}; a case is a folder or {kinds}"


def write_left_out(folder: Path, names: Sequence[str]) -> None:
    """Keep the entries in a folder of results; without any there is no file."""
    file = folder / LEFT_OUT
    if names:
        text = json.dumps({"left_out": list(names)}, indent=1)  # in ASCII: a name may be no UTF-8
        file.write_text(f"{text}\n", encoding="utf-8")
    else:
        file.unlink(missing_ok=True)


def read_left_out(folder: Path) -> tuple[str, ...]:
    """The entries that a folder of results keeps; () where it keeps none that can be read."""
    try:
        names = json.loads(read_regular(folder / LEFT_OUT, folder))["left_out"]
    except (BadInput, ValueError, KeyError, TypeError, RecursionError):
        return ()
    return tuple(str(name)[:300] for name in names[:MOST]) if isinstance(names, list) else ()
