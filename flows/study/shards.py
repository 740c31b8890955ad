"""A study cut into shards: laid out on shared storage, each run by the host that takes it.

All arms of a case stay in one shard, so that the stages they share are computed once. A shard knows its jobs by their
digests: a host whose package, prompts or plugins differ refuses instead of mixing results. `flows/deploy/shards.py`
makes flow runs of shards.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flows.batch.plan_batch import MAX_JOBS, Batch, Job, JobRunner, cores
from flows.case.run_case import Ending
from flows.case_files import find_cases
from flows.case_files.case_folder import CaseFolder
from flows.case_files.find_cases import Case
from flows.case_files.stage_cache import Sharing, keys_of
from flows.study.shard_lease import BEAT_S, Lease, LeaseLost
from flows.study.shared_storage import SharedFolder, mark_name
from sgcad_core.config import Config, build
from sgcad_core.errors import ConfigError

PLAN = "plan.json"
JOBS_A_SHARD = 100
"""A flow run costs a process and Prefect's import, about 8 s: at 0.5 s a case that is 16 % of a shard of 100."""
SHELF = ".stages"
"""Folder of shared stages, local to a host, since all arms of a case are in one shard."""
MIN_SHARDS = 8
"""Minimum number of shards: four for each of two hosts, so that neither waits long at the end."""


@dataclass(frozen=True)
class ShardJob:
    """One job in a shard's list."""

    arm: str
    case: str
    digest: str

    @property
    def mark(self) -> str:
        """The mark of its success."""
        return mark_name(self.arm, self.case, self.digest)

    @property
    def failure(self) -> str:
        """The mark of its failure."""
        return mark_name(self.arm, self.case, self.digest, failed=True)


def shard_job(job: Job) -> ShardJob:
    """A job's name and digest."""
    return ShardJob(job.config.name, job.case.id, job.digest)


