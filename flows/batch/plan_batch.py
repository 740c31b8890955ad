"""A batch: configs times cases, checked and planned before anything starts.

Independent of Prefect. How jobs run is said by flows/batch/lanes.py.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import cast, get_args

from flows.batch import config_folder
from flows.batch.case_order import Detail, Order
from flows.case.run_case import Ending, write_failed
from flows.case_files import case_folder, find_cases, folder_cases, step_keys
from flows.case_files.case_folder import CaseFolder
from flows.case_files.find_cases import Case
from flows.case_files.step_keys import StepKeys
from flows.study_file.arm_config import load_config
from sgcad_core import settings
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.system import temp_folders

WORKERS = ("auto", "threads", "processes", "dask")
"""Names of places where cases run (flows/batch/task_runners.py)."""
SCHEDULERS = ("tcp://", "tls://")
STORE = ".store"
"""Folder of results of a Dask cluster on this machine, in the output folder."""
MAX_JOBS = 8
"""Cases at a time without --jobs: at most the cores without a model; with one, several share its batch."""


@dataclass(frozen=True)
class Job:
    """One case of one config."""

    config: Config
    case: Case
    digest: str
    folder: CaseFolder
    keys: StepKeys | None = None
    """Keys under which its steps are shared with other configs; None: they are not."""

    @property
    def name(self) -> str:
        """Name in task runs and the log: <config>/<case>."""
        return f"{self.config.name}/{self.case.id}"


@dataclass(frozen=True)
class Batch:
    """Configs, cases and the output folder of a batch.

    `jobs` cases run at a time, those without a model in `processes`. `fresh` repeats finished cases. `flow` and
    `title` name the flow and its run. `shelf` is the folder of steps shared by configs; None: steps are not shared.
    `detail` is what Prefect is shown, `workers` where cases run (flows/batch/task_runners.py).
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
    detail: Detail = "stage"
    workers: str = "auto"
    lasting: bool = False
    """Whether the server outlives the batch."""
    store: str = ""
    """Address of the results of cases that run in a Dask cluster."""
    left: tuple[str, ...] = ()
    """Entries of the folders of cases that are no case."""

    @property
    def is_remote(self) -> bool:
        """Whether cases run in a Dask cluster."""
        return self.workers == "dask" or self.has_scheduler

    @property
    def has_scheduler(self) -> bool:
        """Whether `workers` is the address of a Dask scheduler."""
        return self.workers.startswith(SCHEDULERS)

    def shown(self, detail: str, workers: str, store: str = "") -> Batch:
        """The batch with what Prefect is shown of it and where it runs. Raises ConfigError, MissingTool."""
        if detail not in get_args(Detail):
            raise ConfigError(f"--detail {detail}: give {' or '.join(get_args(Detail))}")
        if workers not in WORKERS and not workers.startswith(SCHEDULERS):
            raise ConfigError(
                f"--workers {workers}: give {', '.join(WORKERS)}, or the address of a Dask scheduler (tcp://host:8786)"
            )
        asked = replace(self, detail=cast("Detail", detail), workers=workers, store=store)
        asked._check_remote()
        return asked if store or not asked.is_remote else replace(asked, store=str(self.out / STORE))

    def _check_remote(self) -> None:
        if self.store and not self.is_remote:
            raise ConfigError(f"--store {self.store}: give --workers too: dask, or a scheduler's address")
        if self.is_remote and find_spec("prefect_dask") is None:
            raise MissingTool(f"--workers {self.workers}: pip install 'sg-cadvlm[dask]' (prefect-dask)")
        if self.has_scheduler and not self.store:
            raise ConfigError(f"--workers {self.workers}: give --store, an address that every machine reaches")
        if self.has_scheduler and not settings.prefect_url():
            raise MissingTool(
                f"--workers {self.workers}: a Prefect server is needed that every machine reaches: "
                "export PREFECT_API_URL=http://.../api"
            )
        if self.fresh and self.store:
            raise ConfigError("--fresh with --store: the store holds finished cases; give it another address")

    def plan(self) -> tuple[Job, ...]:
        """All jobs, config by config. Each report and each config is fingerprinted once."""
        sources = {case: find_cases.source_digest(case.source) for case in self.cases}
        return tuple(job for config in self.configs for job in self._jobs(config, sources))

    def _jobs(self, config: Config, sources: Mapping[Case, str]) -> Iterator[Job]:
        digest = find_cases.config_digest(config)
        keys = step_keys.keys_of(config) if self.shelf else None
        for case, source in sources.items():
            shared = StepKeys(keys, case.id, source) if keys else None
            folder = CaseFolder(self.out, config.name, case.id)
            yield Job(config, case, find_cases.job_digest(source, digest), folder, shared)

    def reusable(self, job: Job) -> Ending | None:
        """The ending of a finished job, else None."""
        result = None if self.fresh else job.folder.finished(job.digest)
        return Ending(result, reused=True) if result is not None else None

    def opened(self, plan: Sequence[Job]) -> tuple[list[tuple[Job, Ending]], list[Job]]:
        """Write the configs of a plan; its finished jobs with their endings, and those that are left."""
        for config in {job.config.name: job.config for job in plan}.values():
            config_folder.write(self.out / config.name, config)
        self.keep_left_out(plan)
        found = [(job, self.reusable(job)) for job in plan]
        return [(job, ending) for job, ending in found if ending], [job for job, ending in found if not ending]

    def keep_left_out(self, plan: Sequence[Job]) -> None:
        """Note in the folders of the results which entries of the folders of cases are no case."""
        for name in {job.config.name for job in plan}:
            folder_cases.write_left_out(self.out / name, self.left)

    def failed(self, job: Job, reason: str) -> Ending:
        """Write the folder of a job whose process died."""
        return write_failed(job.config, job.case, self.out, job.digest, reason)

    def order(self, job: Job) -> Order:
        """The job as values that a worker takes."""
        about = job.config.raw, job.config.name, job.case, self.out, job.digest, job.keys
        shelf = self.store if self.store and self.shelf else self.shelf
        return Order(*about, shelf, self.detail, job.config.backbone is not None, self.lasting)


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
