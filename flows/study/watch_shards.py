"""The watcher of a study's shards: their runs, their leases, and the results that have arrived.

Prefect leaves the run of a killed worker RUNNING, and a pool's limit counts it; so the process that started the
study watches: a run without a sign of life is given up (marked crashed, which frees its place) and its shard is
submitted again. Finished cases are found by their marks; only what was running is done again. A watcher that died
is started again, reads the marks and continues. It knows runs by their ids only and uses the clock it is given.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

from flows.study.shard_lease import BEAT_S, lease_name
from flows.study.shards import ShardJob
from flows.study.shared_storage import Mark, SharedFolder, Unreachable
from sgcad_core.errors import ConfigError

State = Literal["waiting", "taken", "ended"]
PATIENCE_S = 60.0
"""Time after which an unchanged lease is lost: twelve beats, longer than a network switch takes to restart."""
START_S = 180.0
"""From a worker's taking a run to its lease: a process, Prefect's import, on a busy machine."""
FRUITLESS = 3
"""Runs of a shard in a row without a new case that end the study."""


DEPLOYMENT = "shard/shard"


@dataclass(frozen=True)
class Hosts:
    """Options of a study on many hosts: shared storage, deployment, shards and time limits (None: the defaults)."""

    address: str
    deployment: str = DEPLOYMENT
    shards: int | None = None
    jobs: int | None = None
    beat_s: float = BEAT_S
    patience_s: float = PATIENCE_S
    start_s: float = START_S


class Pool(Protocol):
    """The work pool to which runs are submitted."""

    def submit(self, shard: int) -> str:
        """Ask for a run of a shard; its id."""

    def states(self, runs: Sequence[str]) -> dict[str, tuple[State, str]]:
        """State of each run, with the message it ended with."""

    def give_up(self, run: str, reason: str) -> None:
        """Mark a run as crashed."""


@dataclass
class _Turn:
    """A shard's latest run: the time of its last sign of life, and its runs in a row without a new case."""

    run: str
    since: float
    left: int
    seen: int = -1
    fruitless: int = 0


@dataclass
class ShardWatch:
    """Submits shards and replaces lost runs; call `step` until it returns False."""

    share: SharedFolder
    pool: Pool
    shards: Sequence[Sequence[ShardJob]]
    on_mark: Callable[[Mark], None]
    patience_s: float = PATIENCE_S
    start_s: float = START_S
    again: list[str] = field(default_factory=list)
    _turns: dict[int, _Turn] = field(default_factory=dict)
    _home: set[str] = field(default_factory=set)

    def step(self, now: float) -> bool:
        """Check once; False when every job has ended and all results are here. Raises ConfigError for a stuck shard."""
        states = self.pool.states([turn.run for turn in self._turns.values()])  # before the marks: a run that ends
        ended = self.share.names("done/") | self.share.names("failed/")  # in between has its last mark among them
        self._bring_home(ended)
        left = {n: sum(not ({w.mark, w.failure} & ended) for w in shard) for n, shard in enumerate(self.shards)}
        open_shards = [n for n, jobs in left.items() if jobs]
        self._turns = {n: turn for n, turn in self._turns.items() if left[n]}
        for number in open_shards:
            if number in self._turns:
                self._look(number, left[number], states[self._turns[number].run], now)
            else:
                self._turns[number] = _Turn(self.pool.submit(number), now, left[number])
        return bool(open_shards)

    def _bring_home(self, ended: set[str]) -> None:
        wanted = {name for shard in self.shards for work in shard for name in (work.mark, work.failure)}
        for name in sorted((ended & wanted) - self._home):
            if mark := self.share.mark(name):
                self.on_mark(mark)
                self._home.add(name)

    def _look(self, number: int, left: int, told: tuple[State, str], now: float) -> None:
        turn, (state, message) = self._turns[number], told
        if state == "ended":
            self._submit_again(number, left, f"ended with {left} jobs left ({message})", now)
        elif state == "waiting" or self._moved(number, turn):
            turn.since = now
        elif now - turn.since > (self.patience_s if turn.seen >= 0 else self.start_s):
            reason = f"no sign of life for {now - turn.since:.0f} s"
            self.pool.give_up(turn.run, reason)
            self._submit_again(number, left, reason, now)

    def _moved(self, number: int, turn: _Turn) -> bool:
        """Whether the run's lease was renewed."""
        held = self.share.json(lease_name(number))
        if held is None or held["run"] != turn.run or held["count"] == turn.seen:
            return False
        turn.seen = held["count"]
        return True

    def _submit_again(self, number: int, left: int, reason: str, now: float) -> None:
        turn = self._turns[number]
        fruitless = turn.fruitless + 1 if left == turn.left else 0
        if fruitless >= FRUITLESS:
            raise ConfigError(
                f"shard {number} ended without a new case {fruitless} times in a row, at last: {reason}; look at "
                f"flow run {turn.run} and repair the fault that it names, then start the study again"
            )
        self.again.append(f"shard {number}: {reason}")
        self._turns[number] = _Turn(self.pool.submit(number), now, left, fruitless=fruitless)


def watch_until_done(
    watch: ShardWatch, clock: Callable[[], float], wait: Callable[[], None], cut_s: float = 600.0
) -> None:
    """Step until all results have arrived; waits at most `cut_s` seconds for a storage that does not answer."""
    fine = clock()
    while True:
        try:
            if not watch.step(clock()):
                return
            fine = clock()
        except Unreachable:
            if clock() - fine > cut_s:
                raise
        wait()
