"""Worker processes of Prefect's pool."""

from __future__ import annotations

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import pytest

from sgcad_core import settings

settings.quiet_libraries()

from prefect.engine import handle_engine_signals  # noqa: E402

from flows.batch.task_runners import prepare_worker  # noqa: E402


def _begin_without_server() -> None:
    """What Prefect's engine does in a worker where a task begins and no server answers."""
    with handle_engine_signals():
        raise RuntimeError("Failed to reach API")


def test_a_task_that_cannot_begin_leaves_the_pool_alive() -> None:
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context, initializer=prepare_worker) as pool:
        for _ in range(2):  # the second one would never end in a pool whose managing thread is gone
            future = pool.submit(_begin_without_server)
            future.add_done_callback(lambda done: done.result())  # as Prefect's own future does
            with pytest.raises(RuntimeError, match="its server may be gone"):
                future.result(timeout=120)
