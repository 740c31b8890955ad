"""A batch as one Prefect flow run: cases times configs, tracked from one thread, in order of ending.

The command line calls `run_flow` on a checked batch; a deployment's flow calls `run_inside_flow`. Import after
`settings.quiet_libraries()` and with a server named (flows/server.py).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from dataclasses import replace
from typing import Any

from prefect import flow
from prefect.client.orchestration import get_client
from prefect.events.worker import EventsWorker
from prefect.runtime import flow_run
from prefect.settings import (
    PREFECT_API_URL,
    PREFECT_CLIENT_MAX_RETRIES,
    PREFECT_FLOWS_HEARTBEAT_FREQUENCY,
    PREFECT_LOGGING_LEVEL,
    temporary_settings,
)

from flows.batch.case_order import watching
from flows.batch.case_task import plain, silence_prefect, tell_crashes
from flows.batch.lanes import Death, Stop, through, watched
from flows.batch.plan_batch import Batch, Job
from flows.batch.prefect_case_end import CaseReporter, case_reporter
from flows.batch.task_runners import lanes_of
from flows.batch.tracking import track_cases
from flows.batch.tracking.track_cases import OnEnding
from sgcad_core import settings

MOST_NAMED = 3
"""Configs that the name of a flow run names."""
DRAIN_S, STOP_S = 60.0, 2.0
"""Maximum wait for the last states to reach the server, at a normal end and after a fault or Ctrl-C."""
OWN_TRIES = 1
"""Repeated requests to a server of the command's own: one that was killed does not come back."""

_work: ContextVar[Callable[[], int]] = ContextVar("work")
"""What the flow of the command line does; its parameters are for display."""


@flow(name="evaluate", flow_run_name="{title}", persist_result=False, validate_parameters=False)
def evaluate(title: str, configs: list[str], cases: int, out: str) -> int:
    """Turn reports into scenarios under one or several configs; the number of cases that were run."""
    return current_work()


def current_work() -> int:
    """Do the work of the flow run that this thread has begun."""
    return _work.get()()


def run_flow(batch: Batch, plan: Sequence[Job], on_ending: OnEnding, lasting: bool = False) -> None:
    """Run a batch as one flow run. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt.

    `lasting`: the server outlives the command. Returns when the server has every state: states are sent as events in
    the background, and a server of the command ends with it. Prefect's heartbeat is off: its thread costs every flow a
    second.
    """
    silence_prefect()
    runs: list[tuple[str, int]] = []
    token = _work.set(lambda: _noted(batch, plan, on_ending, lasting, runs))
    patience = STOP_S  # after a fault the server may be gone
    quiet: dict[Any, Any] = {PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None, PREFECT_LOGGING_LEVEL: "CRITICAL"}
    quiet |= {} if lasting else {PREFECT_CLIENT_MAX_RETRIES: OWN_TRIES}
    with temporary_settings(quiet | _server_named()):
        try:
            named = evaluate.with_options(name=batch.flow)
            title = plain(batch.title or run_name(batch))
            named(title, [c.name for c in batch.configs], len(batch.cases), str(batch.out))
            patience = DRAIN_S
        finally:
            _work.reset(token)
            EventsWorker.drain_all(timeout=patience)
        for identity, count in runs:
            _settle(identity, count, patience)


def _noted(batch: Batch, plan: Sequence[Job], on_ending: OnEnding, lasting: bool, runs: list[tuple[str, int]]) -> int:
    count = run_jobs(batch, plan, on_ending, lasting)
    runs.append((str(flow_run.id), count))
    return count


def _server_named() -> dict[Any, str]:
    """Settings that name the current server: Prefect read its settings on import, and a lost server is replaced."""
    url = settings.prefect_url()
    return {PREFECT_API_URL: url} if url else {}


def run_name(batch: Batch) -> str:
    """Name of a batch's flow run, such as "template over 12 reports"."""
    configs = ", ".join(config.name for config in batch.configs[:MOST_NAMED])
    more = f" and {len(batch.configs) - MOST_NAMED} more" if len(batch.configs) > MOST_NAMED else ""
    reports = batch.cases[0].id if len(batch.cases) == 1 else f"{len(batch.cases)} reports"
    return f"{configs}{more} over {reports}"


def _settle(identity: str, count: int, patience: float) -> None:
    """Wait until the server has the end of `count` tasks of cases of a flow run, at most `patience` seconds."""
    ended = {"type": {"any_": ["COMPLETED", "FAILED", "CRASHED", "CANCELLED"]}}
    body = {"flow_runs": {"id": {"any_": [identity]}}, "task_runs": {"state": ended, "name": {"like_": "/"}}}
    deadline = time.monotonic() + patience
    with get_client(sync_client=True) as client:
        while time.monotonic() < deadline:
            if client.request("POST", "/task_runs/count", json=body).json() >= count:
                return
            time.sleep(0.1)


def run_inside_flow(batch: Batch, on_ending: OnEnding, plan: Sequence[Job] | None = None) -> None:
    """Run a batch, or some of its jobs, inside the flow run of a deployment."""
    run_jobs(batch, batch.plan() if plan is None else plan, on_ending, lasting=True)


def run_jobs(batch: Batch, plan: Sequence[Job], on_ending: OnEnding, lasting: bool) -> int:
    """Run the jobs that are left, each as a task, and track them as they end. Call it inside a flow run.

    The number of task runs whose names have a "/": of cases and their tracking. One whose process died may be unknown
    to the server.
    """
    batch = replace(batch, lasting=lasting)
    done, left = batch.opened(plan)
    stop, deaths = Stop(), 0
    try:
        with watched(watching.get(), stop), track_cases.tracked_batch(plan), case_reporter(lasting) as reporter:
            for job, ending in done:
                on_ending(job, ending, reporter.former(job, ending))
            for job, outcome in through(lanes_of(batch, left), stop):
                deaths += isinstance(outcome, Death)
                _end(batch, job, outcome, on_ending, reporter)
        tell_crashes()
    except BaseException:
        stop.ask()
        raise
    return (len(left) - deaths) * (2 if batch.detail == "stage" else 1)  # the case and its tracking


def _end(batch: Batch, job: Job, outcome: Any, on_ending: OnEnding, reporter: CaseReporter) -> None:
    """Track and tell the end of a case: a task's state, or the death of its process."""
    if isinstance(outcome, Death):
        ending = batch.failed(job, outcome.reason)
        on_ending(job, ending, reporter.former(job, ending))
        return
    on_ending(job, *reporter.case(job, outcome, stages=batch.detail == "stage"))
