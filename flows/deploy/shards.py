"""Shards of a study as flow runs of one deployment, taken by the workers of a pool on any number of hosts.

`shard_flow` is the deployment's flow (deploy/prefect.yaml); `on_hosts` lays a study out, submits its shards and
collects the results in the folder that a single machine would fill. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import hashlib
import tempfile
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import httpx
from prefect import flow
from prefect.client.orchestration import SyncPrefectClient, get_client
from prefect.client.schemas.filters import FlowRunFilter, FlowRunFilterId
from prefect.client.schemas.objects import FlowRun, State
from prefect.deployments import run_deployment
from prefect.exceptions import ObjectNotFound
from prefect.runtime import flow_run
from prefect.states import Completed, Crashed

from flows.batch import track_cases
from flows.batch.batch_flow import submit_and_follow
from flows.batch.plan_batch import Job
from flows.batch.prefect_case_task import threads
from flows.batch.track_cases import OnEnding
from flows.case.run_case import Ending
from flows.study.plan import Plan
from flows.study.shard_lease import BEAT_S
from flows.study.shards import Shard, lay_out, run_shard, shard_job
from flows.study.shared_storage import Mark, SharedFolder, Unreachable
from flows.study.watch_shards import DEPLOYMENT, Hosts, ShardWatch, watch_until_done
from flows.study.watch_shards import State as Standing
from sgcad_core.errors import ConfigError

THREADS = 64
"""Threads of a shard's flow run, the limit of `jobs`."""
POLL_S = 2.0
PAGE = 200
"""The server's limit of flow runs an answer."""

_T = TypeVar("_T")


@flow(
    name="shard",
    flow_run_name="{study} {shard}",
    task_runner=threads(THREADS),
    persist_result=False,
)
def shard_flow(
    address: str,
    study: str,
    shard: int,
    laying: str = "",
    jobs: int | None = None,
    scratch: str = "",
    beat_s: float = BEAT_S,
) -> State[Any]:
    """Run one shard of a study laid out at `address` (`laying` names the plan).

    `jobs` cases at a time share one model and its batch. `scratch` is a folder on this host; results in it of an
    interrupted run are handed in, not repeated.
    """
    place = Path(scratch or tempfile.gettempdir()) / "sgcad-shards" / hashlib.sha256(address.encode()).hexdigest()[:12]
    place.mkdir(parents=True, exist_ok=True)
    tally = run_shard(
        Shard(SharedFolder(address), shard, str(flow_run.id), place, laying), submit_and_follow, jobs, beat_s
    )
    return Completed(message=", ".join(f"{count} {name}" for name, count in vars(tally).items()))


@dataclass(frozen=True)
class PrefectPool:
    """Flow runs of the shard deployment; `parameters` go to each, `deployment` names it as "flow/deployment"."""

    study: str
    parameters: dict[str, Any]
    deployment: str = DEPLOYMENT

    def submit(self, shard: int) -> str:
        """Ask for a run of a shard; its id. Raises ConfigError if there is no such deployment."""
        parameters = {**self.parameters, "study": self.study, "shard": shard}
        try:
            made: Any = _ask(
                lambda: run_deployment(
                    self.deployment, parameters=parameters, timeout=0, as_subflow=False, tags=[f"study:{self.study}"]
                )
            )
        except ObjectNotFound as fault:
            raise ConfigError(
                f"Prefect has no deployment {self.deployment!r}: start one with `make up`, or `prefect --no-prompt "
                "deploy --prefect-file deploy/prefect.yaml --all`"
            ) from fault
        return str(made.id)

    def states(self, runs: Sequence[str]) -> dict[str, tuple[Standing, str]]:
        """State and message of each run; a run that the server does not know (any more) has ended."""
        found: dict[str, tuple[Standing, str]] = dict.fromkeys(runs, ("ended", "the server has no such run"))
        for start in range(0, len(runs), PAGE):
            wanted = FlowRunFilter(id=FlowRunFilterId(any_=list(runs[start : start + PAGE])))
            read = _answer(partial(_read_runs, wanted))
            found |= {str(run.id): (_standing(run.state), _words(run.state)) for run in read}
        return found

    def give_up(self, run: str, reason: str) -> None:
        """Mark a run as crashed with a reason, which frees its place in the pool."""
        _answer(lambda client: client.set_flow_run_state(run, Crashed(message=reason), force=True))


