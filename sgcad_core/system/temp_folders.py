"""Folders for the length of a step, and what killed processes left of theirs.

A folder of this module is locked while its process lives, so that another one can tell what nobody uses any more: the
lock ends with its process, however that ends, and holds between containers that share a disk. Knows no user of it.
"""

from __future__ import annotations

import fcntl
import glob
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

PREFIX = "sgcad-scratch-"


@contextmanager
def scratch(purpose: str) -> Iterator[Path]:
    """A fresh folder (0700, in the system's temporary folder) that vanishes with the block; `purpose`: a-z only.

    It lies in the one that is locked, so that whoever uses it may lock it as any folder of results.
    """
    with _held(Path(tempfile.gettempdir()), f"{PREFIX}{purpose}-") as held:
        (folder := held / "here").mkdir(mode=0o700)
        yield folder


@contextmanager
def beside(target: Path) -> Iterator[Path]:
    """A fresh folder (0700) beside a target, to be renamed to it once it is whole; if it is not, it vanishes.

    What killed processes left of the same target is removed first. Raises OSError: the place cannot be written.
    """
    prefix = f".{target.name}-partial-"
    _clear(target.parent, prefix)
    with _held(target.parent, prefix) as folder:
        yield folder


def left() -> list[Path]:
    """Folders in the temporary folder of processes that were killed: made by this user, and locked by nobody."""
    found = []
    for folder, lock in _free(Path(tempfile.gettempdir()), PREFIX):
        os.close(lock)
        found.append(folder)
    return found


def clear_left() -> int:
    """Remove what killed processes left in the temporary folder; how many folders that were."""
    return _clear(Path(tempfile.gettempdir()), PREFIX)


@contextmanager
def _held(place: Path, prefix: str) -> Iterator[Path]:
    folder, lock = _locked(place, prefix)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)


def _locked(place: Path, prefix: str) -> tuple[Path, int]:
    """A folder and its lock. Between making and locking another process may take it for a dead one's: then anew."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=prefix, dir=place))
        with suppress(FileNotFoundError):
            lock = os.open(folder, os.O_RDONLY)
            fcntl.flock(lock, fcntl.LOCK_EX)
            if folder.exists():
                return folder, lock
            os.close(lock)


def _clear(place: Path, prefix: str) -> int:
    count = 0
    for folder, lock in _free(place, prefix):
        shutil.rmtree(folder, ignore_errors=True)
        os.close(lock)
        count += 1
    return count


def _free(place: Path, prefix: str) -> Iterator[tuple[Path, int]]:
    """Folders of ours that nobody holds, each with its lock, which the caller closes."""
    for folder in place.glob(f"{glob.escape(prefix)}*"):
        if _is_ours(folder, prefix) and (lock := _lock_of(folder)) is not None:
            yield folder, lock


def _is_ours(folder: Path, prefix: str) -> bool:
    """Nothing of another user, no link, nothing that merely begins like ours."""
    try:
        about = folder.lstat()
    except OSError:
        return False
    named = re.fullmatch(rf"{re.escape(prefix)}([a-z]+-)?[a-z0-9_]{{8}}", folder.name)
    return bool(named) and stat.S_ISDIR(about.st_mode) and about.st_uid == os.getuid()


def _lock_of(folder: Path) -> int | None:
    """The lock of a folder that nobody holds; None where somebody does or it has gone."""
    try:
        lock = os.open(folder, os.O_RDONLY | os.O_NOFOLLOW)
    except OSError:
        return None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(lock)
        return None
    return lock
