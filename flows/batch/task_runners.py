"""Where the cases of a flow run are run: Prefect's task runners, by the setting `workers`.

    auto         cases without a model in processes, those with one in threads of this process
    threads      all in threads of this process
    processes    all in processes, each with a model of its own
    dask         in a Dask cluster that lasts as long as the flow run
    tcp://...    in the Dask cluster of that scheduler (docs/scale.md)

Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, NoReturn, cast

import prefect.engine
from prefect.futures import PrefectFuture
from prefect.task_runners import ProcessPoolTaskRunner, TaskRunner, ThreadPoolTaskRunner

from flows.batch.case_order import know, prepare_process
from flows.batch.case_task import any_crashed, case, note_crash, plain
from flows.batch.lanes import Lane, Submit, parted
from flows.batch.plan_batch import Batch, Job
from flows.batch.remote import dask_lane, sent_case
from flows.case.steps import Held

Runner = TaskRunner[PrefectFuture[Any]]


def lanes_of(batch: Batch, jobs: Sequence[Job]) -> list[Lane]:
    """The batch's jobs by the task runner that takes them."""
    for job in jobs:
        know(job.config)
    workers = batch.workers
    if batch.is_remote:
        away, here = parted(jobs, lambda job: sent_case.can_be_sent(job.case.source))
        return [dask_lane.dask_lane(batch, away), _lane(batch, here, batch.processes, _processes)]
    asking, rest = parted(jobs, lambda job: workers == "threads" or (workers == "auto" and job.config.backbone))
    return [_lane(batch, rest, batch.processes, _processes), _lane(batch, asking, batch.jobs, _threads)]


def _lane(batch: Batch, jobs: Sequence[Job], width: int, runner: Callable[[int], Runner]) -> Lane:
    return Lane(jobs, width, partial(_open, batch, runner), _outcome, note_crash)


@contextmanager
def _open(batch: Batch, runner: Callable[[int], Runner], width: int) -> Iterator[Submit]:
    with runner(width) as pool:
        yield lambda job: pool.submit(case, {"name": plain(job.name), "order": Held(batch.order(job))})
        if any_crashed() and (messages := getattr(pool, "_subprocess_message_queue", None)):
            messages.cancel_join_thread()  # a process that was killed may have had the queue's lock


def _threads(width: int) -> Runner:
    return cast("Runner", ThreadPoolTaskRunner(max_workers=width))


def _processes(width: int) -> Runner:
    return cast("Runner", ProcessPoolTaskRunner(max_workers=width, initializer=prepare_worker))


def prepare_worker() -> None:
    """Start a worker process of Prefect's pool, in which no fault of Prefect's is an exit.

    Prefect's engine calls `exit` where the server does not answer when a task begins. The pool hands SystemExit on to
    the parent, where it ends the thread that manages the pool: every future would stay open for good.
    """
    prepare_process()
    vars(prefect.engine)["exit"] = _no_exit


def _no_exit(code: int = 0) -> NoReturn:
    raise RuntimeError(f"Prefect gave a task up (exit code {code}); its server may be gone")


def _outcome(future: Any) -> Any:
    """The final state of a task. Raises BrokenExecutor where its process died."""
    return future.wrapped_future.result()
