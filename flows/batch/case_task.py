"""A case as a Prefect task, in which its steps are tasks; its state tells how the case ended.

Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import logging
import time
from typing import Any
from uuid import UUID

from prefect import task
from prefect.cache_policies import NO_CACHE
from prefect.client.orchestration import get_client
from prefect.client.schemas.filters import FlowRunFilter, TaskRunFilter
from prefect.client.schemas.objects import State, StateType
from prefect.events.worker import EventsWorker
from prefect.runtime import flow_run
from prefect.states import Cancelled, Completed, Crashed, Failed
from prefect.transactions import CommitMode, transaction

from flows.batch.case_order import Order, is_worker, run_order
from flows.batch.step_tasks import step_tasks
from flows.case.run_case import Ending
from flows.case.steps import AT_ONCE, Held
from sgcad_core.case.verdict_told import verdict_sentence
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.result import counts_of

DECLINED = ("exhausted", "failed")


@task(name="case", task_run_name="{name}", cache_policy=NO_CACHE, persist_result=False, cache_result_in_memory=False)
def case(name: str, order: Any) -> State[Any]:
    """One report under one config: read, retrieve, road, scenario, simulate, measure, judge."""
    return run_in_task(order)


def run_in_task(order: Held[Order]) -> State[Any]:
    """The body of `case`, in a module that workers import."""
    try:
        ending = run_steps(order.value, limited=is_worker())
    except (ConfigError, MissingTool) as fault:  # ends the batch; raised here, Prefect would print its traceback
        return Failed(message=str(fault), data=fault)
    return state_of(ending)


def run_steps(order: Order, limited: bool, alone: bool | None = None) -> Ending:
    """Run an order inside its task. `limited`: attempts have time limits; `alone`: see `run_order`."""
    if order.detail == "case":
        return run_order(order, AT_ONCE, alone)
    calls = step_tasks(order.shelf, order.asks_model, limited, order.tagged)
    with transaction(commit_mode=CommitMode.EAGER):  # a step's result is kept when it is made, not when the case ends
        return run_order(order, calls, alone)


def state_of(ending: Ending, data: Held[Any] | None = None) -> State[Any]:
    """The state of a case's task, named as the case ended, with what the task gives back: the ending, unless given."""
    data = data or Held(ending)
    status, reason = ending.result["status"], ending.result["reason"]
    if status in DECLINED:
        return Failed(name=status.capitalize(), message=reason, data=data)
    if status == "refused":  # a result, not a success: Prefect shows it gray
        return Cancelled(name="Refused", message=reason, data=data)
    account = counts_of(ending.result)
    if account and account["verdict"] != "whole":
        name = "Lacking" if account["verdict"] == "lacking" else "Doubted"
        counted = f"{account['lacking']} of {account['told']} things told are lacking"
        return Completed(name=name, message=verdict_sentence(ending.result) or counted, data=data)
    return Completed(name=status.capitalize(), message=reason, data=data)


def made_of(state: State[Any]) -> Any:
    """What the task of a case gave back: an ending, or a packed folder. Raises the task's own fault."""
    made = state.result(raise_on_failure=False)
    if isinstance(made, Held) and isinstance(made.value, Ending | bytes):
        return made.value
    raise made if isinstance(made, BaseException) else RuntimeError(f"{state.name}: {state.message}")


RECORDED_S = 3.0
"""The server writes states of task runs within this time."""
_crashed: set[UUID] = set()
"""Task runs whose process died, since they were last told."""


def note_crash(future: Any) -> None:
    """Note a task whose process died."""
    _crashed.add(future.task_run_id)


def any_crashed() -> bool:
    """Whether a task's process has died in this batch."""
    return bool(_crashed)


def tell_crashes() -> None:
    """Tell Prefect of tasks whose process died and of the steps in them, at the end of a batch: they cannot tell so
    themselves. A task that never began has no task run."""
    lost = {_crashed.pop() for _ in range(len(_crashed))}
    if not lost:
        return
    EventsWorker.instance().wait_until_empty()
    time.sleep(RECORDED_S)
    running = TaskRunFilter(state={"type": {"any_": [StateType.PENDING, StateType.RUNNING]}})
    mine = FlowRunFilter(id={"any_": [UUID(str(flow_run.id))]})
    with get_client(sync_client=True) as client:
        for run in client.read_task_runs(flow_run_filter=mine, task_run_filter=running):
            around = {getattr(given, "id", None) for given in run.task_inputs.get("__parents__", ())}
            if run.id in lost or around & lost:
                client.set_task_run_state(run.id, Crashed(message="its process died"), force=True)


def plain(name: str) -> str:
    """A name without braces, which Prefect would take for a format string."""
    return name.replace("{", "(").replace("}", ")")


def silence_prefect() -> None:
    """Silence Prefect's own log lines, which break the progress bar; the command reports every ending."""
    for name in ("prefect", "prefect.task_runs", "prefect.flow_runs", "EventsWorker", "APILogWorker"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
