"""Temporary folders for one step, and removal of those that killed processes left.

Each folder lies in an outer one with a lock file, which its process holds. The lock ends with the process, however that
ends, and holds between containers that share a disk; so an unlocked folder is a leftover. Knows no user of a folder.
"""

from __future__ import annotations

import glob
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock

PREFIX = "sgcad-temp-"
_LOCK, _CONTENT = "lock", "content"
_own: set[tuple[int, Path]] = set()
"""Folders that blocks hold now, with the process: a forked child inherits them and owns none."""


@contextmanager
def temp_folder(purpose: str) -> Iterator[Path]:
    """A new folder (0700) in the system's temporary folder, removed with the block; `purpose`: letters a-z only."""
    with _locked_folder(Path(tempfile.gettempdir()), f"{PREFIX}{purpose}-") as folder:
        yield folder


@contextmanager
def folder_beside(target: Path) -> Iterator[Path]:
    """A new folder (0700) on the disk of a target, to be renamed to the target once complete; otherwise removed.

    Leftovers of the same target are removed first. Raises OSError: the place cannot be written.
    """
    prefix = f".{target.name}-partial-"
    _remove_leftovers(target.parent, prefix)
    with _locked_folder(target.parent, prefix) as folder:
        yield folder


def leftover_folders() -> list[Path]:
    """Folders of this user in the temporary folder whose process was killed."""
    return list(_leftovers(Path(tempfile.gettempdir()), PREFIX))


def remove_leftover_folders() -> int:
    """Removes what killed processes left in the temporary folder; returns the number of folders."""
    return _remove_leftovers(Path(tempfile.gettempdir()), PREFIX)


def remove_own_folders() -> None:
    """Removes the folders that this process holds; for its end where blocks are not left in order."""
    for process, folder in list(_own):
        if process == os.getpid():
            shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def _locked_folder(place: Path, prefix: str) -> Iterator[Path]:
    outer, lock = _new_locked(place, prefix)
    _own.add(mine := (os.getpid(), outer))
    try:
        (folder := outer / _CONTENT).mkdir(mode=0o700)
        yield folder
    finally:
        shutil.rmtree(outer, ignore_errors=True)
        _own.discard(mine)
        lock.release()


def _new_locked(place: Path, prefix: str) -> tuple[Path, FileLock]:
    """A new folder and its lock. Before it is locked another process may remove it as a leftover: then once more."""
    while True:
        outer = Path(tempfile.mkdtemp(prefix=prefix, dir=place))
        with suppress(FileNotFoundError):
            lock = FileLock(outer / _LOCK)
            lock.acquire()
            return outer, lock


def _remove_leftovers(place: Path, prefix: str) -> int:
    count = 0
    for folder in _leftovers(place, prefix):
        shutil.rmtree(folder, ignore_errors=True)
        count += 1
    return count


def _leftovers(place: Path, prefix: str) -> Iterator[Path]:
    """Folders of this module without a living process; each is locked until the next one is asked for."""
    for folder in place.glob(f"{glob.escape(prefix)}*"):
        if _is_own(folder, prefix):
            with suppress(OSError), FileLock(folder / _LOCK, blocking=False):
                yield folder


def _is_own(folder: Path, prefix: str) -> bool:
    """Whether it is a folder of this user with a name that this module gives; no link."""
    try:
        about = folder.lstat()
    except OSError:
        return False
    named = re.fullmatch(rf"{re.escape(prefix)}([a-z]+-)?[a-z0-9_]{{8}}", folder.name)
    return bool(named) and stat.S_ISDIR(about.st_mode) and about.st_uid == os.getuid()
