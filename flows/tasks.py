"""Prefect's view of the work: a task run per case, inside it a named task run per attempt.

Only what Prefect should show stands in its states; results travel beside it (they lie on disk anyway, and
a cached Prefect result could outlive the folder it speaks of). Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, cast

from prefect import task
from prefect.cache_policies import NO_CACHE
from prefect.client.schemas.objects import State
from prefect.futures import PrefectFuture
from prefect.states import Completed, Failed
from prefect.task_runners import TaskRunner, ThreadPoolTaskRunner

from flows.batch import Crew, Job
from flows.chain import Ending
from sgcad_core.asking.refine import Turn
from sgcad_core.errors import SgcadError
from sgcad_core.records import Attempt

DECLINED = ("exhausted", "failed")


def threads(count: int) -> TaskRunner[PrefectFuture[Any]]:
    """A task runner of so many threads, in the type that Prefect's own decorator asks for."""
    return cast("TaskRunner[PrefectFuture[Any]]", ThreadPoolTaskRunner(max_workers=count))


@dataclass
class Board:
    """Where tasks leave endings and the fault that ends the batch; keys are job names."""

    jobs: dict[str, Job]
    crew: Crew
    endings: dict[str, Ending] = field(default_factory=dict)
    fatal: SgcadError | None = None


@task(name="attempt", cache_policy=NO_CACHE, persist_result=False)
def attempt_task(work: Callable[[], Turn], box: list[Turn]) -> State[Any]:
    """One attempt as a task run; its turn goes into `box`."""
    box.append(work())
    return attempt_state(box[0].attempt)


@task(name="attempt", cache_policy=NO_CACHE, persist_result=False)
def reported_attempt(name: str, seconds: float, message: str) -> State[Any]:
    """An attempt that ran in a worker process, shown afterwards."""
    return Completed(name=name, message=f"{seconds:.2f} s. {message}")


def attempt_state(attempt: Attempt) -> State[Any]:
    """Completed either way: to be sent back is an attempt's ordinary end."""
    name, message = _verdict(attempt)
    return Completed(name=name, message=message)


def _verdict(attempt: Attempt) -> tuple[str, str]:
    found = [f for f in attempt.findings if f.severity != "note"]
    name = "Repair" if any(f.severity != "doubt" for f in found) else "Doubted" if found else "Accepted"
    return name, "; ".join(f.line() for f in found)[:500]


def as_task(name: str, work: Callable[[], Turn]) -> Turn:
    """An `OnAttempt` that runs the attempt as a task run called `name`, such as "road[2]"."""
    box: list[Turn] = []
    attempt_task.with_options(task_run_name=plain(name))(_Quiet(work), box)
    return box[0]


def plain(name: str) -> str:
    """A run name is a format string to Prefect."""
    return name.replace("{", "(").replace("}", ")")


@dataclass(frozen=True)
class _Quiet:
    """Work that Prefect neither prints nor looks into."""

    work: Callable[[], Turn]

    def __call__(self) -> Turn:
        return self.work()

    def __repr__(self) -> str:
        return "work"


def case_task(board: Board) -> Any:
    """The task that finishes one job of the board, given its name."""

    @task(name="case", task_run_name="{job}", cache_policy=NO_CACHE, persist_result=False)
    def case(job: str) -> State[Any]:
        try:
            ending = board.crew.finish(board.jobs[job], as_task)
        except SgcadError as fault:
            board.fatal = fault
            return Failed(message=str(fault))
        if board.crew.began(board.jobs[job]):
            _report_attempts(ending)
        board.endings[job] = ending
        return _state(ending)

    return case


def _report_attempts(ending: Ending) -> None:
    for attempt in ending.attempts:
        state, message = _verdict(attempt)
        name = f"{attempt.stage}[{attempt.number}]"
        reported_attempt.with_options(task_run_name=name)(state, attempt.seconds, message)


def _state(ending: Ending) -> State[Any]:
    status, reason = ending.result["status"], ending.result["reason"]
    if ending.reused:
        return Completed(name="Cached", message=f"done before: {status}")
    if status in DECLINED:
        return Failed(name=status.capitalize(), message=reason)
    return Completed(name=status.capitalize(), message=reason)


def hush_prefect() -> None:
    """Keep Prefect's own lines from tearing the progress bar; every end is told by the command itself."""
    for name in ("prefect", "prefect.task_runs", "prefect.flow_runs", "EventsWorker", "APILogWorker"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
