"""A batch as one Prefect flow run: cases times configs, tracked from here, one thread, in order of ending.

`evaluate_flow` is what a deployment serves; the command line calls `run_flow` on a batch it has checked.
Import after `settings.quiet_libraries()` and with a server named or none wanted (flows/server.py).
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from prefect import flow
from prefect.client.orchestration import get_client
from prefect.events.worker import EventsWorker
from prefect.futures import as_completed
from prefect.runtime import flow_run
from prefect.settings import PREFECT_FLOWS_HEARTBEAT_FREQUENCY, temporary_settings

from flows import cases, tracking
from flows.batch import MAX_JOBS, Batch, Crew, Job, batch_of
from flows.chain import Ending
from flows.tasks import Board, case_task, hush_prefect, plain, threads
from flows.tracking import OnEnding

DRAIN_S, STOP_S = 60.0, 2.0
"""How long the last states may take to reach the server, at an ordinary end and at Ctrl-C."""


def run_flow(batch: Batch, plan: Sequence[Job], crew: Crew, on_ending: OnEnding) -> None:
    """Run a begun batch as one flow run. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt.

    Returns when the server has every state: they travel as events in the background, and a server of our own
    ends with the command. Prefect's heartbeat is off: its thread costs every flow a second, and a person
    watches this one.
    """
    hush_prefect()
    run: list[tuple[str, int]] = []
    try:
        with temporary_settings({PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None}):
            flow_of = _flow(batch, plan, crew, on_ending, run)
            flow_of([c.name for c in batch.configs], len(batch.cases), str(batch.out))
    finally:
        patience = STOP_S if crew.stopping.is_set() else DRAIN_S
        EventsWorker.drain_all(timeout=patience)
    for identity, task_runs in run:
        _settle(identity, task_runs, patience)


def _settle(identity: str, task_runs: int, patience: float) -> None:
    """Wait until the server has so many ended task runs of a flow run, or patience ends."""
    ended = {"type": {"any_": ["COMPLETED", "FAILED", "CRASHED", "CANCELLED"]}}
    body = {"flow_runs": {"id": {"any_": [identity]}}, "task_runs": {"state": ended}}
    deadline = time.monotonic() + patience
    with get_client(sync_client=True) as client:
        while time.monotonic() < deadline:
            if client.request("POST", "/task_runs/count", json=body).json() >= task_runs:
                return
            time.sleep(0.2)


def _flow(batch: Batch, plan: Sequence[Job], crew: Crew, on_ending: OnEnding, run: list[tuple[str, int]]) -> Any:
    """The flow of one batch; its parameters are for people to read. Its id and task runs go into `run`."""
    runner = threads(batch.jobs)

    @flow(name=batch.flow, flow_run_name=plain(batch.title) or None, task_runner=runner, persist_result=False)
    def evaluate(configs: list[str], cases: int, out: str) -> None:
        task_runs = drive(plan, crew, on_ending)
        run.append((str(flow_run.id), task_runs))

    return evaluate


def drive(plan: Sequence[Job], crew: Crew, on_ending: OnEnding) -> int:
    """Submit every job and track it as it ends; how many task runs that were. Call it inside a flow run."""
    board = Board({job.name: job for job in plan}, crew)
    task = case_task(board)
    submitted = {task.submit(job.name): job for job in plan}
    try:
        with tracking.following(plan):
            _follow(board, submitted, on_ending)
    except BaseException:
        crew.stop()
        raise
    return len(plan) + sum(len(ending.attempts) for ending in board.endings.values())


def _follow(board: Board, submitted: dict[Any, Job], on_ending: OnEnding) -> None:
    for done in as_completed(list(submitted)):
        if board.fatal:
            raise board.fatal
        job = submitted[done]
        if job.name not in board.endings:
            done.result()  # the task itself crashed: Prefect's own fault, said as it is
        ending = board.endings[job.name]
        on_ending(job, ending, tracking.track_safely(job, ending))


@flow(name="evaluate-deployed", task_runner=threads(MAX_JOBS), persist_result=False)
def evaluate_flow(
    folders: list[str],
    configs: list[str] | None = None,
    out: str = "runs",
    overrides: list[str] | None = None,
    jobs: int | None = None,
) -> dict[str, int]:
    """A batch from plain parameters, for deployments; how many cases ended in which status."""
    paths = [Path(c) for c in configs or ["template.yaml"]]
    batch = batch_of(cases.cases_in([Path(f) for f in folders]), paths, Path(out), overrides or (), jobs)
    plan, crew = batch.plan(), Crew(batch)
    counts: dict[str, int] = {}

    def count(job: Job, ending: Ending, untracked: str) -> None:
        counts[ending.result["status"]] = counts.get(ending.result["status"], 0) + 1

    crew.begin(plan)
    drive(plan, crew, count)
    crew.close()
    return counts
