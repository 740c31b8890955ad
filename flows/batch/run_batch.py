"""A checked batch run to its end, as a Prefect flow run or without Prefect.

Prefect is imported only if a job is left to run under it.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

from flows.batch import case_order, lanes
from flows.batch.case_order import OnStep
from flows.batch.lanes import Death, Lane, Stop, parted, watched
from flows.batch.plan_batch import Batch, Job
from flows.batch.tracking import track_cases
from flows.batch.tracking.track_cases import OnEnding
from flows.case.run_case import Ending
from flows.server import Server, ServerLost, prefect_server
from sgcad_core import settings
from sgcad_core.interfaces import Backbone, Simulator, Validator


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
    batch: Batch, on_ending: OnEnding, plan: Sequence[Job] | None = None, on_step: OnStep | None = None
) -> Cost:
    """Run a batch, or some of its jobs, under Prefect. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt.

    Finished cases stay on disk in any event.
    """
    settings.quiet_libraries()
    started, spent = time.perf_counter(), time.process_time()
    plan = batch.plan() if plan is None else plan
    if (done := _all_done(batch, plan)) is not None:
        batch.keep_left_out(plan)
        for job, ending in done:
            on_ending(job, ending, "")
        return Cost(0, time.perf_counter() - started, time.process_time() - spent)
    left = [job for job in plan if batch.reusable(job) is None]
    if not batch.is_remote:
        _load_model(left)
    with watched(on_step, Stop()):  # the flow has its own stop
        server_s = _run(batch, plan, on_ending)
    return Cost(len(left), time.perf_counter() - started, time.process_time() - spent, server_s)


def evaluate_alone(
    batch: Batch, on_ending: OnEnding, plan: Sequence[Job] | None = None, on_step: OnStep | None = None
) -> Cost:
    """`evaluate` without Prefect and without tracking: the same steps, called at once."""
    started, spent = time.perf_counter(), time.process_time()
    plan = batch.plan() if plan is None else plan
    done, left = batch.opened(plan)
    for job, ending in done:
        on_ending(job, ending, "")
    stop = Stop()
    with watched(on_step, stop):
        try:
            if len(left) == 1:
                threading.Thread(target=_load_programs, args=(left[0],), daemon=True, name="programs").start()
            _load_model(left)
            if len(left) == 1:
                on_ending(left[0], _here(batch, left[0]), "")
            else:
                _through_lanes(batch, left, on_ending, stop)
        except BaseException:
            stop.ask()
            raise
    return Cost(len(left), time.perf_counter() - started, time.process_time() - spent)


def _here(batch: Batch, job: Job) -> Ending:
    """One case, in this thread."""
    case_order.know(job.config)
    return case_order.run_order(batch.order(job))


def _through_lanes(batch: Batch, jobs: Sequence[Job], on_ending: OnEnding, stop: Stop) -> None:
    asking, plain = parted(jobs, lambda job: job.config.backbone)
    for job in asking:
        case_order.know(job.config)
    run, order = case_order.run_order, batch.order
    processes = Lane(plain, min(batch.processes, len(plain)), partial(lanes.open_processes, run=run, order=order))
    threads = Lane(asking, batch.jobs, partial(lanes.open_threads, run=run, order=order))
    for job, outcome in lanes.through([processes, threads], stop):
        if isinstance(outcome, Death):
            outcome = batch.failed(job, outcome.reason)
        on_ending(job, outcome, "")


def _run(batch: Batch, plan: Sequence[Job], on_ending: OnEnding) -> float | None:
    """Run the jobs that are left; processor seconds of the server.

    A lost server of the command is replaced once: cases do not need it, it only shows them.
    """
    told: set[str] = set()

    def tell(job: Job, ending: Ending, untracked: str) -> None:
        told.add(job.name)
        on_ending(job, ending, untracked)

    try:
        return _under_a_server(batch, plan, tell)
    except ServerLost as lost:
        logging.getLogger(__name__).warning("%s; another one is started", lost.how)
    return _under_a_server(batch, [job for job in plan if job.name not in told], tell)


def _under_a_server(batch: Batch, plan: Sequence[Job], on_ending: OnEnding) -> float | None:
    with prefect_server() as server:
        from flows.batch.batch_flow import run_flow

        if server:
            server.wait()
        run_flow(batch, plan, on_ending, lasting=server is None)
        return _processor_s(server) if server else None


def _load_model(jobs: Sequence[Job]) -> None:
    """Load the first model that is needed, while a server starts or a report is read."""
    if model := next((job.config.backbone for job in jobs if job.config.backbone), None):
        threading.Thread(target=_load, args=(model,), daemon=True, name="load").start()


def _load(model: Backbone) -> None:
    with suppress(Exception):  # the first question reports the fault with its case
        model.load()


def _load_programs(job: Job) -> None:
    """Start what checks and plays a case in processes of its own, while its report is read."""
    programs: tuple[Validator | Simulator, ...] = (*job.config.validators, job.config.simulator)
    for plugin in programs:
        with suppress(Exception):  # the first call reports the fault with its case
            plugin.load()


def _processor_s(server: Server) -> float | None:
    import psutil

    try:
        times = psutil.Process(server.process.pid).cpu_times()
    except psutil.Error:
        return None
    return float(times.user + times.system)


def _all_done(batch: Batch, plan: Sequence[Job]) -> list[tuple[Job, Ending]] | None:
    """Endings of a batch whose cases are all finished and tracked; None if a job is left."""
    done = []
    for job in plan:
        ending = batch.reusable(job)
        if ending is None or not track_cases.tracked(job):
            return None
        done.append((job, ending))
    return done
