"""A batch: configs times cases, planned before anything starts, and the processes that run it.

Independent of Prefect, whose flow only waits for the jobs, so that cases run while its server is still starting. A
config without a model runs in worker processes (numpy and XML hold the interpreter's lock); a config with a model runs
in threads of this process, where its weights are loaded once.
"""

from __future__ import annotations

import os
import queue
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from flows.batch import config_folder
from flows.batch.worker import Order
from flows.case import run_case
from flows.case.run_case import Ending
from flows.case.step_log import OnStep, ignore_step
from flows.case_files import case_folder, find_cases, stage_cache
from flows.case_files.case_folder import CaseFolder
from flows.case_files.find_cases import Case
from flows.case_files.stage_cache import Sharing
from flows.study_file.arm_config import load_config
from sgcad_core.asking.refine import OnAttempt
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, ProcessDied, SimulationFailed
from sgcad_core.interfaces import Backbone
from sgcad_core.system import temp_folders
from sgcad_core.system.worker_process import Worker

CASE_LIMIT_S = 600.0
"""Time limit of a case without a model; then its process is ended and the case fails."""
MAX_JOBS = 8
"""Cases at a time without --jobs: at most the cores without a model; with one, several share its batch."""


@dataclass(frozen=True)
class Job:
    """One case of one config."""

    config: Config
    case: Case
    digest: str
    folder: CaseFolder
    sharing: Sharing | None = None
    """Access to stages shared with other configs; None: stages are not shared."""

    @property
    def name(self) -> str:
        """Name in task runs and the log: <config>/<case>."""
        return f"{self.config.name}/{self.case.id}"


@dataclass(frozen=True)
class Batch:
    """Configs, cases and the output folder of a batch.

    `jobs` cases run at a time, those without a model in `processes`. `fresh` repeats finished cases. `flow` and
    `title` name the flow and its run. `shelf` is the folder of stages shared by configs; None: stages are not shared.
    """

    configs: tuple[Config, ...]
    cases: tuple[Case, ...]
    out: Path
    jobs: int
    processes: int
    fresh: bool = False
    flow: str = "evaluate"
    title: str = ""
    shelf: Path | None = None

    def plan(self) -> tuple[Job, ...]:
        """All jobs, config by config. Each report and each config is fingerprinted once."""
        sources = {case: find_cases.source_digest(case.source) for case in self.cases}
        return tuple(job for config in self.configs for job in self._jobs(config, sources))

    def _jobs(self, config: Config, sources: Mapping[Case, str]) -> Iterator[Job]:
        digest = find_cases.config_digest(config)
        keys = stage_cache.keys_of(config) if self.shelf else None
        for case, source in sources.items():
            shared = Sharing(self.shelf, keys, source) if self.shelf and keys else None
            folder = CaseFolder(self.out, config.name, case.id)
            yield Job(config, case, find_cases.job_digest(source, digest), folder, shared)


def batch_of(
    found: Sequence[Case],
    configs: Sequence[Path],
    out: Path,
    overrides: Sequence[str] = (),
    jobs: int | None = None,
    fresh: bool = False,
) -> Batch:
    """Check a whole batch. Raises ConfigError with every fault; only `out` is created."""
    return batch_over(found, _load_all(configs, tuple(overrides)), out, jobs, fresh)


def batch_over(
    found: Sequence[Case], configs: tuple[Config, ...], out: Path, jobs: int | None = None, fresh: bool = False
) -> Batch:
    """`batch_of` with loaded configs. Raises MissingTool too, if a simulator's program is not installed."""
    if jobs is not None and jobs < 1:
        raise ConfigError(f"--jobs {jobs}: at least 1 is needed")
    for config in configs:
        for simulator in (config.simulator, config.judge):
            if simulator:
                simulator.ready()
    out = out.resolve()
    temp_folders.remove_leftover_folders()
    case_folder.check_writable(out)
    for config in configs:
        config.tracker.ready(out)
    for config in configs:
        case_folder.check_writable(out / config.name)
        case_folder.clear_partial(out / config.name)
    asks = any(config.backbone for config in configs)
    return Batch(configs, tuple(found), out, jobs or (MAX_JOBS if asks else cores()), jobs or cores(), fresh)


def _load_all(paths: Sequence[Path], overrides: tuple[str, ...]) -> tuple[Config, ...]:
    faults: list[str] = []
    loaded: list[Config] = []
    for path in paths:
        try:
            loaded.append(config_folder.named(load_config(path, overrides), overrides))
        except ConfigError as fault:
            faults.append(str(fault))
    twice = [name for name, n in Counter(c.name for c in loaded).items() if n > 1]
    faults += [f"two configs are called {name!r} and would share a folder: rename one file" for name in twice]
    if faults:
        raise ConfigError("\n".join(faults))
    return tuple(loaded)


