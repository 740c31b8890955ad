"""Shared storage of a study's hosts: one folder behind an fsspec address (file, s3, gs, sftp, memory ...).

    plan.json                              arms, cases, jobs and shards, written once
    cases/<id>[/<file>]                    the reports, so that a host needs only this address
    results/<arm>/<case>/<run>.tar.gz      one finished case, one object, written before its mark
    done/<arm>/<case>.<digest>.json        the mark: which object is the result, its SHA-256; written last
    failed/...                             marks of failed cases: ended for now, tried again by the next study
    leases/<shard>.json                    the worker of a shard; the number in it grows while the worker lives

A case is done when its mark is there, never before. Object storage has no rename and no lock: the second
worker finds the mark and removes its own object, and should two mark in the same instant the later mark
stands, which names one whole object all the same. Knows no Prefect and no configuration.
"""

from __future__ import annotations

import hashlib
import io
import json
import socket
import tarfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from flows.case_files.case_folder import TRACKED
from sgcad_core.errors import BadInput, MissingTool

DIGEST_CHARS = 16
"""Of a job's digest, in the name of its mark: a changed report or code has a mark of its own."""

_T = TypeVar("_T")


class Unreachable(MissingTool):
    """The storage does not answer; finished cases stay finished."""


@dataclass(frozen=True)
class Mark:
    """Content of a mark: the object that is the result of a job, and its run and host."""

    arm: str
    case: str
    digest: str
    status: str
    object: str
    sha256: str
    run: str
    host: str

    @property
    def name(self) -> str:
        """Address of the mark."""
        return mark_name(self.arm, self.case, self.digest, self.status == "failed")


def mark_name(arm: str, case: str, digest: str, failed: bool = False) -> str:
    """Address of a job's mark within the share."""
    return f"{'failed' if failed else 'done'}/{arm}/{case}.{digest[:DIGEST_CHARS]}.json"


@dataclass(frozen=True)
class SharedFolder:
    """One study's folder on the storage. Every method raises Unreachable where the storage does not answer."""

    address: str

    @cached_property
    def _place(self) -> tuple[Any, str]:
        from fsspec.core import url_to_fs

        local = self.address.startswith(("file:", "local:")) or "://" not in self.address
        return self._reach(lambda: url_to_fs(self.address, **({"auto_mkdir": True} if local else {})))  # type: ignore[no-any-return]

    def _reach(self, act: Callable[[], _T]) -> _T:
        try:
            return act()
        except FileNotFoundError:
            raise
        except Exception as fault:
            raise Unreachable(
                f"{self.address}: {type(fault).__name__}: {fault}; is the address right, its library installed "
                "(s3: pip install s3fs), the network up? Start the same command again to go on"
            ) from fault

    # -------------------------------------------------------------- bytes
    def write(self, name: str, content: bytes) -> None:
        """Write an object, over one that may be there."""
        fs, root = self._place
        self._reach(lambda: fs.pipe_file(f"{root}/{name}", content))

    def read(self, name: str) -> bytes | None:
        """An object's content; None where there is none."""
        fs, root = self._place
        try:
            return self._reach(lambda: bytes(fs.cat_file(f"{root}/{name}")))
        except FileNotFoundError:
            return None

    def remove(self, name: str) -> None:
        """Remove an object, if it is there."""
        fs, root = self._place
        try:
            self._reach(lambda: fs.rm_file(f"{root}/{name}"))
        except FileNotFoundError:
            return

    def names(self, prefix: str) -> set[str]:
        """Every object below a prefix, by its name within the share."""
        fs, root = self._place
        place = f"{root}/{prefix}"
        fs.invalidate_cache()
        found = self._reach(lambda: fs.find(place) if fs.exists(place) else [])
        return {prefix + str(path).removeprefix(place) for path in found}

    def json(self, name: str) -> Any:
        """An object's JSON; None where there is none or it is not whole (a local disk shows files half written)."""
        try:
            return json.loads(self.read(name) or b"null")
        except ValueError:
            return None

    def write_json(self, name: str, content: Any) -> None:
        """Write JSON as one object."""
        self.write(name, json.dumps(content, ensure_ascii=False).encode())

    # -------------------------------------------------------------- results
    def leave(self, folder: Path, job: tuple[str, str, str], status: str, run: str) -> bool:
        """Upload a finished case's folder, then mark it; False if it was marked by another run.

        `job` is (arm, case, digest); `run` names the attempt and becomes part of the object's name.
        """
        arm, case, digest = job
        content = packed(folder)
        place = f"results/{arm}/{case}/{run}.tar.gz"
        mark = Mark(arm, case, digest, status, place, hashlib.sha256(content).hexdigest(), run, socket.gethostname())
        self.write(place, content)
        other = self.mark(mark.name)
        if other is not None and other.object != place:
            self.remove(place)
            return False
        self.write_json(mark.name, vars(mark))
        return True

    def mark(self, name: str) -> Mark | None:
        """A job's mark; None where there is none."""
        found = self.json(name)
        return Mark(**found) if found else None

    def fetch(self, mark: Mark, folder: Path) -> None:
        """Unpack a result into an empty folder. Raises BadInput if the object is not the one that was marked."""
        content = self.read(mark.object)
        if content is None or hashlib.sha256(content).hexdigest() != mark.sha256:
            raise BadInput(
                f"{self.address}/{mark.object}: {'missing' if content is None else 'not what its mark says'}; "
                f"remove {self.address}/{mark.name} and start the study again: the case is then done again"
            )
        with tarfile.open(fileobj=io.BytesIO(content), mode="r:gz") as archive:
            archive.extractall(folder, filter="data")


def packed(folder: Path) -> bytes:
    """A case folder as one archive, without the note of its trackers."""
    packet = io.BytesIO()
    with tarfile.open(fileobj=packet, mode="w:gz", compresslevel=1) as archive:
        for path in sorted(folder.iterdir()):
            if path.name != TRACKED:
                archive.add(path, arcname=path.name)
    return packet.getvalue()
