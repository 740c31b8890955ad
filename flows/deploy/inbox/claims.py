"""Claims of workers on reports, numbered and with a heartbeat, so that a dead worker's report is taken again.

A claim is the file `<digest>.<n>`. The first worker makes number 1; a worker that finds the highest number
silent for longer than the lease makes the next one. Making is exclusive (Place.create), and no worker writes to
another's claim, so of many that see the same dead claim one succeeds. A worker that was only stopped for a while
sees the higher number before it hands in. Ages are told by the store's clock: a lease must be longer than the clocks
of the hosts are apart. Knows no report.
"""

from __future__ import annotations

import json
import os
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import psutil

from flows.deploy.storage import HIDDEN, Place

CLAIMS = f"{HIDDEN}/claims"
ALONE_FROM = 3
"""Number of a claim from which its report is run alone, since it may be the cause of the deaths."""
MAX_TAKES = 6
"""Number of dead workers after which a report counts as failed."""
SAME_S = 2.0
"""A process is identified by number and start time; the start time is exact to within clock adjustments."""


@dataclass(frozen=True)
class Claim:
    """A worker's claim on a report; `number` counts the workers that have tried."""

    digest: str
    number: int
    holder: bytes

    @property
    def name(self) -> str:
        """The claim's file."""
        return f"{CLAIMS}/{self.digest}.{self.number}"


@dataclass
class Claims:
    """Claims at one address; a claim that is silent for `lease_s` is free."""

    place: Place
    lease_s: float = 120.0
    _held: dict[str, Claim] = field(default_factory=dict)
    _guard: threading.Lock = field(default_factory=threading.Lock)

    def take(self, digest: str, alone: bool = True) -> Claim | None:
        """Claim a report; None if another worker has it, or if it must be taken alone and is not."""
        if digest in self._held:
            return None
        if claim := self._make(digest, 1):
            return claim
        highest = self._highest(digest)
        if highest == 0:
            return None  # it was released this instant: the next look shows why
        if self._alive(f"{CLAIMS}/{digest}.{highest}"):
            return None
        return self._make(digest, highest + 1) if alone or highest + 1 < ALONE_FROM else None

    def _make(self, digest: str, number: int) -> Claim | None:
        claim = Claim(digest, number, _holder())
        if not self.place.create(claim.name, claim.holder):
            return None
        with self._guard:
            self._held[digest] = claim
        return claim

    def _highest(self, digest: str) -> int:
        numbers = [n.rpartition(".")[2] for n in self.place.names(CLAIMS) if n.startswith(f"{digest}.")]
        return max((int(n) for n in numbers), default=0)

    def _alive(self, name: str) -> bool:
        modified = self.place.modified(name)
        if modified is None or time.time() - modified > self.lease_s:
            return False
        return not _is_dead(self.place.read(name) or b"")

    def is_mine(self, claim: Claim) -> bool:
        """Whether no other worker has taken the report over."""
        return self._highest(claim.digest) == claim.number

    def release(self, claim: Claim) -> None:
        """Release, the highest number last: a lower one alone would look dead to other workers."""
        with self._guard:
            self._held.pop(claim.digest, None)
            for number in range(1, claim.number + 1):
                self.place.remove(f"{CLAIMS}/{claim.digest}.{number}")

    def drop_dead(self, done: Callable[[str], bool]) -> None:
        """Remove claims of dead workers on finished reports."""
        for name in self.place.names(CLAIMS):
            digest = name.rpartition(".")[0]
            if digest not in self._held and done(digest) and not self._alive(f"{CLAIMS}/{name}"):
                self.place.remove(f"{CLAIMS}/{name}")

    def stop_renewing(self, claim: Claim) -> None:
        """Stop renewing a claim whose report another worker has taken over."""
        with self._guard:
            self._held.pop(claim.digest, None)

    def beat(self) -> None:
        """Renew every claim held."""
        for claim in list(self._held.values()):
            with self._guard:
                if claim.digest in self._held:
                    self.place.write(claim.name, claim.holder)

    @contextmanager
    def beating(self) -> Iterator[None]:
        """Renew claims from a thread, three times per lease, while the block lasts."""
        over = threading.Event()
        thread = threading.Thread(target=self._keep_beating, args=(over,), daemon=True, name="claims")
        thread.start()
        try:
            yield
        finally:
            over.set()
            thread.join()

    def _keep_beating(self, over: threading.Event) -> None:
        while not over.wait(self.lease_s / 3):
            try:
                self.beat()
            except OSError:
                continue  # the store may answer at the next beat; if not, the lease ends


def _holder() -> bytes:
    """The holder of a claim: a fresh token, and the process for workers on the same machine."""
    about = {"token": uuid.uuid4().hex, "machine": machine(), "pid": os.getpid(), "born": _born(os.getpid())}
    return json.dumps(about).encode()


def _is_dead(holder: bytes) -> bool:
    """Whether the holder is known to have ended; only for processes of this machine."""
    try:
        about: dict[str, Any] = json.loads(holder)
        if not about["machine"] or about["machine"] != machine():
            return False
        return abs(_born(int(about["pid"])) - float(about["born"])) > SAME_S
    except (ValueError, KeyError, TypeError):
        return False  # half written, or foreign: the lease decides


def _born(pid: int) -> float:
    """Start time of a process, 0 if it has ended."""
    try:
        process = psutil.Process(pid)
        return 0.0 if process.status() == psutil.STATUS_ZOMBIE else process.create_time()
    except psutil.Error:
        return 0.0


@cache
def machine() -> str:
    """Identity of the machine: boot and process namespace; empty where the system does not give them."""
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_text().strip()
        return f"{boot}-{Path('/proc/self/ns/pid').stat().st_ino}"
    except OSError:
        return ""
