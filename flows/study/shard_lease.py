"""A lease on a shard: an object whose number grows while its holder lives and can reach the storage.

No clock is compared between hosts: the holder counts, and the watcher measures with its own clock how long
the count has stood still. It is kept in the storage and not in Prefect because a worker that cannot reach
the storage cannot hand in results, even if it reaches the server.
"""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from flows.study.shared_storage import SharedFolder, Unreachable
from sgcad_core.errors import SgcadError

BEAT_S = 5.0


class LeaseLost(SgcadError):
    """The shard was given to another run while this one was cut off; its handed-in results stay."""


def lease_name(shard: int) -> str:
    """Address of a shard's lease within the share."""
    return f"leases/{shard:05d}.json"


@dataclass
class Lease:
    """Held by one flow run; `check` before every hand-in."""

    share: SharedFolder
    shard: int
    run: str
    beat_s: float = BEAT_S
    count: int = 0
    _over: threading.Event = field(default_factory=threading.Event)
    _lost: str = ""

    def take(self) -> None:
        """Take the shard: the coordinator has given it to this run and to no other."""
        held = {"run": self.run, "count": self.count, "host": socket.gethostname()}
        self.share.write_json(lease_name(self.shard), held)

    def beat(self) -> None:
        """Increase the number, unless another run holds the shard by now."""
        held = self.share.json(lease_name(self.shard))
        if held is not None and held["run"] != self.run:
            self._lost = str(held["run"])
            return
        self.count += 1
        self.take()

    def check(self) -> None:
        """Raises LeaseLost if another run has the shard."""
        if self._lost:
            raise LeaseLost(f"shard {self.shard} was given to flow run {self._lost}; this run stops")

    @contextmanager
    def held(self) -> Iterator[Lease]:
        """Take the lease and renew it from a thread while the block lasts."""
        self.take()
        thread = threading.Thread(target=self._keep, daemon=True, name=f"lease-{self.shard}")
        thread.start()
        try:
            yield self
        finally:
            self._over.set()
            thread.join(timeout=2 * self.beat_s)  # it may hang in a broken connection

    def _keep(self) -> None:
        while not self._lost and not self._over.wait(self.beat_s):
            try:
                self.beat()
            except Unreachable:
                continue  # a short interruption: the watcher decides how long is too long
