"""Continuous batching: one thread owns the model, reports enter and leave between two tokens.

`submit` may be called from any thread; it queues the request and returns a future. If memory runs out, the number of
reports at once is halved and the tokens so far are kept. A decoder that raises ends its own report; if the model
raises, its reports go on one by one. Knows requests and rows; no prompt format.
"""

from __future__ import annotations

import atexit
import queue
import sys
import threading
from collections import deque
from concurrent.futures import Future
from functools import partial
from typing import Any
from weakref import WeakSet

import torch

from plugins.backbone.engine.families import Family
from plugins.backbone.engine.faults import BadLogits, EngineFault, TooBig, tried
from plugins.backbone.engine.job import Job
from plugins.backbone.engine.records import Answer, Request, Rows
from plugins.backbone.engine.runner import Runner
from plugins.backbone.engine.scoring import ScoredChunk, averaged, score_chunks

_GUESSES = 64
"""Guessed tokens a step, shared by the reports in it: more would cost more than they save."""
_PATIENCE = 10.0
"""Seconds that an interpreter which ends waits for a loop's last step."""


def engine_of(
    model: Any,
    family: Family,
    apart: bool = False,
    reports_at_once: int = 8,
    prefix_bytes: int = 1 << 30,
    watched: bool = False,
) -> Engine:
    """The token loop of a model of transformers. `watched`: answers keep the states that tokens were chosen from."""
    rows = Runner(model, family, apart, prefix_bytes)
    if watched:
        rows.watch()
    return Engine(rows, reports_at_once)


