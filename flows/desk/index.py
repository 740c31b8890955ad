"""All cases below a results folder, kept in memory and read again where a result.json changed.

A thread of its own reads, so that a page never waits for 10,000 files: a page gets the rows known by then and the
number still to come. Cases are written whole or not at all (flows/case_files/case_folder.py); a result that cannot be
read becomes a row that says so. Reads only.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from flows.desk.views.folder_files import RESULT, OddResult, result_in
from flows.desk.views.list_rows import Row, row_of, unreadable
from sgcad_core.errors import BadInput

DEPTH = 4
"""Folders below the results folder in which cases are looked for: studies/<name>/<arm>/<case> is the deepest."""
NO_CASES = ("mlflow-artifacts", "mlruns", "attempts")
"""Folders that hold copies of results, or none."""
PATIENCE_S = 0.25
"""How long a page waits for the reading thread."""
FRESH_S = 0.3
"""Within this the folder is not looked through again."""
ODD = (LookupError, ValueError, TypeError, AttributeError, ArithmeticError, RecursionError)
"""What comes of going by values that no version of this program writes."""
Stamp = tuple[int, int]


@dataclass(frozen=True)
class Listing:
    """The rows that are known, by key, and how many cases are found but not read yet."""

    rows: Mapping[str, Row]
    pending: int = 0


class Index:
    """The rows of one results folder. Thread-safe."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        self._rows: dict[str, tuple[Stamp, Row]] = {}
        self._pending = 0
        self._looked = 0.0
        self._lock = threading.Lock()
        self._reader: threading.Thread | None = None

    def listing(self, wait_s: float = PATIENCE_S) -> Listing:
        """The rows known now; the folder is read again unless that was just done."""
        reader = self._refresh()
        if reader is not None:
            reader.join(wait_s)
        with self._lock:
            return Listing({key: row for key, (_, row) in self._rows.items()}, self._pending)

    def row(self, key: str) -> Row | None:
        """One case as it is on disk now; None for an unknown case. Never leaves the results folder."""
        folder = self.folder(key)
        if folder is None:
            return None
        try:
            stamp = _stamp(folder / RESULT)
        except OSError:
            with self._lock:
                self._rows.pop(key, None)
            return None
        row = self._read(key, stamp)
        with self._lock:
            self._rows[key] = (stamp, row)
        return row

    def folder(self, key: str) -> Path | None:
        """The folder of a case: a plain path below the root, links resolved; None for anything else."""
        parts = key.split("/")
        if not key or "\0" in key or any(part in ("", ".", "..") or part.startswith(".") for part in parts):
            return None
        if any(part in NO_CASES for part in parts[:-1]) or len(parts) > DEPTH:
            return None
        folder = self.root.joinpath(*parts)
        try:
            inside = folder.resolve().is_relative_to(self.root)
        except (OSError, ValueError):
            return None
        return folder if inside else None

    def _refresh(self) -> threading.Thread | None:
        """The reading thread, started if none runs and the last reading is old."""
        with self._lock:
            if self._reader and self._reader.is_alive():
                return self._reader
            if time.monotonic() - self._looked < FRESH_S:
                return None
            self._reader = threading.Thread(target=self._look, daemon=True, name="desk-index")
            self._reader.start()
            return self._reader

    def _look(self) -> None:
        found = dict(found_in(self.root))
        with self._lock:
            for key in self._rows.keys() - found.keys():
                del self._rows[key]
            stale = [k for k, stamp in found.items() if k not in self._rows or self._rows[k][0] != stamp]
            self._pending = len(stale)
        for key in stale:
            row = self._read(key, found[key])
            with self._lock:
                self._rows[key] = (found[key], row)
                self._pending -= 1
        self._looked = time.monotonic()

    def _read(self, key: str, stamp: Stamp) -> Row:
        with self._lock:
            known = self._rows.get(key)
        if known and known[0] == stamp:
            return known[1]
        try:
            return row_of(key, result_in(self.root / key))
        except BadInput as fault:
            return unreadable(key, f"{RESULT} is not read: {_briefly(fault, self.root)}")
        except OddResult as fault:
            return unreadable(key, f"{fault}; run the case again")
        except ODD as fault:
            return unreadable(key, f"{RESULT} is no result ({type(fault).__name__}: {fault}); run the case again")


def _briefly(fault: BadInput, root: Path) -> str:
    """A fault without the path of the results folder."""
    return str(fault).replace(f"{root}{os.sep}", "")


def _stamp(file: Path | str) -> Stamp:
    about = os.stat(file)
    return about.st_mtime_ns, about.st_size


def found_in(root: Path) -> Iterator[tuple[str, Stamp]]:
    """Keys and stamps of all cases below a folder; unreadable folders are passed over."""
    yield from _below(str(root), "", DEPTH)


def _below(folder: str, prefix: str, depth: int) -> Iterator[tuple[str, Stamp]]:
    try:
        with os.scandir(folder) as entries:
            inner = sorted(e.name for e in entries if _may_hold(e))
    except OSError:
        return
    for name in inner:
        place, key = os.path.join(folder, name), f"{prefix}{name}"
        try:
            yield key, _stamp(os.path.join(place, RESULT))
        except OSError:
            if depth > 1 and name not in NO_CASES:
                yield from _below(place, f"{key}/", depth - 1)


def _may_hold(entry: os.DirEntry[str]) -> bool:
    """Whether it is a folder, not hidden (unfinished cases are) and no link, with a name valid in a web address."""
    try:
        entry.name.encode()
        return not entry.name.startswith(".") and entry.is_dir(follow_symlinks=False)
    except (OSError, UnicodeEncodeError):
        return False
