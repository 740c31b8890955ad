"""What the shared parts take of a case: Prefect's server, MLflow's server, the storage.

    python -m research.benchmarks.services.load [--cases 200] [--database postgresql://user@host/] [--address s3://bucket/place]

Starts real servers on sqlite, or on two databases (`prefect`, `mlflow`) of a PostgreSQL server, and gives them what a
study gives them a case: a task run, one more a step and an artifact, an MLflow run, one object. Prefect's server is
measured as a command and as `make up` start it, and by default.
Prints processor seconds of server and client, wall seconds, and the server's delay."""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event, Thread
from typing import Any, NamedTuple

import httpx
import psutil

from flows.server import BULK, LEAN
from research.benchmarks.services.free_port import free_port

DEMO = Path(__file__).resolve().parents[3] / "docs" / "demo"
START_S = 300.0
MODULE = "research.benchmarks.services.load"
SERVERS: Mapping[str, Mapping[str, str]] = {"of a command": LEAN, "of make up": BULK, "plain": {}}
STEPS = (
    "read", "retrieve[road]", "road[1]", "retrieve[scenario]", "scenario[1]", "simulate", "measure", "track",
)  # fmt: skip


class Load(NamedTuple):
    """Of one case at one part: seconds of the server's and the client's processors, and of the clock."""

    part: str
    server: float
    client: float
    wall: float
    note: str = ""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--database", default="", help="postgresql://user@host/, with databases prefect and mlflow")
    parser.add_argument("--address", default="", help="fsspec address of the storage; default: a folder")
    parser.add_argument("--inside", choices=["prefect", "mlflow"], help=argparse.SUPPRESS)
    options, rest = parser.parse_known_args(arguments)
    if options.inside:
        {"prefect": give_prefect, "mlflow": give_mlflow}[options.inside](options.cases, *rest)
        return
    with tempfile.TemporaryDirectory() as place:
        case = real_case(Path(place))
        say(f"{options.cases} cases, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}\n")
        say("| part | server ms a case | client ms a case | wall ms a case | |\n|---|---|---|---|---|")
        for kind in SERVERS:
            show(prefect_load(options.cases, options.database, Path(place), case, kind))
        show(mlflow_load(options.cases, options.database, Path(place), case))
        show(storage_load(options.cases, options.address or f"file://{place}/share", case))


def show(one: Load) -> None:
    """One part as a row of a Markdown table."""
    ms = " | ".join(f"{1000 * seconds:.0f}" for seconds in (one.server, one.client, one.wall))
    say(f"| {one.part} | {ms} | {one.note} |")


def say(line: str) -> None:
    """A line on stdout, at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def real_case(place: Path) -> Path:
    """The folder of a bundled report, run once."""
    from flows.case import run_case
    from flows.case_files import find_cases
    from sgcad_core import settings
    from sgcad_core.config import load

    settings.quiet_libraries()
    config = load("template.yaml", ("tracker=none",))
    (case, *_) = find_cases.cases_in([DEMO])
    run_case.run_case(config, case, place / "runs", find_cases.digest_of(case, config))
    return place / "runs" / config.name / case.id


# ------------------------------------------------------------------ servers
@contextmanager
def served(command: list[str], health: str, environment: dict[str, str], log: Path) -> Iterator[psutil.Process]:
    """A server process while the block lasts. Raises TimeoutError with the log's end if it never answers."""
    with log.open("wb") as words:
        process = subprocess.Popen(command, stdout=words, stderr=subprocess.STDOUT, env={**os.environ, **environment})  # noqa: S603 - ours
    try:
        deadline = time.monotonic() + START_S
        while not answers(health):
            if process.poll() is not None or time.monotonic() > deadline:
                raise TimeoutError(f"{' '.join(command[2:4])} does not start: {log.read_text()[-1500:]}")
            time.sleep(0.2)
        yield psutil.Process(process.pid)
    finally:
        for child in psutil.Process(process.pid).children(recursive=True):
            child.terminate()
        process.terminate()
        process.wait()


def answers(address: str) -> bool:
    """Whether an address answers well."""
    try:
        return httpx.get(address, timeout=5).is_success
    except httpx.HTTPError:
        return False


