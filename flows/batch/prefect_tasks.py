"""A Prefect task run per step of a case, with true times, states and predecessors.

Steps run elsewhere (a worker process, the case's thread), so nothing is run here: their states are sent as the events
that Prefect's own client sends, 1.5 ms of processor time each including the server. A Prefect task would cost as much
again and would know only the time of the report.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any
from uuid import UUID, uuid5

from prefect.events import emit_event

from flows.case.step_log import Kind, Step

TYPES: Mapping[Kind, str] = {"completed": "COMPLETED", "cancelled": "CANCELLED", "failed": "FAILED"}


@dataclass(frozen=True)
class StepRuns:
    """Shows a case's steps as task runs inside the case's task run."""

    flow_run: str
    task_run: str
    every: bool = True
    """False: attempts only, for a server that writes states one by one."""

    def tell(self, step: Step) -> None:
        """Show that a step begins or has ended (an `OnStep`).

        An event sent twice, such as the beginning of a continued step, has one id: a server rejects two states of a
        task run at one time, together with all others of the same batch.
        """
        if not self.shows(step):
            return
        state = "Running" if step.ended is None else step.state
        kind = "RUNNING" if step.ended is None else TYPES[step.kind]
        about: dict[str, Any] = {
            "type": kind,
            "name": state,
            "message": step.message,
            "state_details": {},
            "data": None,
        }
        now = _when(step.began if step.ended is None else step.ended)
        emit_event(
            event=f"prefect.task-run.{state}",
            id=uuid5(UUID(self.id_of(step.name)), f"{kind} {now.isoformat()}"),
            occurred=now,
            resource=self._resource(step, about, now),
            related=[{"prefect.resource.id": f"prefect.flow-run.{self.flow_run}", "prefect.resource.role": "flow-run"}],
            payload={
                "intended": {"from": None, "to": kind}, "initial_state": None, "validated_state": about,
                "task_run": self._task_run(step),
            },
        )  # fmt: skip

    def _resource(self, step: Step, about: Mapping[str, Any], now: datetime) -> dict[str, str]:
        return {
            "prefect.resource.id": f"prefect.task-run.{self.id_of(step.name)}",
            "prefect.resource.name": step.name,
            "prefect.run-count": "1",
            "prefect.state-message": step.message,
            "prefect.state-name": about["name"],
            "prefect.state-type": about["type"],
            "prefect.state-timestamp": now.isoformat(),
            "prefect.orchestration": "client",
        }

    def _task_run(self, step: Step) -> dict[str, Any]:
        """The task run's current row: upserted by id."""
        began = _when(step.began).isoformat()
        inside: dict[str, Any] = {"__parents__": [_input(self.task_run)]}
        found = {
            "name": step.name, "task_key": step.name.partition("[")[0], "run_count": 1,
            "dynamic_key": f"{self.task_run}-{step.name}", "expected_start_time": began, "start_time": began,
            "task_inputs": inside | {"after": [_input(self.id_of(name)) for name in step.after]},
        }  # fmt: skip
        if step.ended is not None:
            found |= {"end_time": _when(step.ended).isoformat(), "total_run_time": step.ended - step.began}
        return found

    def shows(self, step: Step) -> bool:
        """Whether the step is shown."""
        return self.every or step.name.partition("[")[0] in ("road", "scenario")

    def id_of(self, name: str) -> str:
        """The id of a step's task run."""
        return str(uuid5(UUID(self.task_run), name))


def _when(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, UTC)


def _input(task_run: str) -> dict[str, str]:
    return {"input_type": "task_run", "id": task_run}