def cut(jobs: Sequence[Job], shards: int | None = None) -> list[list[ShardJob]]:
    """Shards in the order of the jobs, all arms of a case in one of them, sizes as even as that allows."""
    by_case: dict[str, list[ShardJob]] = {}
    for job in jobs:
        by_case.setdefault(job.case.id, []).append(shard_job(job))
    wanted = shards or max(MIN_SHARDS, -(-len(jobs) // JOBS_A_SHARD))
    count = max(1, min(wanted, len(by_case)))
    found: list[list[ShardJob]] = [[] for _ in range(count)]
    for number, group in enumerate(by_case.values()):
        found[number * count // len(by_case)] += group
    return found


def lay_out(
    share: SharedFolder, study: str, jobs: Sequence[Job], shards: int | None = None, laying: str = ""
) -> list[list[ShardJob]]:
    """Write plan and reports to the share and cut the jobs into shards. Refuses a share that holds another study.

    `laying` names this plan: runs of an earlier plan stop when they read it. In a repeated layout (resumed, or with
    other arms) finished jobs keep their marks; failed ones are tried again.
    """
    there = share.json(PLAN)
    if there is not None and there["study"] != study:
        raise ConfigError(
            f"{share.address} holds the study {there['study']!r}, not {study!r}: give each study its own folder"
        )
    for name in share.names("failed/"):
        share.remove(name)
    made = cut(jobs, shards)
    _give_reports(share, jobs)
    arms = {job.config.name: job.config.raw for job in jobs}
    plan = {"study": study, "laying": laying, "arms": arms, "shards": [[vars(w) for w in shard] for shard in made]}
    share.write_json(PLAN, plan)
    return made


def _give_reports(share: SharedFolder, jobs: Sequence[Job]) -> None:
    there = share.names("cases/")
    for case in {job.case.id: job.case for job in jobs}.values():
        files = [f for f in case.source.rglob("*") if f.is_file()] if case.source.is_dir() else [case.source]
        for file in files:
            inside = file.relative_to(case.source) if case.source.is_dir() else Path()
            name = f"cases/{case.id}/{inside.as_posix()}" if case.source.is_dir() else f"cases/{case.id}"
            content = file.read_bytes()
            if name not in there or share.read(name) != content:
                share.write(name, content)


# ------------------------------------------------------------------ on a worker's host
@dataclass(frozen=True)
class ShardCounts:
    """Counts of a shard's jobs: done, found done, done but too late (another result is valid), failed."""

    done: int = 0
    found: int = 0
    doubled: int = 0
    failed: int = 0


@dataclass(frozen=True)
class Shard:
    """One shard on its host; `scratch` is a folder on the host's disk."""

    share: SharedFolder
    number: int
    run: str
    scratch: Path
    laying: str = ""

    def check(self) -> None:
        """Raises LeaseLost if the study was laid out again since this run was submitted."""
        plan = self.share.json(PLAN) or {}
        if self.laying and plan.get("laying") != self.laying:
            raise LeaseLost("the study was started again with other shards; this run's shard no longer exists")

    def jobs(self) -> tuple[list[Job], int]:
        """The jobs that are left, checked against the plan, and the number found done."""
        plan = self.share.json(PLAN)
        if plan is None or self.number >= len(plan["shards"]):
            raise ConfigError(f"{self.share.address}: no shard {self.number} in {PLAN}; was the study laid out here?")
        wanted = [ShardJob(**work) for work in plan["shards"][self.number]]
        ended = self.share.names("done/") | self.share.names("failed/")
        left = [work for work in wanted if not ({work.mark, work.failure} & ended)]
        configs = {arm: _config(plan["arms"][arm], arm) for arm in dict.fromkeys(work.arm for work in left)}
        sources = {case: self._report(case) for case in dict.fromkeys(work.case for work in left)}
        return [self._job(work, configs[work.arm], sources[work.case]) for work in left], len(wanted) - len(left)

    def _report(self, case: str) -> Case:
        """A report, copied to this host."""
        prefix = f"cases/{case}"
        place = self.scratch / prefix
        for name in self.share.names(prefix):
            if name == prefix or name.startswith(f"{prefix}/"):
                file = self.scratch / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(self.share.read(name) or b"")
        if not place.exists():
            raise ConfigError(f"{self.share.address}/{prefix}: the report is not there; start the study again")
        return Case(place, case)

    def _job(self, work: ShardJob, config: Config, case: Case) -> Job:
        source = find_cases.source_digest(case.source)
        digest = find_cases.job_digest(source, find_cases.config_digest(config))
        if digest != work.digest:
            raise ConfigError(
                f"{work.arm}/{work.case}: this host would compute another result than the study asks for (digest "
                f"{digest[:12]}, not {work.digest[:12]}): install the same version of the package, its plugins and "
                "the files that the configuration names"
            )
        folder = CaseFolder(self.scratch, work.arm, work.case)
        return Job(config, case, digest, folder, Sharing(self.scratch / SHELF, keys_of(config), source))

    def hand_in(self, lease: Lease, job: Job, ending: Ending) -> str:
        """Upload a finished case and mark it; which field of the tally it counts for. Raises LeaseLost."""
        lease.check()
        status = ending.result["status"]
        stood = self.share.leave(job.folder.path, (job.config.name, job.case.id, job.digest), status, self.run)
        return ("failed" if status == "failed" else "done") if stood else "doubled"


def _config(raw: dict[str, Any], arm: str) -> Config:
    """An arm's configuration on a worker's host, without its tracker: results are tracked where they are collected."""
    return build({**raw, "tracker": "none"}, arm, f"arm {arm}")


Run = Callable[[Sequence[Job], JobRunner, Callable[[Job, Ending, str], None]], object]
"""Function that runs a shard's jobs: `flows.batch.batch_flow.submit_and_follow` inside a flow run."""


def run_shard(shard: Shard, run: Run, jobs: int | None = None, beat_s: float | None = None) -> ShardCounts:
    """Run the jobs left in a shard and hand in each case as it ends. Raises ConfigError, LeaseLost, Unreachable."""
    lease = Lease(shard.share, shard.number, shard.run, beat_s or BEAT_S)
    counts = dict.fromkeys(("done", "found", "doubled", "failed"), 0)
    shard.check()
    with lease.held():
        plan, counts["found"] = shard.jobs()
        runner = JobRunner(_batch(plan, shard.scratch, jobs))

        def hand_in(job: Job, ending: Ending, untracked: str) -> None:
            counts[shard.hand_in(lease, job, ending)] += 1

        try:
            runner.begin(plan)
            run(plan, runner, hand_in)
        except BaseException:
            runner.stop()
            raise
        runner.close()
    return ShardCounts(**counts)


def _batch(plan: Sequence[Job], scratch: Path, jobs: int | None) -> Batch:
    """The jobs left in a shard as a batch: with a model `jobs` cases at a time, without one in processes."""
    configs = tuple({job.config.name: job.config for job in plan}.values())
    asks = any(config.backbone for config in configs)
    return Batch(
        configs, tuple(job.case for job in plan), scratch, jobs or (MAX_JOBS if asks else cores()), jobs or cores()
    )
