"""Jobs through pools of workers, in one process each or in threads; what a job dies of, the others survive.

    lanes = [Lane(fast, 2, open_processes), Lane(asking, 8, open_threads)]
    for job, outcome in through(lanes):       # as they end; a Death where the job's process died twice
        ...

A pool that has lost a process is replaced. The jobs that it was at are run again one by one, each in a process of its
own: one that dies there twice is the cause. Knows no Prefect; a pool may be one of its task runners.
"""

from __future__ import annotations

import multiprocessing
import queue
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from contextvars import copy_context
from dataclasses import dataclass, field
from typing import Any

from flows.batch.case_order import OnStep, prepare_process, watching
from flows.batch.plan_batch import Job

AHEAD = 2
"""Jobs that a pool has for each of its workers: one waits when one ends, and few are lost with a pool."""
UNSEEN = 32
"""Outcomes that may wait for whoever follows the lanes; then the lanes wait, so that a long batch takes no more memory
than a short one."""
ALONE = 2
"""Tries of a job in a pool of its own, after a pool was lost with it."""
LOOK_S = 0.2
"""So often a lane that waits looks whether the batch was stopped."""


@dataclass(frozen=True)
class Death:
    """What is known of a job whose process died."""

    reason: str


Submit = Callable[[Job], Any]
"""Hands a job to a pool; gives a future, of `concurrent.futures` or of Prefect."""


@dataclass(frozen=True)
class Lane:
    """Jobs and the kind of pool that takes them; `width` of them run at a time."""

    jobs: Sequence[Job]
    width: int
    open: Callable[[int], AbstractContextManager[Submit]]
    outcome: Callable[[Any], Any] = Future.result
    """The outcome of a future that is done. Raises BrokenExecutor where the pool has lost a process."""
    lost: Callable[[Any], None] = lambda future: None
    """Called with the future of a job that was cut off."""
    cancel: Callable[[Any], None] = lambda future: None
    """Called with each future that is left when the batch is stopped, where its pool is not of this process."""
    ahead: int = AHEAD


class Interrupted(BaseException):
    """The batch is being stopped: a case gets no result."""


@dataclass
class Stop:
    """Asks for the end of a batch."""

    asked: threading.Event = field(default_factory=threading.Event)
    _calls: list[Callable[[], None]] = field(default_factory=list)

    def ask(self) -> None:
        """Begin no more jobs, and end the worker processes; a case's folder appears whole or not at all."""
        self.asked.set()
        for call in list(self._calls):
            call()
        for child in multiprocessing.active_children():
            child.kill()

    @contextmanager
    def calling(self, call: Callable[[], None]) -> Iterator[None]:
        """Call something when the end is asked for while the block lasts."""
        self._calls.append(call)
        try:
            yield
        finally:
            self._calls.remove(call)

    def check(self) -> None:
        """Raises Interrupted if the end was asked for."""
        if self.asked.is_set():
            raise Interrupted


@contextmanager
def watched(tell: OnStep | None, stop: Stop) -> Iterator[None]:
    """Report the steps of cases that run in this process, and end them when the batch is stopped."""

    def watch(job: str, step: str) -> None:
        stop.check()
        if tell:
            tell(job, step)

    token = watching.set(watch)
    try:
        yield
    finally:
        watching.reset(token)


def parted(jobs: Sequence[Job], wanted: Callable[[Job], object]) -> tuple[list[Job], list[Job]]:
    """The jobs that are wanted, and the others."""
    found = [(job, bool(wanted(job))) for job in jobs]
    return [job for job, yes in found if yes], [job for job, yes in found if not yes]


def through(lanes: Sequence[Lane], stop: Stop) -> Iterator[tuple[Job, Any]]:
    """Each job with its outcome, as they end, or its fault raised."""
    arrived: queue.SimpleQueue[tuple[Job, Any] | BaseException | None] = queue.SimpleQueue()
    room = threading.Semaphore(UNSEEN)

    def put(one: Any) -> None:
        while isinstance(one, tuple) and not stop.asked.is_set() and not room.acquire(timeout=LOOK_S):
            pass
        arrived.put(one)

    threads = [
        threading.Thread(target=copy_context().run, args=(_work, lane, put, stop), daemon=True)
        for lane in lanes
        if lane.jobs
    ]
    for thread in threads:
        thread.start()
    working = len(threads)
    while working:
        match arrived.get():
            case None:
                working -= 1
            case BaseException() as fault:
                raise fault
            case tuple() as ended:
                yield ended
                room.release()
    for thread in threads:
        thread.join()


def _work(lane: Lane, put: Callable[[Any], None], stop: Stop) -> None:
    try:
        waiting = deque(lane.jobs)
        while waiting and not stop.asked.is_set():
            for job in _through_pool(lane, waiting, lane.width, put, stop):
                if _dies_alone(lane, job, put, stop):
                    put((job, Death("the process that ran it died, twice: killed, out of memory, or over time")))
    except BaseException as fault:  # noqa: BLE001 - raised in the thread that follows the lanes
        put(fault)
    put(None)


def _dies_alone(lane: Lane, job: Job, put: Callable[[Any], None], stop: Stop) -> bool:
    """Whether a job's process dies twice where it has a pool of its own."""
    return all(not stop.asked.is_set() and _through_pool(lane, deque([job]), 1, put, stop) for _ in range(ALONE))


def _through_pool(lane: Lane, waiting: deque[Job], width: int, put: Callable[[Any], None], stop: Stop) -> list[Job]:
    """Run jobs through one pool until none is left or the pool breaks; the jobs that it was at then."""
    done: queue.SimpleQueue[Any] = queue.SimpleQueue()
    at: dict[int, tuple[Job, Any]] = {}
    cut: list[Job] = []

    def wants_more() -> bool:
        return bool(waiting) and not cut and not stop.asked.is_set()

    def cancel() -> None:
        for _, future in list(at.values()):
            lane.cancel(future)

    with lane.open(width) as submit, stop.calling(cancel):
        while at or wants_more():
            while wants_more() and len(at) < lane.ahead * width:
                future = submit(job := waiting.popleft())
                at[id(future)] = job, future
                future.add_done_callback(done.put)
            job, future = at.pop(id(done.get()))
            try:
                put((job, lane.outcome(future)))
            except (BrokenExecutor, CancelledError):
                cut.append(job)
                lane.lost(future)
    return cut


# ------------------------------------------------------------------ pools without Prefect
@contextmanager
def open_processes(width: int, run: Callable[[Any], Any], order: Callable[[Job], Any]) -> Iterator[Submit]:
    """A pool of worker processes."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(width, mp_context=context, initializer=prepare_process) as pool:
        yield lambda job: pool.submit(run, order(job))


@contextmanager
def open_threads(width: int, run: Callable[[Any], Any], order: Callable[[Job], Any]) -> Iterator[Submit]:
    """A pool of threads, which share a model."""
    with ThreadPoolExecutor(width, thread_name_prefix="case") as pool:
        yield lambda job: pool.submit(copy_context().run, run, order(job))