def cores() -> int:
    """Cores this process may use, at most 8."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, min(MAX_JOBS, usable))


# ------------------------------------------------------------------ doing it
OnTurn = Callable[[Job, str], None]
"""Called from any thread when an attempt of a job with a model begins; its name is such as "road[2]"."""


@dataclass
class JobRunner:
    """Runs jobs: those without a model at once in the background, those with a model when they are waited for."""

    batch: Batch
    on_turn: OnTurn | None = None
    done: frozenset[str] = frozenset()
    """Jobs finished by an earlier runner of this command: not repeated by `fresh`."""
    stopping: threading.Event = field(default_factory=threading.Event)
    _begun: dict[str, Future[Ending]] = field(default_factory=dict)
    """Jobs in worker processes whose ending was not asked for yet; an ending is handed out once."""
    _workers: list[Worker] = field(default_factory=list)
    _idle: queue.SimpleQueue[Worker] = field(default_factory=queue.SimpleQueue)
    _threads: ThreadPoolExecutor | None = None

    def __post_init__(self) -> None:
        self._places = threading.Semaphore(self.batch.jobs)  # a deployed flow has more threads

    def begin(self, plan: Sequence[Job]) -> None:
        """Start jobs without a model, and load the first model needed while the server starts."""
        for config in {job.config.name: job.config for job in plan}.values():
            config_folder.write(self.batch.out / config.name, config)
        asking = (job for job in plan if job.config.backbone and self.reusable(job) is None)
        if model := next((job.config.backbone for job in asking), None):
            threading.Thread(target=_load, args=(model,), daemon=True, name="load").start()
        waiting = [job for job in plan if job.config.backbone is None and self.reusable(job) is None]
        if not waiting:
            return
        count = min(self.batch.processes, len(waiting))
        self._workers = [Worker("flows.batch.worker:run_in_worker") for _ in range(count)]
        for worker in self._workers:
            self._idle.put(worker)
        self._threads = ThreadPoolExecutor(count, thread_name_prefix="case")
        for job in waiting:
            self._begun[job.name] = self._threads.submit(self._in_worker, job)

    def reusable(self, job: Job) -> Ending | None:
        """The ending of a finished job, else None."""
        anew = self.batch.fresh and job.name not in self.done
        result = None if anew else job.folder.finished(job.digest)
        return Ending(result, reused=True) if result is not None else None

    def finish(self, job: Job, on_attempt: OnAttempt, tell: OnStep = ignore_step) -> Ending:
        """Wait for a job, or run it now, reporting every step. Raises MissingTool, ConfigError."""
        if job.name in self._begun:
            return self._begun.pop(job.name).result()
        if done := self.reusable(job):
            return done
        watched = self._unless_stopped(job, on_attempt)
        with self._places:
            self._check()
            about = job.config, job.case, self.batch.out, job.digest, watched
            return run_case.run_case(*about, sharing=job.sharing, tell=tell)

    def began(self, job: Job) -> bool:
        """Whether the job runs in a worker process, which returns its steps with its ending."""
        return job.name in self._begun

    def _in_worker(self, job: Job) -> Ending:
        self._check()
        worker = self._idle.get()
        try:
            order = Order(job.config.raw, job.config.name, job.case, self.batch.out, job.digest, job.sharing)
            ending = self._answered(worker, order)
        except SimulationFailed as death:
            self._check()
            ending = run_case.write_failed(job.config, job.case, self.batch.out, job.digest, str(death))
        finally:
            self._idle.put(worker)
        return ending

    def _answered(self, worker: Worker, order: Order) -> Ending:
        """A worker's ending of a case; a dead worker is replaced once, since the report may not be the cause."""
        try:
            ending: Ending = worker.call(order, timeout_s=CASE_LIMIT_S)
        except ProcessDied:
            self._check()
            ending = worker.call(order, timeout_s=CASE_LIMIT_S)
        return ending

    def _unless_stopped(self, job: Job, on_attempt: OnAttempt) -> OnAttempt:
        def checked(name: str, turn: Callable[[], object]) -> object:
            self._check()
            if self.on_turn:
                self.on_turn(job, name)
            return on_attempt(name, turn)  # type: ignore[arg-type]

        return checked  # type: ignore[return-value]

    def _check(self) -> None:
        if self.stopping.is_set():
            raise Interrupted

    def stop(self) -> None:
        """Start no more jobs and end the worker processes; a case's folder appears whole or not at all."""
        self.stopping.set()
        if self._threads:
            self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in self._workers:
            worker.kill()

    def close(self) -> None:
        """End the worker processes of a finished batch."""
        if self._threads:
            self._threads.shutdown(wait=True)
        for worker in self._workers:
            worker.close()


def _load(model: Backbone) -> None:
    with suppress(Exception):  # the first question reports the fault with its case
        model.load()


class Interrupted(BaseException):
    """The batch is being stopped: this case gets no result."""
