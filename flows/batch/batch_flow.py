"""A batch as one Prefect flow run: cases times configs, tracked from one thread, in order of ending.

The command line calls `run_flow` on a checked batch; a deployment's flow calls `run_inside_flow`. Import after
`settings.quiet_libraries()` and with a server named or none wanted (flows/server.py).
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

from prefect import flow
from prefect.client.orchestration import get_client
from prefect.events.worker import EventsWorker
from prefect.futures import as_completed
from prefect.runtime import flow_run
from prefect.settings import PREFECT_API_URL, PREFECT_FLOWS_HEARTBEAT_FREQUENCY, temporary_settings

from flows.batch import track_cases
from flows.batch.plan_batch import Batch, Job, JobRunner
from flows.batch.prefect_case_end import CaseReporter, case_reporter, shows_every_step
from flows.batch.prefect_case_task import TaskBoard, case_task, plain, silence_prefect, threads
from flows.batch.track_cases import OnEnding
from sgcad_core import settings

MOST_NAMED = 3
"""Configs that the name of a flow run names."""
DRAIN_S, STOP_S = 60.0, 2.0
"""Maximum wait for the last states to reach the server, at a normal end and after a fault or Ctrl-C."""


def run_flow(batch: Batch, plan: Sequence[Job], runner: JobRunner, on_ending: OnEnding, lasting: bool = False) -> None:
    """Run a batch as one flow run. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt.

    With a `lasting` server the job runner starts here, so that no case starts before the flow run that shows it.

    Returns when the server has every state: states are sent as events in the background, and a server of the command
    ends with it. Prefect's heartbeat is off: its thread costs every flow a second.
    """
    silence_prefect()
    with temporary_settings({PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None} | _server_named()):
        run: list[tuple[str, int]] = []
        patience = STOP_S  # after a fault the server may be gone
        try:
            flow_of = _flow(batch, plan, runner, on_ending, run, lasting)
            flow_of([c.name for c in batch.configs], len(batch.cases), str(batch.out))
            patience = DRAIN_S
        finally:
            EventsWorker.drain_all(timeout=patience)
        for identity, task_runs in run:
            _settle(identity, task_runs, patience)


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


def _settle(identity: str, task_runs: int, patience: float) -> None:
    """Wait until the server has `task_runs` ended task runs of a flow run, at most `patience` seconds."""
    ended = {"type": {"any_": ["COMPLETED", "FAILED", "CRASHED", "CANCELLED"]}}
    body = {"flow_runs": {"id": {"any_": [identity]}}, "task_runs": {"state": ended}}
    deadline = time.monotonic() + patience
    with get_client(sync_client=True) as client:
        while time.monotonic() < deadline:
            if client.request("POST", "/task_runs/count", json=body).json() >= task_runs:
                return
            time.sleep(0.2)


def _flow(
    batch: Batch, plan: Sequence[Job], runner: JobRunner, on_ending: OnEnding, run: list[tuple[str, int]], lasting: bool
) -> Any:
    """The flow of one batch; its parameters are for display. Its id and number of task runs are added to `run`."""
    task_runner = threads(batch.jobs)

    @flow(
        name=batch.flow,
        flow_run_name=plain(batch.title or run_name(batch)),
        task_runner=task_runner,
        persist_result=False,
    )
    def evaluate(configs: list[str], cases: int, out: str) -> None:
        if lasting:
            runner.begin(plan)
        task_runs = submit_and_follow(plan, runner, on_ending, lasting)
        run.append((str(flow_run.id), task_runs))

    return evaluate


def run_inside_flow(batch: Batch, on_ending: OnEnding, plan: Sequence[Job] | None = None) -> None:
    """Run a batch, or some of its jobs, inside the flow run of a deployment."""
    plan, runner = batch.plan() if plan is None else plan, JobRunner(batch)
    runner.begin(plan)
    submit_and_follow(plan, runner, on_ending)
    runner.close()


def counts_inside_flow(batch: Batch, plan: Sequence[Job] | None = None) -> dict[str, int]:
    """`run_inside_flow`; the number of cases by the status that they ended with."""
    counts: Counter[str] = Counter()
    run_inside_flow(batch, lambda _job, ending, _untracked: counts.update([ending.result["status"]]), plan)
    return dict(counts)


def submit_and_follow(plan: Sequence[Job], runner: JobRunner, on_ending: OnEnding, lasting: bool = True) -> int:
    """Submit every job, track and show it as it ends; the number of task runs. Call it inside a flow run."""
    board = TaskBoard({job.name: job for job in plan}, runner, every=shows_every_step())
    task = case_task(board)
    submitted = {task.submit(job.name): job for job in plan}
    try:
        with track_cases.tracked_batch(plan), case_reporter(lasting) as shown:
            _follow(board, submitted, on_ending, shown)
    except BaseException:
        runner.stop()
        raise
    return len(plan) + board.steps


def _follow(board: TaskBoard, submitted: dict[Any, Job], on_ending: OnEnding, shown: CaseReporter) -> None:
    for done in as_completed(list(submitted)):
        if board.fatal:
            raise board.fatal
        job = submitted[done]
        if job.name not in board.endings:
            done.result()  # the task itself crashed: Prefect's own fault is raised
        ending, step_runs = board.take(job.name)
        on_ending(job, ending, shown.case(job, ending, step_runs))
