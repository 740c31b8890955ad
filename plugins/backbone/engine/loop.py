"""Continuous batching: one thread owns the model, reports enter and leave between two tokens.

`submit` may be called from any thread; it hands the request to the owner and returns a future. When memory
runs out the number of reports at once is halved and what was decided so far is kept. Knows requests and
rows; no prompt format.
"""

from __future__ import annotations

import queue
import sys
import threading
from collections import deque
from concurrent.futures import Future
from typing import Any

import torch

from plugins.backbone.engine.families import Family, window_of
from plugins.backbone.engine.job import Job
from plugins.backbone.engine.records import Answer, BadLogits, EngineFault, Request, TooBig, TooLong
from plugins.backbone.engine.runner import Runner
from plugins.backbone.engine.scoring import Heard, heard

_GUESSES = 64
"""Guessed tokens a step, shared by the reports in it: more would cost more than they save."""


class Engine:
    """The token loop of one model. Close it, or leave it: its thread is a daemon."""

    def __init__(
        self, model: Any, family: Family, apart: bool = False, reports_at_once: int = 8, prefix_bytes: int = 1 << 30
    ) -> None:
        self.model = model
        self.runner = Runner(model, family, apart, prefix_bytes)
        self.window = window_of(model)
        self.limit = reports_at_once
        self.jobs: list[Job] = []
        self.waiting: deque[Job] = deque()
        self.arrivals: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self.lock = threading.Lock()
        self.thread: threading.Thread | None = None
        self.ended = False
        self.reason = ""
        self.halved = 0

    def generate(self, request: Request) -> Answer:
        """Answer one request; blocks. Raises an EngineFault."""
        return self.submit(request).result()

    def submit(self, request: Request) -> Future[Answer]:
        """Queue a request. Raises TooLong at once; every other fault comes out of the future."""
        longest = max(len(p.ids) for p in (request.with_context, request.without_context) if p)
        if longest + request.max_new_tokens > self.window:
            raise TooLong(
                f"the prompt has {longest} tokens and the answer may have {request.max_new_tokens}, together "
                f"{longest + request.max_new_tokens}; the model's window is {self.window}"
            )
        job = Job(request)
        with self.lock:
            if self.ended:
                raise EngineFault(f"the engine is closed{self.reason}")
            if self.thread is None:
                self.thread = threading.Thread(target=self._own, name="token-loop", daemon=True)
                self.thread.start()
            self.arrivals.put(job)
        return job.future

    def close(self) -> None:
        """Stop after the present token; what was not answered is cancelled."""
        with self.lock:
            self.ended = True
            self.arrivals.put(None)
        if self.thread:
            self.thread.join()

    # ------------------------------------------------------------------ the owner's thread
    def _own(self) -> None:
        try:
            with torch.inference_mode():
                while self._arrive():
                    self._admit()
                    if self.jobs:
                        self._step()
        finally:
            self._abandon(sys.exc_info()[1])

    def _arrive(self) -> bool:
        """Take what has arrived, waiting if there is nothing else to do; False to stop."""
        idle = not (self.jobs or self.waiting)
        while idle or not self.arrivals.empty():
            job = self.arrivals.get()
            if job is None:
                return False
            self.waiting.append(job)
            idle = False
        return True

    def _admit(self) -> None:
        while self.waiting and len(self.jobs) < self.limit:
            job = self.waiting.popleft()
            try:
                self._open(job)
            except (EngineFault, ValueError) as fault:
                self._leave(job)
                job.future.set_exception(fault)
            except RuntimeError as fault:
                self._out_of_memory(fault, job)

    def _open(self, job: Job) -> None:
        before = self.runner.calls
        self.jobs.append(job)
        request = job.request
        job.begin()
        for prompt in (request.with_context, request.without_context):
            if prompt:
                job.rows.append(self.runner.open(prompt, job.fed()))
        job.answer.model_calls += self.runner.calls - before

    def _step(self) -> None:
        """One forward pass a lane for all jobs, and what follows from it for each."""
        jobs = list(self.jobs)
        try:
            results = self._forward(jobs)
        except RuntimeError as fault:
            self._out_of_memory(fault)
            return
        # every job hears first: a row that moves into a freed slot takes only what its job has accepted
        faults = [self._hear(job, result) for job, result in zip(jobs, results, strict=True)]
        for job, wrong in zip(jobs, faults, strict=True):
            if wrong or job.finished:
                self._leave(job, keep=not wrong)
            if wrong:
                job.future.set_exception(wrong)
            elif job.finished:
                job.future.set_result(job.answer)

    def _hear(self, job: Job, result: Heard) -> EngineFault | None:
        if result.said is None:
            self._spoil(job)
            return BadLogits(f"the model gave NaN or inf behind token {len(job.answer.ids)} of the answer")
        try:
            job.hear(result.said, result.choices)
        except EngineFault as fault:
            return fault
        return None

    def _forward(self, jobs: list[Job]) -> list[Heard]:
        guesses = max(2, _GUESSES // len(jobs))
        chunks = [(row, chunk) for job in jobs for chunk in [job.chunk(guesses)] for row in job.rows]
        before = self.runner.calls
        logits = iter(self.runner.step(chunks))
        words = (self._vocabulary() + 31) // 32
        masks = [job.masks(words) for job in jobs]
        with_context, without_context = [], []
        for job in jobs:
            with_context.append(next(logits))
            without_context.append(next(logits) if len(job.rows) > 1 else None)
            job.answer.model_calls += self.runner.calls - before
        return heard(jobs, with_context, without_context, masks)

    def _vocabulary(self) -> int:
        return int(self.model.get_output_embeddings().weight.shape[0])

    def _leave(self, job: Job, keep: bool = False) -> None:
        self.jobs.remove(job)
        for row in reversed(job.rows):
            self.runner.close(row, job.answer.ids if keep else None)
        job.rows = []

    def _spoil(self, job: Job) -> None:
        """NaN in a slot would reach the next row there through a weight of 0."""
        self.runner.prefixes.clear()
        for row in job.rows:
            row.lane.cache.clear(row.slot)

    def _out_of_memory(self, fault: RuntimeError, opening: Job | None = None) -> None:
        """Halve the number of reports at once and start them again from their tokens so far."""
        if not _is_memory(fault):
            raise fault
        jobs, self.jobs = self.jobs, []
        for job in jobs:
            job.forget_guesses()
            job.rows = []
        self.runner.reset()
        if torch.cuda.is_available():
            torch.cuda.empty_cache()
        if len(jobs) == 1:
            jobs[0].future.set_exception(TooBig(f"one report alone does not fit in memory: {fault}"))
            return
        self.limit = max(1, len(jobs) // 2)
        self.halved += 1
        self.waiting.extendleft(reversed(jobs))

    def _abandon(self, fault: BaseException | None) -> None:
        """The loop has ended: nobody waits for ever."""
        with self.lock:
            self.ended = True
            self.reason = f": {type(fault).__name__}: {fault}" if fault else ""
        while not self.arrivals.empty():
            if job := self.arrivals.get():
                self.waiting.append(job)
        for job in [*self.jobs, *self.waiting]:
            job.future.set_exception(fault or EngineFault("the engine was closed before this report was answered"))


def _is_memory(fault: RuntimeError) -> bool:
    said = str(fault).lower()
    return isinstance(fault, torch.OutOfMemoryError) or ("alloc" in said and "memory" in said)
