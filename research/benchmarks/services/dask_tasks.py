"""What a task costs that goes through Prefect and Dask: processor time of starter, scheduler, worker and server.

    python -m research.benchmarks.services.dask_tasks [--tasks 1000]

A Dask scheduler, a worker with one thread and a Prefect server of their own; the tasks do nothing.
"""

from __future__ import annotations

import argparse
import logging
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial

import psutil

from flows.server import prefect_server
from research.benchmarks.services.free_port import free_port
from sgcad_core import settings

FIRST = 10
"""Tasks before the clock starts: they import and connect."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", type=int, default=1000)
    tasks = parser.parse_args(arguments).tasks
    settings.quiet_libraries()
    with ExitStack() as stack:
        server = stack.enter_context(prefect_server())
        address = f"tcp://127.0.0.1:{free_port()}"
        scheduler = stack.enter_context(_started("scheduler", "--host", address))
        worker = stack.enter_context(_started("worker", address, "--nthreads", "1", "--no-nanny"))
        parts = {"starter": psutil.Process(), "scheduler": scheduler, "worker": worker}
        if server:
            server.wait()
            parts["Prefect's server"] = psutil.Process(server.process.pid)
        _measure(address, tasks, parts)


def _measure(address: str, tasks: int, parts: Mapping[str, psutil.Process]) -> None:
    from prefect.settings import PREFECT_API_URL, PREFECT_FLOWS_HEARTBEAT_FREQUENCY, temporary_settings

    from research.benchmarks.services import empty_flow

    named = {PREFECT_API_URL: settings.prefect_url(), PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None}
    with temporary_settings(named):
        empty_flow.run(partial(_submit, address, tasks, parts))


def _submit(address: str, tasks: int, parts: Mapping[str, psutil.Process]) -> None:
    from prefect_dask.task_runners import DaskTaskRunner

    from research.benchmarks.services.empty_flow import nothing

    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with DaskTaskRunner(address=address) as pool:
        for future in [pool.submit(nothing, {"number": n}) for n in range(FIRST)]:
            future.wait()
        before, started = {name: _spent(part) for name, part in parts.items()}, time.perf_counter()
        for future in [pool.submit(nothing, {"number": n}) for n in range(tasks)]:
            future.wait()
        wall = time.perf_counter() - started
    _say("| part | ms of processor time a task |\n|---|---|")
    for name, part in parts.items():
        _say(f"| {name} | {1000 * (_spent(part) - before[name]) / tasks:.1f} |")
    _say(f"\n{tasks} tasks, one thread of one worker: {1000 * wall / tasks:.1f} ms each by the clock")


@contextmanager
def _started(program: str, *words: str) -> Iterator[psutil.Process]:
    """A program of Dask while the block lasts."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{program}", *words, "--no-dashboard"]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)  # noqa: S603 - our own interpreter and module
    try:
        yield psutil.Process(process.pid)
    finally:
        process.terminate()
        process.wait()


def _spent(process: psutil.Process) -> float:
    return float(sum(process.cpu_times()[:2]))


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
