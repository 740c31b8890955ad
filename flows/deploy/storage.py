"""A folder at any fsspec address (file, s3://, gs://, memory://), with the few operations that an inbox needs.

One process at a time changes it. A process killed in any of them leaves what the next one can finish.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any

from sgcad_core.errors import ConfigError, MissingTool

HIDDEN = ".inbox"
"""Folder of the ledger, tries, lock and unfinished moves; no reports."""
LEAVING = f"{HIDDEN}/leaving"
_TIMES = ("mtime", "LastModified", "last_modified", "updated", "created")


@dataclass(frozen=True)
class Stamp:
    """A file in a listing; `modified` in seconds since 1970, 0 if the store does not give it."""

    name: str
    size: int
    modified: float


@dataclass(frozen=True)
class Entry:
    """A file or folder directly under the address; names of `files` are relative to it, "" for the file itself."""

    name: str
    is_folder: bool
    files: tuple[Stamp, ...]

    @property
    def newest(self) -> float:
        """Time of the last change of its files."""
        return max((f.modified for f in self.files), default=0.0)

    def path(self, file: Stamp) -> str:
        """A file's path below the address."""
        return f"{self.name}/{file.name}" if file.name else self.name


@dataclass(frozen=True)
class Place:
    """One address; paths given to its methods are relative to it."""

    address: str
    fs: Any = field(init=False, repr=False)
    root: str = field(init=False)

    def __post_init__(self) -> None:
        from fsspec.core import url_to_fs

        try:
            fs, root = url_to_fs(self.address, use_listings_cache=False)
        except ImportError as fault:
            raise MissingTool(f"{self.address}: {fault} (`pip install 'sg-cadvlm[hosts]'` brings s3fs)") from fault
        except ValueError as fault:
            raise ConfigError(
                f"{self.address}: cannot be opened ({fault}); give a folder or an address such as s3://bucket/folder"
            ) from fault
        object.__setattr__(self, "fs", fs)
        object.__setattr__(self, "root", root.rstrip("/"))

    @property
    def is_local(self) -> bool:
        """Whether these are files of this machine (or one that it mounts)."""
        return "file" in ([self.fs.protocol] if isinstance(self.fs.protocol, str) else self.fs.protocol)

    def path(self, name: str) -> str:
        """A name's path as the file system wants it."""
        return f"{self.root}/{name}"

    # ------------------------------------------------------------------ looking
    def entries(self) -> list[Entry]:
        """Files and folders directly in the address, by name, without hidden ones; empty if it does not exist."""
        for note in () if self.is_local else self._list(LEAVING):
            self._leave(f"{LEAVING}/{note}")
        names = sorted((name, about) for name, about in self._list("").items() if not name.startswith("."))
        return [entry for name, about in names if (entry := self._entry(name, about))]

    def entry(self, name: str) -> Entry | None:
        """An entry's current state; None if it is gone."""
        try:
            return self._entry(name, self.fs.info(self.path(name)))
        except OSError:
            return None

    def _entry(self, name: str, about: dict[str, Any]) -> Entry | None:
        if about["type"] == "file":
            return Entry(name, False, (_stamp("", about),))
        return Entry(name, True, tuple(self._files(name))) if about["type"] == "directory" else None

    def _files(self, folder: str) -> Iterator[Stamp]:
        above = self.path(folder)
        for path, about in sorted(self.fs.find(above, detail=True).items()):
            yield _stamp(path[path.index(above) + len(above) + 1 :], about)

    def _list(self, folder: str) -> dict[str, dict[str, Any]]:
        try:
            listed = self.fs.ls(self.path(folder) if folder else self.root, detail=True)
        except FileNotFoundError:
            return {}
        return {PurePosixPath(about["name"].rstrip("/")).name: about for about in listed}

    def read(self, name: str) -> bytes | None:
        """A file's content; None if it is not there."""
        try:
            content: bytes = self.fs.cat_file(self.path(name))
        except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
            return None
        return content

    # ------------------------------------------------------------------ changing
    def write(self, name: str, content: bytes) -> None:
        """Put a file there, whole or not at all."""
        target = self.path(name)
        if not self.is_local:
            self.fs.pipe_file(target, content)
            return
        partial = Path(f"{target}.partial")
        partial.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(content)
        partial.replace(target)

    def remove(self, name: str) -> None:
        """Take a file away, if it is there."""
        try:
            self.fs.rm_file(self.path(name))
        except FileNotFoundError:
            return

    def move(self, entry: Entry, target: str) -> None:
        """Move an entry, replacing the target. Without renames: copied, noted, and removed by the note."""
        if self.is_local:
            goal = Path(self.path(target))
            goal.parent.mkdir(parents=True, exist_ok=True)
            if goal.is_dir():
                shutil.rmtree(goal)
            Path(self.path(entry.name)).rename(goal)
            return
        for file in entry.files:
            self.fs.cp_file(self.path(entry.path(file)), self.path(target) + entry.path(file)[len(entry.name) :])
        files = [[f.name, f.size, f.modified] for f in entry.files]
        note = f"{LEAVING}/{hashlib.sha256(entry.name.encode('utf-8', 'surrogateescape')).hexdigest()}.json"
        self.write(note, json.dumps({"name": entry.name, "files": files}).encode())
        self._leave(note)

    def _leave(self, note: str) -> None:
        """Remove the files of a finished copy, unless they were written again, then its note."""
        about = json.loads(self.read(note) or '{"name": "", "files": []}')
        copied = [Stamp(*values) for values in about["files"]]
        there = self.entry(about["name"]) if copied else None
        for file in there.files if there else ():
            if there and file in copied:
                self.remove(there.path(file))
        self.remove(note)


def _stamp(name: str, about: dict[str, Any]) -> Stamp:
    value = next((about[key] for key in _TIMES if about.get(key) is not None), 0.0)
    if isinstance(value, str):
        value = datetime.fromisoformat(value.replace("Z", "+00:00"))
    return Stamp(name, int(about.get("size") or 0), value.timestamp() if isinstance(value, datetime) else float(value))
