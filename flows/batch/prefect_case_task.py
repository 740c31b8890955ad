"""A Prefect task run per case; its steps are shown by flows/batch/prefect_tasks.py.

States hold only what Prefect shows. Results are passed beside it: they are on disk, and a cached Prefect result could
outlive its folder. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from typing import Any, cast

from prefect import task
from prefect.cache_policies import NO_CACHE
from prefect.client.schemas.objects import State
from prefect.context import TaskRunContext
from prefect.futures import PrefectFuture
from prefect.states import Cancelled, Completed, Failed
from prefect.task_runners import TaskRunner, ThreadPoolTaskRunner

from flows.batch.plan_batch import Job, JobRunner
from flows.batch.prefect_tasks import StepRuns
from flows.case.run_case import Ending
from sgcad_core.asking.refine import run_at_once
from sgcad_core.errors import SgcadError
from sgcad_core.result import counts_of

DECLINED = ("exhausted", "failed")


def threads(count: int) -> TaskRunner[PrefectFuture[Any]]:
    """A task runner of `count` threads, in the type that Prefect's decorator expects."""
    return cast("TaskRunner[PrefectFuture[Any]]", ThreadPoolTaskRunner(max_workers=count))


@dataclass
class TaskBoard:
    """Endings that tasks leave, the runs that show their steps, and the fault that ends the batch, by job name."""

    jobs: dict[str, Job]
    runner: JobRunner
    endings: dict[str, Ending] = field(default_factory=dict)
    step_runs: dict[str, StepRuns] = field(default_factory=dict)
    every: bool = True
    """Whether every step of a case is shown."""
    fatal: SgcadError | None = None

    steps: int = 0
    """Number of task runs of steps shown for the cases taken, tracking included."""

    def take(self, job: str) -> tuple[Ending, StepRuns]:
        """The ending of a job; handed out once, since a long batch would keep 80 kB of memory per case."""
        ending, step_runs = self.endings.pop(job), self.step_runs.pop(job)
        self.steps += 0 if ending.reused else step_runs.every + sum(map(step_runs.shows, ending.steps))
        return ending, step_runs


def plain(name: str) -> str:
    """A name without braces, which Prefect would take for a format string."""
    return name.replace("{", "(").replace("}", ")")


def case_task(board: TaskBoard) -> Any:
    """The task that finishes one job of the board, given its name."""

    @task(name="case", task_run_name="{job}", cache_policy=NO_CACHE, persist_result=False)
    def case(job: str) -> State[Any]:
        try:
            step_runs = board.step_runs[job] = _graph(board.every)
            elsewhere = board.runner.began(board.jobs[job])
            ending = board.runner.finish(board.jobs[job], run_at_once, step_runs.tell)
        except SgcadError as fault:
            board.fatal = fault
            return Failed(message=str(fault))
        if elsewhere:
            for step in ending.steps:
                step_runs.tell(step)
        board.endings[job] = ending
        return _state(ending)

    return case


def _graph(every: bool) -> StepRuns:
    """The step runs of the current task run."""
    context = TaskRunContext.get()
    if context is None:
        raise RuntimeError("a case is finished in a task run of Prefect's")
    return StepRuns(str(context.task_run.flow_run_id), str(context.task_run.id), every)


def _state(ending: Ending) -> State[Any]:
    status, reason = ending.result["status"], ending.result["reason"]
    if ending.reused:
        return Completed(name="Cached", message=f"done before: {status}")
    if status in DECLINED:
        return Failed(name=status.capitalize(), message=reason)
    if status == "refused":  # a result, not a success: Prefect shows it gray
        return Cancelled(name="Refused", message=reason)
    account = counts_of(ending.result)
    if account and account["verdict"] == "lacking":
        message = f"{account['lacking']} of {account['told']} things told are lacking"
        return Completed(name="Lacking", message=message)
    return Completed(name=status.capitalize(), message=reason)


def silence_prefect() -> None:
    """Silence Prefect's own log lines, which break the progress bar; the command reports every ending."""
    for name in ("prefect", "prefect.task_runs", "prefect.flow_runs", "EventsWorker", "APILogWorker"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
