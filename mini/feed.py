"""Training rows without end, made in worker processes: seed number n gives the same row everywhere.

The curriculum goes by progress (0 to 1) of the budget: text only and short at first, then all modes and longer
texts. A row's seed, mode and length follow from its number and the progress, so a resumed run goes on where it
stopped.
"""

from __future__ import annotations

import multiprocessing as mp
import os
from collections.abc import Callable, Iterator
from queue import Empty
from random import Random
from typing import Any

from mini.generator.report import MODES, TEXT_MODES, Report, make_report
from mini.rows import MAX_TEXT, Row, training_row
from mini.tokens import Coder, load_tokenizer

POOL = 96
AHEAD = 3
TEXT_STAGE = 0.2
HELD_OUT_BASE = 50_000_000
"""Seeds from here on are for measuring."""


def length_for(rng: Random, progress: float) -> float:
    """How much noise a report gets: little at first, later up to as much as real ones have."""
    if progress < TEXT_STAGE:
        return rng.random() * 0.35
    return rng.random() ** 2 * (0.4 + 0.8 * min(1.0, (progress - TEXT_STAGE) / 0.5))


def one_row(coder: Coder, seed: int, progress: float) -> Row:
    """The row of a seed; reports that are too long are told again with less noise."""
    rng = Random(seed)
    length = length_for(rng, progress)
    modes = TEXT_MODES if progress < TEXT_STAGE else MODES
    while True:
        report = make_report(seed, False, length, modes)
        if len(report.narrative) < MAX_TEXT * 4.6 or length < 0.05:
            return training_row(coder, report, drawing(report))
        length *= 0.7


def drawing(report: Report) -> Any:
    """The report's diagram, or None."""
    if not report.has_image:
        return None
    from mini.renderer.draw import draw_report

    return draw_report(report)


def pool(coder: Coder, number: int, progress: float) -> list[Row]:
    """POOL rows, sorted by length."""
    rows = [one_row(coder, number * POOL + i, progress) for i in range(POOL)]
    return sorted(rows, key=lambda row: len(row.ids))


def _work(folder: str, jobs: Any, done: Any) -> None:
    import torch

    torch.set_num_threads(1)
    coder = Coder(load_tokenizer(folder))  # type: ignore[arg-type]
    parent = os.getppid()
    while os.getppid() == parent:
        try:
            job = jobs.get(timeout=5)
        except Empty:
            continue
        if job is None:
            break
        number, progress = job
        done.put((number, progress, pool(coder, number, progress)))
    done.cancel_join_thread()


class Feed:
    """Pools in order, a few ahead."""

    def __init__(self, folder: str, workers: int, start: int, stride: int = 1, first: float | None = None) -> None:
        context = mp.get_context("spawn")
        self.jobs: Any = context.Queue()
        self.done: Any = context.Queue()
        self.next, self.asked, self.stride, self.first = start, start, stride, first
        self.ready: dict[int, tuple[float, list[Row]]] = {}
        self.workers = [
            context.Process(target=_work, args=(folder, self.jobs, self.done), daemon=True) for _ in range(workers)
        ]
        self.coder = None if workers else Coder(load_tokenizer(folder))  # type: ignore[arg-type]
        for worker in self.workers:
            worker.start()

    def pools(self, progress: Callable[[], float]) -> Iterator[tuple[int, float, list[Row]]]:
        """(number, progress, rows) without end; progress() is asked when a pool is ordered."""
        while True:
            if self.coder is not None:
                at = self._progress(progress)
                yield self.next, at, pool(self.coder, self.next, at)
            else:
                yield self.next, *self._ordered(progress)
            self.next += self.stride

    def _ordered(self, progress: Callable[[], float]) -> tuple[float, list[Row]]:
        """The next pool from the workers, with a few ordered ahead."""
        while self.asked < self.next + AHEAD * self.stride:
            self.jobs.put((self.asked, self._progress(progress)))
            self.asked += self.stride
        while self.next not in self.ready:
            number, at, rows = self.done.get(timeout=900)
            self.ready[number] = (at, rows)
        return self.ready.pop(self.next)

    def _progress(self, progress: Callable[[], float]) -> float:
        """Now; for the first pool of a resumed run what it was then, so that its rows are the same."""
        first, self.first = self.first, None
        return round(progress(), 3) if first is None else first

    def close(self) -> None:
        """Stop the workers."""
        for _ in self.workers:
            self.jobs.put(None)
        for worker in self.workers:
            worker.join(timeout=2)
            if worker.is_alive():
                worker.kill()