class Memory(Thread):
    """Resident memory of a process and all that it started, MB, once a second until `stop`."""

    def __init__(self, process: psutil.Process) -> None:
        super().__init__(daemon=True)
        self.process, self.seen, self._ended = process, [self._now(process)], Event()

    def run(self) -> None:
        """Look once a second."""
        while not self._ended.wait(1.0):
            self.seen.append(self._now(self.process))

    def stop(self) -> str:
        """What it was after a tenth of the time, half of it, and at the end."""
        self._ended.set()
        self.join()
        at = [self.seen[int(share * (len(self.seen) - 1))] for share in (0.1, 0.5, 1.0)]
        return "server memory after a tenth, a half, all: " + ", ".join(f"{mb:.0f}" for mb in at) + " MB"

    @staticmethod
    def _now(process: psutil.Process) -> float:
        total = 0
        for one in (process, *process.children(recursive=True)):
            with suppress(psutil.NoSuchProcess):
                total += one.memory_info().rss
        return total / 2**20


def spent(process: psutil.Process) -> float:
    """Processor seconds of a process and all that it started."""
    family = [process, *process.children(recursive=True)]
    return sum(sum(one.cpu_times()[:2]) for one in family)


def prefect_load(cases: int, database: str, place: Path, case: Path, kind: str) -> Load:
    """A case with its steps and artifact, on Prefect's server as one of SERVERS."""
    port = free_port()
    address = f"http://127.0.0.1:{port}/api"
    environment = {"PREFECT_HOME": str(place / kind), "PREFECT_API_URL": address, "PREFECT_LOGGING_LEVEL": "ERROR",
                   "PREFECT_SERVER_ANALYTICS_ENABLED": "false", "DO_NOT_TRACK": "1", **SERVERS[kind]}  # fmt: skip
    if database:
        url = f"{database.replace('postgresql:', 'postgresql+asyncpg:')}prefect"
        environment["PREFECT_SERVER_DATABASE_CONNECTION_URL"] = url
    command = [sys.executable, "-m", "prefect", "server", "start", "--port", str(port), "--no-ui"]
    with served(command, f"{address}/health", environment, place / "prefect.log") as server:
        return per_case(f"Prefect server, {kind}", server, "prefect", cases, environment, [str(case)])


def mlflow_load(cases: int, database: str, place: Path, case: Path) -> Load:
    """A run a case with figures, attempts and files, on MLflow's server."""
    port = free_port()
    store = f"{database}mlflow" if database else f"sqlite:///{place / 'mlflow.db'}"
    environment = {"MLFLOW_DISABLE_TELEMETRY": "true", "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"}
    command = [sys.executable, "-m", "mlflow", "server", "--port", str(port), "--workers", "1",
               "--backend-store-uri", store, "--artifacts-destination", str(place / "artifacts")]  # fmt: skip
    with served(command, f"http://127.0.0.1:{port}/health", environment, place / "mlflow.log") as server:
        return per_case("MLflow server", server, "mlflow", cases, environment, [str(case), f"http://127.0.0.1:{port}"])


