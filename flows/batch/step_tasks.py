"""The steps of a case as Prefect tasks.

    calls = step_tasks(shelf=Path("runs/studies/alpha/.stages"))       # a StepCalls: flows/case/chain.py composes them

Retries are for what may succeed when it is repeated (a process died, a server did not answer); what a model answered
wrongly is asked again by the refinement, an attempt a task. Results are kept where several configs share them: by
Prefect's result storage, under the keys of flows/case_files/step_keys.py. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, cast

from prefect import Task, task
from prefect.cache_policies import NO_CACHE
from prefect.client.schemas.objects import State
from prefect.runtime import task_run
from prefect.states import Cancelled, Completed

from flows.batch.kept_results import KeptRecords, StepLocks, StepPolicy, fits
from flows.batch.remote import store
from flows.case import steps
from flows.case.step_log import verdict
from flows.case.steps import RETRY_DELAYS_S, Held, StepCalls, may_be_retried
from sgcad_core.asking.refine import Turn

GPU, SIMULATOR = "gpu", "simulator"
"""Tags that limit how many tasks run at once: `prefect concurrency-limit create gpu 1`."""
STEP_LIMIT_S = 300.0
"""Time limit of an attempt without a model, and of a simulation, where a process has one case at a time."""


def _repeatable(_task: Any, _run: Any, state: State[Any]) -> bool:
    """Whether a failed task is to be retried."""
    return isinstance(state.data, BaseException) and may_be_retried(state.data)


_RETRIES: dict[str, Any] = {
    "retries": len(RETRY_DELAYS_S),
    "retry_delay_seconds": list(RETRY_DELAYS_S),
    "retry_jitter_factor": 0.5,
    "retry_condition_fn": _repeatable,
}
_PLAIN: dict[str, Any] = {"cache_policy": NO_CACHE, "persist_result": False, "cache_result_in_memory": False}


def _task(step: Callable[..., Held[Any]], name: str, **options: Any) -> Task[..., Any]:
    """A step as a task of its name."""
    return task(step, **{"name": name, "task_run_name": name, **_PLAIN, **options})


def _stage_name() -> str:
    return f"retrieve[{task_run.parameters['stage']}]"


def _attempt_name() -> str:
    return f"{task_run.task_name}[{len(task_run.parameters['turns']) + 1}]"


def _judged(turn: Held[Turn]) -> State[Any]:
    """An attempt as a state with its verdict: accepted, doubted, to be repaired, refused."""
    name, message = verdict(turn.value.attempt)
    state: Callable[..., State[Any]] = Cancelled if name == "Refused" else Completed
    return state(name=name, message=message, data=turn)


read = _task(steps.read, "read")
opinion = _task(steps.opinion, "opinion", **_RETRIES)
retrieve = _task(steps.retrieve, "retrieve", task_run_name=_stage_name)


@task(name="road", task_run_name=_attempt_name, **_RETRIES, **_PLAIN)
def road(setup: Any, report: Any, passages: Any, turns: Any) -> State[Any]:
    """One attempt at the road network."""
    return _judged(steps.road(setup, report, passages, turns))


@task(name="scenario", task_run_name=_attempt_name, **_RETRIES, **_PLAIN)
def scenario(setup: Any, report: Any, passages: Any, turns: Any, network: Any) -> State[Any]:
    """One attempt at the scenario."""
    return _judged(steps.scenario(setup, report, passages, turns, network))


simulate = _task(steps.simulate, "simulate", **_RETRIES)
measure = _task(steps.measure, "measure")
judge = _task(steps.judge, "judge", **_RETRIES)


@cache
def step_tasks(
    shelf: Path | str | None = None, asks_model: bool = False, limited: bool = False, tagged: bool = False
) -> StepCalls:
    """The steps as tasks.

    `shelf`, a folder or an address, keeps their results; None: they are not kept. `limited`: with time limits, which
    can be kept where a task has its process's main thread. `tagged`: with the tags "simulator" and, of a config that
    asks a model, "gpu"; a tagged task asks the server for its turn, so that is for a server that stays.
    """
    kept = _kept(shelf) if shelf else {}
    within: dict[str, Any] = {"timeout_seconds": STEP_LIMIT_S} if limited else {}
    asking = _tags(GPU, tagged) if asks_model else within
    playing = within | _tags(SIMULATOR, tagged)
    return StepCalls(
        read=_called(read, **kept),
        opinion=_called(opinion, **asking, **kept),
        retrieve=_called(retrieve),
        road=_called(road, **asking, **kept),
        scenario=_called(scenario, **asking, **kept),
        simulate=_called(simulate, **playing, **kept),
        measure=_called(measure),
        judge=_called(judge, **playing),
    )


def _tags(name: str, tagged: bool) -> dict[str, Any]:
    return {"tags": [name]} if tagged else {}


def _kept(shelf: Path | str) -> dict[str, Any]:
    """Options of a task whose result is kept; in a folder it is made once by all that want it."""
    place, policy = store.storage(str(shelf)), StepPolicy()
    if isinstance(place, Path):
        policy = StepPolicy(lock_manager=StepLocks(place), isolation_level="SERIALIZABLE")
    storage = {"result_storage": place, "result_serializer": KeptRecords()}
    return {"cache_policy": policy, "persist_result": True, **storage}


def _called(step: Any, **options: Any) -> Callable[..., Held[Any]]:
    """A task as a function: its value, or its fault raised."""
    asked = step.with_options(**options) if options else step

    def call(*given: Any) -> Held[Any]:
        state = asked(*given, return_state=True)
        made = state.result(raise_on_failure=False)
        if state.name == "Cached" and not fits(step.name, made):  # what was kept is damaged, or of another step
            state = asked.with_options(refresh_cache=True)(*given, return_state=True)
            made = state.result(raise_on_failure=False)
        if isinstance(made, BaseException):
            raise made
        return cast("Held[Any]", made)

    return call
