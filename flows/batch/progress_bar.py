"""Progress of a batch: a bar that moves with every attempt, or lines without a terminal.

Everything goes to stderr; stdout is for the answer.
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn

from flows.batch.plan_batch import Job
from flows.batch.summary import Tally
from flows.case import case_in_words
from flows.case.run_case import Ending
from flows.terminal import escape
from sgcad_core.result import counts_of

LINES_AT_ONCE = 50
"""Batches up to this size print a line per case; larger ones a line every LINE_EVERY_S."""
LINE_EVERY_S = 10.0
SHOWN = re.compile(r"read|(road|scenario)\[\d+\]|simulate|drive|draw")
"""Steps of a single case that have a line each."""
SHARE = {"road": 0.1, "scenario": 0.55}
"""Progress of a case when its first attempt of a stage begins; each further attempt adds a third of the rest."""


@dataclass
class BatchProgress:
    """Counts attempts and endings from any thread, and moves the bar or prints lines."""

    tally: Tally
    total: int
    bar: Progress | None = None
    task: TaskID | None = None
    console: Console | None = None
    _parts: dict[str, float] = field(default_factory=dict)
    _told: float = 0.0
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def ended(self, job: Job, ending: Ending, untracked: str = "") -> None:
        """Count an ending."""
        with self._lock:
            self._parts.pop(job.name, None)
            self.tally.add(job, ending, untracked)
            if self.bar:
                self._move(self.tally.in_words())
            elif self._is_time():
                status, spent = ending.result["status"], sum(ending.result["seconds"].values())
                about = f"{job.name}: {status}{_lacking(ending)}" + (
                    ", done before" if ending.reused else f" ({spent:.1f} s)"
                )
                self._say(about if self.total <= LINES_AT_ONCE else self.tally.in_words())

    def step(self, job: str, step: str) -> None:
        """A step of a job begins, such as "read" or "road[2]"."""
        stage, _, number = step.rstrip("]").partition("[")
        with self._lock:
            if stage in SHARE:
                start, room = SHARE[stage], (SHARE["scenario"] if stage == "road" else 1.0) - SHARE[stage]
                self._parts[job] = start + room * (1 - (2 / 3) ** (int(number or 1) - 1))
            if self.bar:
                told = f"{stage}, attempt {number}" if stage in SHARE else stage
                self._move(f"{self.tally.in_words() or 'working'}; {job.partition('/')[2]}: {told}")
            elif self.total == 1 and SHOWN.fullmatch(step):
                self._say(f"{job}: {step}")

    def _move(self, told: str) -> None:
        if self.bar and self.task is not None:
            done = len(self.tally.endings)
            self.bar.update(self.task, completed=done + sum(self._parts.values()), description=escape(told), done=done)

    def _is_time(self) -> bool:
        if self.total <= LINES_AT_ONCE or len(self.tally.endings) == self.total:
            return True
        now = time.monotonic()
        if now - self._told < LINE_EVERY_S:
            return False
        self._told = now
        return True

    def _say(self, line: str) -> None:
        if self.console:
            self.console.print(escape(f"[{len(self.tally.endings)}/{self.total}] {line}"), soft_wrap=True)


def _lacking(ending: Ending) -> str:
    """The verdict where it is not that all told is there: the number of things that lack, or its word."""
    account = counts_of(ending.result)
    if account is None or account["verdict"] == "whole":
        return ""
    return f", {case_in_words.lacking_counted(account) or account['verdict']}"


@contextmanager
def batch_progress(tally: Tally) -> Iterator[BatchProgress]:
    """A watch over a batch while the block lasts."""
    total = len(tally.batch.configs) * len(tally.batch.cases)
    console = Console(stderr=True, emoji=False, highlight=False)
    if not console.is_terminal:
        yield BatchProgress(tally, total, console=console)
        return
    count = TextColumn("{task.fields[done]}/{task.total:.0f}")
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), count, TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        yield BatchProgress(tally, total, bar, bar.add_task("starting", total=total, done=0))