def per_case(
    part: str, server: psutil.Process, inside: str, cases: int, environment: dict[str, str], words: list[str]
) -> Load:
    """What a further case costs: a client with many cases against one with a few, so that starts cancel out."""
    few = max(2, cases // 10)
    results = []
    for count in (few, cases):
        client = [sys.executable, "-m", MODULE, "--inside", inside, "--cases", str(count), *words]
        results.append(run_client(server, client, environment))
    (s0, c0, w0, _), (s1, c1, w1, note) = results
    more = cases - few
    return Load(part, (s1 - s0) / more, (c1 - c0) / more, (w1 - w0) / more, note)


def run_client(
    server: psutil.Process, client: list[str], environment: dict[str, str]
) -> tuple[float, float, float, str]:
    """(server, client, wall) seconds of one client, and what it says at its end."""
    before, started, memory = spent(server), time.perf_counter(), Memory(server)
    memory.start()
    done = subprocess.run(client, capture_output=True, text=True, env={**os.environ, **environment}, check=False)  # noqa: S603 - our own module
    if done.returncode:
        raise RuntimeError(done.stderr[-2000:])
    used, _, note = done.stdout.strip().splitlines()[-1].partition(" ")
    took, memory_told = time.perf_counter() - started, memory.stop()
    return spent(server) - before, float(used), took, f"{note}; {memory_told}"


# ------------------------------------------------------------------ clients, in processes of their own
def tell(note: str = "") -> None:
    """Processor seconds of this process, for the one that started it; then leave."""
    times = psutil.Process().cpu_times()
    sys.stdout.write(f"{times.user + times.system} {note}\n")
    sys.stdout.flush()
    os._exit(0)


def give_prefect(cases: int, case_folder: str) -> None:
    """A flow run with a task run, one a step and an artifact a case; ends when the server has all task runs."""
    from prefect import flow, task
    from prefect.cache_policies import NO_CACHE
    from prefect.client.orchestration import get_client
    from prefect.events.worker import EventsWorker
    from prefect.runtime import flow_run, task_run
    from prefect.task_runners import ThreadPoolTaskRunner

    from flows.batch.case_task import silence_prefect
    from flows.batch.prefect_case_end import TaskIds, case_reporter

    silence_prefect()
    result = json.loads((Path(case_folder) / "result.json").read_text(encoding="utf-8"))
    plain: dict[str, Any] = {"persist_result": False, "cache_policy": NO_CACHE}

    @task(task_run_name="{name}", **plain)
    def step(name: str) -> str:
        return name

    @task(**plain)
    def case(number: int) -> TaskIds:
        for name in STEPS:
            step(name)
        return TaskIds(str(flow_run.id), str(task_run.id))

    @flow(name="load", task_runner=ThreadPoolTaskRunner(max_workers=2), persist_result=False)
    def load() -> str:
        with case_reporter(lasting=True) as shown:
            for future in [case.submit(number) for number in range(cases)]:
                shown.artifact(Path(case_folder), "load/case", result, future.result())
        return str(flow_run.id)

    identity = load()
    EventsWorker.drain_all(timeout=60)
    sent = time.perf_counter()
    body = {"flow_runs": {"id": {"any_": [identity]}}, "task_runs": {"state": {"type": {"any_": ["COMPLETED"]}}}}
    with get_client(sync_client=True) as client:
        while client.request("POST", "/task_runs/count", json=body).json() < (1 + len(STEPS)) * cases:
            if time.perf_counter() - sent > START_S:
                raise TimeoutError("the server never had all task runs")
            time.sleep(0.1)
    tell(f"the server had everything {time.perf_counter() - sent:.1f} s after the last case of {cases}")


def give_mlflow(cases: int, case: str, uri: str) -> None:
    """A run a case through our own tracker."""
    from sgcad_core.registry import plugin_class

    tracker: Any = plugin_class("tracker", "mlflow")(uri=uri, system_metrics_s=0)
    result = json.loads((Path(case) / "result.json").read_text())
    for number in range(cases):
        copy = Path(case).parent / f"{cases}-{number:05d}"  # a case of its own: the tracker keeps one run of each
        shutil.copytree(case, copy)
        tracker.log_case("load", {"config": "load"}, copy, result)
        shutil.rmtree(copy)
    sizes = [f.stat().st_size for f in Path(case).rglob("*") if f.is_file()]
    tell(f"{len(sizes)} files, {sum(sizes) / 1e6:.1f} MB a case")


def storage_load(cases: int, address: str, case: Path) -> Load:
    """Pack and upload a case; in this process, so the storage's own work shows only in the wall time."""
    import fsspec

    from flows.batch.remote.sent_case import packed

    place, root = fsspec.core.url_to_fs(address)
    place.makedirs(root, exist_ok=True)
    cpu, started = time.process_time(), time.perf_counter()
    for number in range(cases):
        place.pipe_file(f"{root}/{number:05d}", packed(case))
    used, wall = time.process_time() - cpu, time.perf_counter() - started
    return Load(
        "storage", 0.0, used / cases, wall / cases, f"{len(packed(case)) / 1e6:.2f} MB packed, {address.split(':')[0]}"
    )


if __name__ == "__main__":
    main()
