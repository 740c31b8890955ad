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
from prefect.settings import PREFECT_API_URL, PREFECT_FLOWS_HEARTBEAT_FREQUENCY, temporary_settings

from flows.batch import find_cases, track_cases
from flows.batch.plan_batch import MAX_JOBS, Batch, Crew, Job, batch_of
from flows.batch.prefect_case_task import Board, case_task, hush_prefect, plain, threads
from flows.batch.track_cases import OnEnding
from flows.case.case_end import Showing, showing, shows_every_step
from flows.case.chain import Ending
from sgcad_core import settings

MOST_NAMED = 3
"""Configs that the name of a flow run names."""
DRAIN_S, STOP_S = 60.0, 2.0
"""How long the last states may take to reach the server, at an ordinary end and after a fault or Ctrl-C."""


def run_flow(batch: Batch, plan: Sequence[Job], crew: Crew, on_ending: OnEnding, lasting: bool = False) -> None:
    """Run a batch as one flow run. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt.

    Where the server is `lasting` the crew begins here, so that no case began before the flow run that shows it.

    Returns when the server has every state: they travel as events in the background, and a server of our own
    ends with the command. Prefect's heartbeat is off: its thread costs every flow a second, and a person
    watches this one.
    """
    hush_prefect()
    with temporary_settings({PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None} | _server_named()):
        run: list[tuple[str, int]] = []
        patience = STOP_S  # after a fault nobody may be there to take the last states
        try:
            flow_of = _flow(batch, plan, crew, on_ending, run, lasting)
            flow_of([c.name for c in batch.configs], len(batch.cases), str(batch.out))
            patience = DRAIN_S
        finally:
            EventsWorker.drain_all(timeout=patience)
        for identity, task_runs in run:
            _settle(identity, task_runs, patience)


def _server_named() -> dict[Any, str]:
    """The server of now: Prefect read its settings when it was imported, and a lost server has a successor."""
    url = settings.prefect_url()
    return {PREFECT_API_URL: url} if url else {}


def run_name(batch: Batch) -> str:
    """What a flow run does, in a few words: "template over 12 reports"."""
    configs = ", ".join(config.name for config in batch.configs[:MOST_NAMED])
    more = f" and {len(batch.configs) - MOST_NAMED} more" if len(batch.configs) > MOST_NAMED else ""
    reports = batch.cases[0].id if len(batch.cases) == 1 else f"{len(batch.cases)} reports"
    return f"{configs}{more} over {reports}"


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


def _flow(
    batch: Batch, plan: Sequence[Job], crew: Crew, on_ending: OnEnding, run: list[tuple[str, int]], lasting: bool
) -> Any:
    """The flow of one batch; its parameters are for people to read. Its id and task runs go into `run`."""
    runner = threads(batch.jobs)

    @flow(
        name=batch.flow, flow_run_name=plain(batch.title or run_name(batch)), task_runner=runner, persist_result=False
    )
    def evaluate(configs: list[str], cases: int, out: str) -> None:
        if lasting:
            crew.begin(plan)
        task_runs = drive(plan, crew, on_ending, lasting)
        run.append((str(flow_run.id), task_runs))

    return evaluate


def drive(plan: Sequence[Job], crew: Crew, on_ending: OnEnding, lasting: bool = True) -> int:
    """Submit every job, track and show it as it ends; how many task runs that were. Call it inside a flow run."""
    board = Board({job.name: job for job in plan}, crew, every=shows_every_step())
    task = case_task(board)
    submitted = {task.submit(job.name): job for job in plan}
    try:
        with track_cases.following(plan), showing(lasting) as shown:
            _follow(board, submitted, on_ending, shown)
    except BaseException:
        crew.stop()
        raise
    return len(plan) + board.steps


def _follow(board: Board, submitted: dict[Any, Job], on_ending: OnEnding, shown: Showing) -> None:
    for done in as_completed(list(submitted)):
        if board.fatal:
            raise board.fatal
        job = submitted[done]
        if job.name not in board.endings:
            done.result()  # the task itself crashed: Prefect's own fault, said as it is
        ending, graph = board.take(job.name)
        on_ending(job, ending, shown.case(job, ending, graph))


@flow(name="evaluate-deployed", flow_run_name="evaluate {folders}", task_runner=threads(MAX_JOBS), persist_result=False)
def evaluate_flow(
    folders: list[str],
    configs: list[str] | None = None,
    out: str = "runs",
    overrides: list[str] | None = None,
    jobs: int | None = None,
) -> dict[str, int]:
    """A batch from plain parameters, for deployments; how many cases ended in which status."""
    paths = settings.configs_or_default(configs)
    batch = batch_of(find_cases.cases_in([Path(f) for f in folders]), paths, Path(out), overrides or (), jobs)
    plan, crew = batch.plan(), Crew(batch)
    counts: dict[str, int] = {}

    def count(job: Job, ending: Ending, untracked: str) -> None:
        counts[ending.result["status"]] = counts.get(ending.result["status"], 0) + 1

    crew.begin(plan)
    drive(plan, crew, count)
    crew.close()
    return counts