def _read_runs(wanted: FlowRunFilter, client: SyncPrefectClient) -> list[FlowRun]:
    return client.read_flow_runs(flow_run_filter=wanted, limit=PAGE)


def _answer(request: Callable[[SyncPrefectClient], _T]) -> _T:
    """What a client answers."""

    def ask() -> _T:
        with get_client(sync_client=True) as client:
            return request(client)

    return _ask(ask)


def _ask(request: Callable[[], _T]) -> _T:
    """A request's answer. Raises Unreachable for a server that is gone or too slow, in any form that Prefect raises."""
    try:
        return request()
    except (httpx.HTTPError, RuntimeError) as fault:
        if isinstance(fault, RuntimeError) and not str(fault).startswith("Failed to reach API"):
            raise
        raise Unreachable(f"Prefect's server does not answer ({type(fault).__name__}: {fault})") from fault


def _standing(state: Any) -> Standing:
    if state is None or state.is_scheduled():
        return "waiting"
    return "ended" if state.is_final() else "taken"


def _words(state: Any) -> str:
    return f"{state.name}: {state.message or ''}" if state else ""


def study_on_hosts(made: Plan, hosts: Hosts, on_ending: OnEnding) -> list[str]:
    """`flows.study.run_study.run` on many hosts: the same folder, the same study.json. See `on_hosts`."""
    made.write()
    return on_hosts(made.study.name, made.jobs, hosts, on_ending)


def on_hosts(study: str, jobs: Sequence[Job], hosts: Hosts, on_ending: OnEnding) -> list[str]:
    """Run a study's jobs on the hosts that serve the deployment; every result is collected and tracked here.

    Returns the shards submitted again, with reasons. Raises ConfigError, Unreachable (storage or server gone for ten
    minutes); the same command again resumes the study.
    """
    with track_cases.tracked_batch(jobs):
        left = list(_not_here(jobs, on_ending))
        return _away(study, left, hosts, on_ending) if left else []


def _away(study: str, left: Sequence[Job], hosts: Hosts, on_ending: OnEnding) -> list[str]:
    share = SharedFolder(hosts.address)
    laying = str(uuid.uuid4())
    shards = lay_out(share, study, left, hosts.shards, laying)
    parameters = {"address": hosts.address, "laying": laying, "beat_s": hosts.beat_s}
    parameters |= {"jobs": hosts.jobs} if hosts.jobs else {}
    pool = PrefectPool(study, parameters, hosts.deployment)
    watch = ShardWatch(share, pool, shards, _homecoming(share, left, on_ending), hosts.patience_s, hosts.start_s)
    watch_until_done(watch, time.monotonic, lambda: time.sleep(POLL_S))
    return watch.again


def _not_here(jobs: Sequence[Job], on_ending: OnEnding) -> Iterator[Job]:
    """Jobs without a result here; the others are tracked and reported."""
    for job in jobs:
        result = job.folder.finished(job.digest)
        if result is None:
            yield job
        else:
            ending = Ending(result, reused=True)
            on_ending(job, ending, track_cases.track_safely(job, ending))


def _homecoming(share: SharedFolder, jobs: Sequence[Job], on_ending: OnEnding) -> Callable[[Mark], None]:
    """A function that copies a marked result into its folder, tracks it and reports it."""
    by_work = {(work.arm, work.case, work.digest): job for job in jobs for work in (shard_job(job),)}

    def home(mark: Mark) -> None:
        job = by_work[mark.arm, mark.case, mark.digest]
        with job.folder.writing() as partial:
            share.fetch(mark, partial)
        result = job.folder.finished("" if mark.status == "failed" else job.digest)
        if result is None:
            raise ConfigError(f"{job.folder.path}: the result from {mark.host} is incomplete; start the study again")
        ending = Ending(result)
        on_ending(job, ending, track_cases.track_safely(job, ending))

    return home
