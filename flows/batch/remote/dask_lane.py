"""Cases through a Dask cluster: one of this machine that lasts as long as the flow run, or the user's scheduler.

Dask starts again elsewhere what a dead worker had. A case whose workers died more often than the scheduler allows
(`distributed.scheduler.allowed-failures`) may only have been on a worker with the cause: flows/batch/lanes.py runs it
again alone. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import logging
import shutil
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager, nullcontext
from functools import partial
from typing import TYPE_CHECKING, Any

from prefect import Task

from flows.batch.case_task import note_crash, plain
from flows.batch.lanes import Lane, Submit
from flows.batch.plan_batch import Batch, Job
from flows.batch.remote import store
from flows.batch.remote.sent_case import sent, sent_case
from flows.case.steps import Held
from flows.case_files.find_cases import config_digest
from sgcad_core.errors import MissingTool

if TYPE_CHECKING:
    from prefect_dask.task_runners import DaskTaskRunner

IN_FLIGHT = 512
"""Cases handed to a scheduler at a time: enough for its workers, and few reports are in memory."""
GPU = "GPU"
"""Dask's resource that a case of a config with a model takes one of: `dask worker ... --resources GPU=16`."""


def dask_lane(batch: Batch, jobs: Sequence[Job]) -> Lane:
    """Jobs for a Dask cluster."""
    if batch.fresh:
        shutil.rmtree(batch.store, ignore_errors=True)  # a folder of the output: `Batch.shown`
    digests = {name: config_digest(config) for name, config in {j.config.name: j.config for j in jobs}.items()}
    width = IN_FLIGHT if batch.has_scheduler else batch.processes
    return Lane(jobs, width, partial(_open, batch, digests), _outcome, note_crash, _cancel, ahead=1)


@contextmanager
def _open(batch: Batch, digests: Mapping[str, str], width: int) -> Iterator[Submit]:
    kept = sent_case.with_options(result_storage=store.save(batch.store))
    runner = _runner(batch, width)
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # its lines break the progress bar
    with runner as pool:
        if batch.has_scheduler:
            _look(batch, pool)
        yield partial(_submit, batch, digests, kept, pool)


def _submit(batch: Batch, digests: Mapping[str, str], kept: Task[..., Any], pool: DaskTaskRunner, job: Job) -> Any:
    from dask.base import annotate

    order = sent(batch.order(job), digests[job.config.name])
    takes = {GPU: 1} if batch.has_scheduler and job.config.backbone else {}
    with annotate(resources=takes) if takes else nullcontext():
        return pool.submit(kept, {"name": plain(job.name), "order": Held(order)})


def _runner(batch: Batch, width: int) -> DaskTaskRunner:
    from prefect_dask.task_runners import DaskTaskRunner

    if batch.has_scheduler:
        return DaskTaskRunner(address=batch.workers)
    local = {
        "n_workers": width, "threads_per_worker": 1, "processes": True, "memory_limit": 0, "dashboard_address": None,
        "silence_logs": logging.CRITICAL, "scheduler_kwargs": {"allowed_failures": 1},
    }  # fmt: skip
    return DaskTaskRunner(cluster_kwargs=local)


def _look(batch: Batch, pool: DaskTaskRunner) -> None:
    """Raise MissingTool if the scheduler does not answer; warn of cases that no worker takes."""
    try:
        workers = pool.client.scheduler_info(n_workers=-1)["workers"].values()
    except OSError as fault:
        raise MissingTool(f"--workers {batch.workers}: no Dask scheduler answers ({fault}): dask scheduler") from fault
    told = logging.getLogger(__name__)
    if not workers:
        told.warning("%s has no worker: cases wait until one joins (dask worker %s)", batch.workers, batch.workers)
    elif any(config.backbone for config in batch.configs) and not any(GPU in w["resources"] for w in workers):
        told.warning("no worker of %s has the resource %s: cases with a model wait for one", batch.workers, GPU)


def _outcome(future: Any) -> Any:
    """The final state of a task. Raises BrokenExecutor if its workers died, MissingTool if the scheduler is lost."""
    from distributed import CancelledError, KilledWorker

    try:
        return future.wrapped_future.result()
    except KilledWorker as fault:
        raise BrokenExecutor from fault
    except CancelledError as fault:
        raise MissingTool(
            "the connection to Dask's scheduler was lost; finished cases are kept, run the same command again to go on"
        ) from fault


def _cancel(future: Any) -> None:
    """Tell the scheduler that a result is not wanted any more, if it can still be told."""
    task = future.wrapped_future
    if task.client.status == "running":
        task.cancel()
