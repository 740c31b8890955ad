"""What is done about a case as it ends, beside tracking it: its links are kept, and Prefect gets its artifact.

Called from the flow's own thread. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from prefect.client.orchestration import get_client
from prefect.settings import PREFECT_API_URL, PREFECT_UI_URL

from flows.batch import prefect_artifact, track_cases
from flows.batch.plan_batch import Job
from flows.batch.prefect_tasks import Graph
from flows.case import case_links
from flows.case.case_links import Served
from flows.case.chain import Ending
from flows.case.step_log import Step, waits_for
from sgcad_core import settings

BULK_STATES = 10
"""States of task runs that a server writes at once, from which on it writes in bulk."""
ARTIFACTS_S = 20.0
"""How long a server may take for an artifact; the case is done either way."""


@dataclass
class Showing:
    """Shows the cases of one batch as they end. `lasting`: the server outlives the batch, so its address is kept."""

    lasting: bool
    _client: Any
    _served: dict[Path, Served] = field(default_factory=dict)
    _silent: bool = False

    def case(self, job: Job, ending: Ending, graph: Graph | None) -> str:
        """Track a case and show what came of it; why it could not be tracked. Raises ConfigError (`track_safely`)."""
        if graph is None or ending.reused:
            untracked = track_cases.track_safely(job, ending)
            self._link_to_tracker(job)  # a case whose batch ended before it was logged is logged now
            return untracked
        self._link(job, graph)
        began = time.time()
        untracked = track_cases.track_safely(job, ending)
        after = waits_for("track", [step.name for step in ending.steps])
        tracked = Step("track", began, time.time(), after=after)
        graph.tell(replace(tracked, state="Untracked", kind="failed", message=untracked) if untracked else tracked)
        self._link_to_tracker(job)
        self.artifact(job.folder.path, job.name, ending.result, graph)
        return untracked

    def _link(self, job: Job, graph: Graph) -> None:
        """Keep where the case is to be seen in Prefect, for its tracker too."""
        base = _pages() if self.lasting else ""
        found = {"prefect": f"{base}/runs/flow-run/{graph.flow_run}"}
        case_links.keep(job.folder.path, found | {"prefect_case": f"{base}/runs/task-run/{graph.task_run}"})

    @staticmethod
    def _link_to_tracker(job: Job) -> None:
        """Keep where the tracker shows the case, if it was logged by this process."""
        if page := job.config.tracker.page(job.config.name, job.case.id):
            case_links.keep(job.folder.path, {"mlflow": page})

    def artifact(self, folder: Path, name: str, result: Mapping[str, Any], graph: Graph) -> None:
        """Hand Prefect a case's artifact; `name` is the job's."""
        if self._silent:
            return
        out = folder.parent.parent
        if out not in self._served:
            self._served[out] = case_links.served(out)
        body = {
            "key": prefect_artifact.key_of(name), "type": "markdown",
            "description": f"{name}: {result['status']}",
            "data": prefect_artifact.markdown(folder, result, self._served[out]),
            "flow_run_id": graph.flow_run, "task_run_id": graph.task_run,
        }  # fmt: skip
        try:
            self._client.request("POST", "/artifacts/", json=body, timeout=ARTIFACTS_S)
        except Exception as fault:  # noqa: BLE001 - a server that takes none costs the artifacts, not the batch
            self._silent = True
            told = logging.getLogger(__name__)
            told.warning("Prefect takes no artifacts (%s); the cases are done all the same", fault)


def shows_every_step() -> bool:
    """Whether Prefect is shown every step of a case: as SGCAD_PREFECT_STEPS says ("all", "attempts"), else where the
    server writes states in bulk. One that writes each by itself takes 8 ms more a step, 150 ms a case with all of them.
    """
    if asked := settings.environment("SGCAD_PREFECT_STEPS"):
        return asked == "all"
    try:
        with get_client(sync_client=True) as client:
            told = client.request("GET", "/admin/settings", timeout=ARTIFACTS_S).json()
        return int(told["server"]["services"]["task_run_recorder"]["batch_size"]) >= BULK_STATES
    except Exception as fault:  # noqa: BLE001 - a server that does not tell, such as a hosted one
        logging.getLogger(__name__).debug("the server does not tell its settings: %s", fault)
        return False


@contextmanager
def showing(lasting: bool) -> Iterator[Showing]:
    """What shows the cases of a batch while the block lasts."""
    with get_client(sync_client=True) as client:
        yield Showing(lasting, client)


def _pages() -> str:
    """Where Prefect's pages are served."""
    return str(PREFECT_UI_URL.value() or (PREFECT_API_URL.value() or "").removesuffix("/api")).rstrip("/")