class Engine:
    """The token loop of one model. Close it, or leave it: its thread is a daemon, which ends before the interpreter."""

    def __init__(self, rows: Rows, reports_at_once: int = 8) -> None:
        self.runner = rows
        self.window = rows.window
        self.limit = reports_at_once
        self.jobs: list[Job] = []
        self.waiting: deque[Job] = deque()
        self.arrivals: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self.lock = threading.RLock()  # a collector may call `end` wherever it runs
        self.thread: threading.Thread | None = None
        self.ended = False
        self.reason = ""
        self.halved = 0

    @property
    def computed_in(self) -> str:
        """Number type of the model's weights."""
        return self.runner.computed_in

    def generate(self, request: Request) -> Answer:
        """Answers one request; blocks. Raises an EngineFault, or the exception of the decoder or the model."""
        future = self.submit(request)
        try:
            return future.result()
        except BaseException:  # a caller that stops waiting (Ctrl-C) frees its place
            future.cancel()
            raise

    def submit(self, request: Request) -> Future[Answer]:
        """Queues a request. Raises TooLong at once; every other fault comes from the future.

        Cancelling the future ends the report before its next token.
        """
        request.hold_to(self.window)
        job = Job(request)
        with self.lock:
            if self.ended:
                raise EngineFault(f"the engine is closed{self.reason}")
            if self.thread is None:
                self.thread = threading.Thread(target=self._run_loop, name="token-loop", daemon=True)
                self.thread.start()
                _STARTED.add(self)
            self.arrivals.put(job)
        return job.future

    def close(self) -> None:
        """Stops after the present token; requests without an answer are cancelled."""
        self.end()
        if self.thread:
            self.thread.join()

    def end(self) -> None:
        """Tells the loop to stop without waiting for it, so that its own thread may call this too."""
        with self.lock:
            self.ended = True
            self.arrivals.put(None)

    # ------------------------------------------------------------------ the owner's thread
    def _run_loop(self) -> None:
        try:
            with torch.inference_mode():
                while self._collect_arrivals():
                    self._admit()
                    if self.jobs:
                        self._step()
        finally:
            self._fail_unanswered(sys.exc_info()[1])

    def _collect_arrivals(self) -> bool:
        """Collects new requests, waiting if there is nothing else to do; False to stop."""
        idle = not (self.jobs or self.waiting)
        while idle or not self.arrivals.empty():
            job = self.arrivals.get()
            if job is None:
                return False
            self.waiting.append(job)
            idle = False
        return True

    def _admit(self) -> None:
        """Opens waiting reports; one that must be answered alone waits for an empty batch and keeps it."""
        while self.waiting and len(self.jobs) < self.limit:
            if self.jobs and (self.waiting[0].alone or self.jobs[0].alone):
                return
            job = self.waiting.popleft()
            if job.is_cancelled():
                continue
            fault = tried(partial(self._open, job))
            if isinstance(fault, TooBig):
                self._restart(fault)
            elif fault:
                self._close_job(job)
                job.resolve(fault)

    def _open(self, job: Job) -> None:
        before = self.runner.calls
        self.jobs.append(job)
        request = job.request
        job.begin()
        for prompt in request.prompts:
            job.rows.append(self.runner.open(prompt, job.fed()))
        job.answer.model_calls += self.runner.calls - before

    def _step(self) -> None:
        """Runs one forward pass for each lane and gives every job its result."""
        for job in [job for job in self.jobs if job.is_cancelled()]:
            self._close_job(job)
        jobs, results = list(self.jobs), list[ScoredChunk]()
        if not jobs:
            return
        if failed := tried(lambda: results.extend(self._forward(jobs))):
            self._restart(failed)
            return
        # every job hears first: a row that moves into a freed slot takes only what its job has accepted
        faults = [self._take_result(job, result) for job, result in zip(jobs, results, strict=True)]
        for job, fault in zip(jobs, faults, strict=True):
            if fault or job.finished:
                self._close_job(job, keep=not fault)
                job.resolve(fault or job.answer)

    def _take_result(self, job: Job, result: ScoredChunk) -> Exception | None:
        if isinstance(result.fault, BadLogits):
            self._clear_slots(job)
        if result.result is None:
            return result.fault
        return tried(partial(job.take_result, result.result, result.choices))

    def _forward(self, jobs: list[Job]) -> list[ScoredChunk]:
        guesses = max(2, _GUESSES // len(jobs))
        chunks = [(row, chunk) for job in jobs for chunk in [job.chunk(guesses)] for row in job.rows]
        before = self.runner.calls
        logits = iter(self.runner.step(chunks))
        with_context, without_context = [], []
        for job in jobs:
            first = next(logits)
            without_context.append(next(logits) if job.request.without_context is not None else None)
            with_context.append(averaged(first, [next(logits) for _ in job.request.views]))
            job.answer.model_calls += self.runner.calls - before
        found = score_chunks(jobs, with_context, without_context, (self.runner.vocabulary + 31) // 32)
        for job, one in zip(jobs, found, strict=True):
            states = self.runner.states.get(id(job.rows[0]))
            if one.result is not None and states is not None:
                one.result.states = states.float().cpu().unbind()
        return found

    def _close_job(self, job: Job, keep: bool = False) -> None:
        self.jobs.remove(job)
        for row in reversed(job.rows):
            if keep and tried(partial(self.runner.keep, row, job.answer.ids)):
                self.runner.forget()
            self.runner.close(row)
        job.rows = []

    def _clear_slots(self, job: Job) -> None:
        """Clears the job's slots: NaN in a slot would reach the next row there through a weight of 0."""
        self.runner.forget()
        for row in job.rows:
            self.runner.clear(row)

    def _restart(self, fault: Exception) -> None:
        """Discards a failed computation of the batch and goes on from every report's tokens so far.

        If memory ran out, the number of reports at once is halved. After any other fault the report that caused it is
        unknown, so each report goes on alone; a report that was alone ends with the fault.
        """
        jobs, self.jobs = self.jobs, []
        self.runner.reset()
        halved = isinstance(fault, TooBig) and len(jobs) > 1
        if halved:
            self.limit = max(1, len(jobs) // 2)
            self.halved += 1
        for job in reversed(jobs):
            ended = fault if job.alone else tried(job.forget_guesses)
            job.rows, job.alone = [], not halved
            if ended:
                job.resolve(ended)
            else:
                self.waiting.appendleft(job)
        if torch.cuda.is_available():
            torch.cuda.empty_cache()

    def _fail_unanswered(self, fault: BaseException | None) -> None:
        """Ends every unanswered request with a fault after the loop has ended."""
        with self.lock:
            self.ended = True
            self.reason = f": {type(fault).__name__}: {fault}" if fault else ""
        while not self.arrivals.empty():
            if job := self.arrivals.get():
                self.waiting.append(job)
        for job in [*self.jobs, *self.waiting]:
            closed = EngineFault(f"the engine was closed before this report was answered{self.reason}")
            job.resolve(fault if isinstance(fault, Exception) else closed)


_STARTED: WeakSet[Engine] = WeakSet()


@atexit.register
def _end_all() -> None:
    """Waits for every loop: an interpreter stops daemons anywhere, and within torch that aborts the process."""
    for engine in list(_STARTED):
        engine.end()
        if engine.thread:
            engine.thread.join(_PATIENCE)
