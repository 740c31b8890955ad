"""A checked batch run to its end: finished jobs, workers, server, flow, in this order.

Prefect is imported only if a job is left to run.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass

from flows.batch import track_cases
from flows.batch.plan_batch import Batch, Job, JobRunner, OnTurn
from flows.batch.track_cases import OnEnding
from flows.case.run_case import Ending
from flows.server import Server, ServerLost, prefect_server
from sgcad_core import settings


@dataclass(frozen=True)
class Cost:
    """Cost of a batch beside its cases: processor seconds of this process (planning, Prefect's client, tracking, and a
    model if one runs here) and of the command's own Prefect server (None: the user's server)."""

    done: int
    """Cases run now, without those found finished."""
    elapsed_s: float
    own_s: float = 0.0
    server_s: float | None = None


def evaluate(
    batch: Batch, on_ending: OnEnding, plan: Sequence[Job] | None = None, on_turn: OnTurn | None = None
) -> Cost:
    """Run a batch, or some of its jobs. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt.

    Finished cases stay on disk in any event.
    """
    settings.quiet_libraries()
    started, spent = time.perf_counter(), time.process_time()
    plan = batch.plan() if plan is None else plan
    runner = JobRunner(batch, on_turn)
    if (done := _all_done(plan, runner)) is not None:
        for job, ending in done:
            on_ending(job, ending, "")
        return Cost(0, time.perf_counter() - started, time.process_time() - spent)
    fresh = sum(runner.reusable(job) is None for job in plan)
    server_s = _run(batch, plan, runner, on_ending)
    return Cost(fresh, time.perf_counter() - started, time.process_time() - spent, server_s)


def _run(batch: Batch, plan: Sequence[Job], runner: JobRunner, on_ending: OnEnding) -> float | None:
    """Run the jobs that are left; processor seconds of the server.

    A lost server of the command is replaced once: cases do not need it, it only shows them.
    """
    told: set[str] = set()

    def tell(job: Job, ending: Ending, untracked: str) -> None:
        if job.name not in told:
            told.add(job.name)
            on_ending(job, ending, untracked)

    try:
        return _under_a_server(batch, plan, runner, tell)
    except ServerLost as lost:
        logging.getLogger(__name__).warning("%s; another one is started", lost.how)
    return _under_a_server(batch, plan, JobRunner(batch, runner.on_turn, frozenset(told)), tell)


def _under_a_server(batch: Batch, plan: Sequence[Job], runner: JobRunner, on_ending: OnEnding) -> float | None:
    try:
        with prefect_server() as server:
            if server:  # it takes seconds to start
                runner.begin(plan)
            from flows.batch.batch_flow import run_flow

            if server:
                server.wait()
            run_flow(batch, plan, runner, on_ending, lasting=server is None)
            server_s = _processor_s(server) if server else None
    except BaseException:
        runner.stop()
        raise
    runner.close()
    return server_s


def _processor_s(server: Server) -> float | None:
    import psutil

    try:
        times = psutil.Process(server.process.pid).cpu_times()
    except psutil.Error:
        return None
    return float(times.user + times.system)


def _all_done(plan: Sequence[Job], runner: JobRunner) -> list[tuple[Job, Ending]] | None:
    """Endings of a batch whose cases are all finished and tracked; None if a job is left."""
    done = []
    for job in plan:
        ending = runner.reusable(job)
        if ending is None or not track_cases.tracked(job):
            return None
        done.append((job, ending))
    return done
