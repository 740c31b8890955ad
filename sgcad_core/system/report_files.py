"""Files of a report from an untrusted source: only regular files inside the report's folder are read.

A link that leads out of the folder would copy a private file into the results; a pipe or a device would never end.
Knows the file system; no format.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from sgcad_core.errors import BadInput

MAX_FILE_BYTES = 50_000_000
MAX_FILES = 1000
"""In a report's folder, those below it included: more is a folder of many reports, or a link to a whole disk."""
LOCK, JOURNAL = ".lock", ".journal"
"""Suffixes of files that are no part of a report: locks, and what was before an edit that is being written."""
FACTS = "facts.yaml"
"""The file of edits, beside a report (`sgcad_core.revision`)."""


def facts_file(source: Path) -> Path:
    """Where the facts of a report are kept: in its folder, or beside a report that is a file."""
    return source / FACTS if source.is_dir() else source.with_name(f"{source.name}.{FACTS}")


def files_below(folder: Path) -> list[Path]:
    """All files in a report's folder and below, locks and journals excepted. Raises BadInput: too many."""
    found: list[Path] = []
    for looked, file in enumerate(folder.rglob("*")):
        found += [file] if file.is_file() and file.suffix not in (LOCK, JOURNAL) else []
        if looked >= MAX_FILES:
            raise BadInput(f"{folder}: more than {MAX_FILES} files and folders in it: give the folder of one report")
    return sorted(found)


def read_regular(path: Path, inside: Path | None = None, most: int = MAX_FILE_BYTES) -> bytes:
    """A regular file's bytes. Raises BadInput if it is no such file, leads out of `inside` or has over `most`."""
    if inside is not None:
        check_inside(path, inside)
    try:
        opened = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as fault:
        raise BadInput(f"{path}: cannot be read: {getattr(fault, 'strerror', None) or fault}") from fault
    about = os.fstat(opened)
    if not stat.S_ISREG(about.st_mode):
        os.close(opened)
        raise BadInput(f"{path}: is not a regular file: give a text, an XML file, a PDF or a folder with them")
    with os.fdopen(opened, "rb") as file:
        if about.st_size > most:
            raise BadInput(f"{path}: {about.st_size:,} bytes, the limit is {most:,}: cut the file")
        try:
            return file.read(most + 1)[:most]
        except OSError as fault:
            raise BadInput(f"{path}: cannot be read: {fault.strerror or fault}") from fault


def check_inside(path: Path, folder: Path) -> None:
    """Raise BadInput where a path, all its links followed, leads out of the folder."""
    if not leads_inside(path, folder):
        raise BadInput(f"{path}: leads out of its folder: put the file itself into {folder}")


def is_regular(path: Path) -> bool:
    """Whether it is a regular file, or a link to one."""
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError):
        return False


def leads_inside(path: Path, folder: Path) -> bool:
    """Whether a path, all its links followed, lies in the folder."""
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # a link that leads to itself
        return False
