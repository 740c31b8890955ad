"""A folder at any fsspec address (file, s3://, gs://, memory://), with the few operations that an inbox needs.

Guarantees differ by store and are given per operation: `create` is exclusive on local files (a
hard link) and where the store has conditional writes (S3, Google, Azure through fsspec's create mode); elsewhere it
looks first and reads back afterwards, which fails for two writers in the same instant.
"""

from __future__ import annotations

import json
import os
import shutil
import uuid
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any

from sgcad_core.errors import ConfigError, MissingTool

HIDDEN = ".inbox"
"""Folder of claims, ledger and half-written files; no reports."""
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
        self._finish_moves()
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
        if about["type"] != "directory":
            return None
        found = self.fs.find(self.path(name), detail=True)
        files = (_stamp(self._below(path, name), inner) for path, inner in sorted(found.items()))
        return Entry(name, True, tuple(files))

    def _list(self, name: str) -> dict[str, dict[str, Any]]:
        try:
            listed = self.fs.ls(self.path(name) if name else self.root, detail=True)
        except FileNotFoundError:
            return {}
        return {PurePosixPath(about["name"].rstrip("/")).name: about for about in listed}

    def names(self, folder: str) -> list[str]:
        """Names in a folder; none if it is not there."""
        return sorted(self._list(folder))

    def _below(self, path: str, name: str) -> str:
        return path[path.index(self.path(name)) + len(self.path(name)) + 1 :]

    def read(self, name: str) -> bytes | None:
        """A file's content; None if it is not there."""
        try:
            content: bytes = self.fs.cat_file(self.path(name))
        except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
            return None
        return content

    def modified(self, name: str) -> float | None:
        """Time of a file's last change, seconds since 1970; None if it does not exist."""
        try:
            return _stamp("", self.fs.info(self.path(name))).modified
        except FileNotFoundError:
            return None

    # ------------------------------------------------------------------ writing
    def create(self, name: str, content: bytes) -> bool:
        """Make a file; False if it exists already."""
        target = self.path(name)
        if self.is_local:
            partial = self._partial(content)
            Path(target).parent.mkdir(parents=True, exist_ok=True)
            try:
                os.link(partial, target)
            except FileExistsError:
                return False
            finally:
                partial.unlink()
            return True
        try:
            self.fs.pipe_file(target, content, mode="create")
        except OSError:  # the file exists, or a repeated request met the first one
            if self.read(name) is None:
                raise
        return self.read(name) == content

    def write(self, name: str, content: bytes) -> None:
        """Put a file there, whole or not at all."""
        target = self.path(name)
        if self.is_local:
            Path(target).parent.mkdir(parents=True, exist_ok=True)
            self._partial(content).replace(target)
        else:
            self.fs.pipe_file(target, content)

    def _partial(self, content: bytes) -> Path:
        folder = Path(self.path(f"{HIDDEN}/partial"))
        folder.mkdir(parents=True, exist_ok=True)
        partial = folder / uuid.uuid4().hex
        partial.write_bytes(content)
        return partial

    def remove(self, name: str) -> None:
        """Take a file away, if it is there."""
        try:
            self.fs.rm_file(self.path(name))
        except FileNotFoundError:
            return

    # ------------------------------------------------------------------ moving
    def move(self, entry: Entry, target: str) -> None:
        """Move an entry, replacing the target. A killed move is finished by the next process that lists the folder."""
        if self.is_local:
            goal = Path(self.path(target))
            goal.parent.mkdir(parents=True, exist_ok=True)
            if goal.is_dir():
                shutil.rmtree(goal)
            Path(self.path(entry.name)).rename(goal)
            return
        for file in entry.files:
            below = f"/{file.name}" if file.name else ""
            self.fs.cp_file(self.path(entry.name) + below, self.path(target) + below)
        note = {"name": entry.name, "files": [[f.name, f.size, f.modified] for f in entry.files]}
        marker = f"{HIDDEN}/leaving/{uuid.uuid5(uuid.NAMESPACE_URL, entry.name)}.json"
        self.write(marker, json.dumps(note).encode())
        self._leave(marker)

    def leaving(self) -> set[str]:
        """Entries whose copy is complete and whose files are being removed."""
        return {name for _, name, _ in self._moves()}

    def _finish_moves(self) -> None:
        for marker, _, _ in self._moves():
            self._leave(marker)

    def _moves(self) -> Iterator[tuple[str, str, list[Stamp]]]:
        for file in () if self.is_local else self.names(f"{HIDDEN}/leaving"):
            content = self.read(f"{HIDDEN}/leaving/{file}")
            if content:
                note = json.loads(content)
                yield f"{HIDDEN}/leaving/{file}", note["name"], [Stamp(*values) for values in note["files"]]

    def _leave(self, marker: str) -> None:
        """Remove the files of a finished copy, unless they were written again, then the note."""
        for found, name, files in list(self._moves()):
            there = self.entry(name) if found == marker else None
            for file in there.files if there else ():
                if file in files:
                    self.remove(f"{name}/{file.name}" if file.name else name)
        self.remove(marker)

    def sweep(self, older_than_s: float, now: float) -> None:
        """Remove half-written files that killed processes left on local disks."""
        folder = Path(self.path(f"{HIDDEN}/partial"))
        for file in folder.iterdir() if self.is_local and folder.is_dir() else ():
            try:
                if now - file.stat().st_mtime > older_than_s:
                    file.unlink()
            except FileNotFoundError:
                continue


def _stamp(name: str, about: dict[str, Any]) -> Stamp:
    value = next((about[key] for key in _TIMES if about.get(key) is not None), 0.0)
    if isinstance(value, str):
        value = datetime.fromisoformat(value.replace("Z", "+00:00"))
    return Stamp(name, int(about.get("size") or 0), value.timestamp() if isinstance(value, datetime) else float(value))
