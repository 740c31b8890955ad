"""Files of a report, read as what a stranger may have sent: regular files inside the report's folder, and no others.

A link that leads out of the folder would copy a private file into the results; a pipe or a device would never end.
Knows the file system; no format.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from sgcad_core.errors import BadInput

MAX_FILE_BYTES = 50_000_000


def read_regular(path: Path, inside: Path | None = None, most: int = MAX_FILE_BYTES) -> bytes:
    """A regular file's bytes. Raises BadInput if it is no such file, leads out of `inside` or has over `most`."""
    if inside is not None and not leads_inside(path, inside):
        raise BadInput(f"{path}: leads out of its folder: put the file itself into {inside}")
    try:
        opened = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as fault:
        raise BadInput(f"{path}: cannot be read: {fault.strerror or fault}") from fault
    with os.fdopen(opened, "rb") as file:
        about = os.fstat(opened)
        if not stat.S_ISREG(about.st_mode):
            raise BadInput(f"{path}: is no regular file: give a text, an XML file, a PDF or a folder with them")
        if about.st_size > most:
            raise BadInput(f"{path}: {about.st_size:,} bytes, the limit is {most:,}: cut the file")
        try:
            return file.read(most + 1)[:most]
        except OSError as fault:
            raise BadInput(f"{path}: cannot be read: {fault.strerror or fault}") from fault


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
