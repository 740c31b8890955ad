"""The end of a case: tracked, its links kept, its Prefect artifact (result, account, picture, links) made.

Called from the flow's own thread. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import base64
import io
import logging
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from prefect import task
from prefect.cache_policies import NO_CACHE
from prefect.client.orchestration import get_client
from prefect.client.schemas.objects import State
from prefect.context import FlowRunContext
from prefect.settings import PREFECT_API_URL, PREFECT_UI_URL
from prefect.states import Completed, Failed
from prefect.utilities.engine import link_state_to_task_run_result

from flows.batch.case_task import made_of
from flows.batch.plan_batch import Job
from flows.batch.remote import sent_case
from flows.batch.tracking import track_cases
from flows.case import case_in_words
from flows.case.run_case import Ending
from flows.case.steps import Held
from flows.case_files import case_links
from flows.case_files.case_links import Served
from sgcad_core.case.verdict_told import verdict_sentence
from sgcad_core.result import counts_of

ARTIFACTS_S = 20.0
"""Time limit of a request to the server, s."""


@dataclass(frozen=True)
class TaskIds:
    """Ids of a case's flow run and task run."""

    flow_run: str
    task_run: str


@task(task_run_name="track {name}", cache_policy=NO_CACHE, persist_result=False, cache_result_in_memory=False)
def track(name: str, ended: Any) -> State[Any]:
    """Log a finished case to its tracker."""
    untracked = track_cases.track_safely(*ended.value)
    return Failed(name="Untracked", message=untracked) if untracked else Completed()


@dataclass
class CaseReporter:
    """Tracks and shows the cases of one batch as they end. `lasting`: the server outlives the batch."""

    lasting: bool
    _client: Any
    _served: dict[Path, Served] = field(default_factory=dict)
    _silent: bool = False

    def former(self, job: Job, ending: Ending) -> str:
        """Track a case that has no task of its own: one that an interrupted batch did not log, or whose process died.

        Why it could not be tracked, or "". Raises ConfigError (`track_safely`).
        """
        untracked = track_cases.track_safely(job, ending)
        track_cases.link_to_page(job)
        return untracked

    def case(self, job: Job, state: State[Any], stages: bool) -> tuple[Ending, str]:
        """Track a case and show its result, given its task's state; its ending, and why it could not be tracked, or "".

        `stages`: tracking is a task too. Raises the task's own fault.
        """
        made, details = made_of(state), state.state_details
        ending = sent_case.receive(job, made) if isinstance(made, bytes) else made
        ids = TaskIds(str(details.flow_run_id), str(details.task_run_id))
        self._link(job, ids)
        untracked = _tracked_as_task(job, ending, state) if stages else track_cases.track_safely(job, ending)
        track_cases.link_to_page(job)
        self.artifact(job.folder.path, job.name, ending.result, ids)
        return ending, untracked

    def _link(self, job: Job, ids: TaskIds) -> None:
        """Keep the links of the case in Prefect, which its tracker shows too."""
        base = _pages() if self.lasting else ""
        found = {"prefect": f"{base}/runs/flow-run/{ids.flow_run}"}
        case_links.keep(job.folder.path, found | {"prefect_case": f"{base}/runs/task-run/{ids.task_run}"})

    def artifact(self, folder: Path, name: str, result: Mapping[str, Any], ids: TaskIds) -> None:
        """Send a case's artifact to Prefect; `name` is the job's."""
        if self._silent:
            return
        out = folder.parent.parent
        if out not in self._served:
            self._served[out] = case_links.served(out)
        body = {
            "key": artifact_key(name), "type": "markdown",
            "description": f"{name}: {result['status']}",
            "data": markdown(folder, result, self._served[out]),
            "flow_run_id": ids.flow_run, "task_run_id": ids.task_run,
        }  # fmt: skip
        try:
            self._client.request("POST", "/artifacts/", json=body, timeout=ARTIFACTS_S)
        except Exception as fault:  # noqa: BLE001 - a server that takes none costs the artifacts, not the batch
            self._silent = True
            told = logging.getLogger(__name__)
            told.warning("Prefect accepts no artifacts (%s); cases are still run and written", fault)


def _tracked_as_task(job: Job, ending: Ending, case: State[Any]) -> str:
    """Why a case could not be tracked, or ""; a fault of the task is raised."""
    ended = Held((job, ending))
    link_state_to_task_run_result(case, ended)  # not `wait_for`, which lets no refused case be tracked
    state = track(job.name, ended, return_state=True)
    _forget(ended)
    if state.name == "Untracked":
        return str(state.message)
    if state.is_failed() or state.is_crashed():
        state.result()
    return ""


def _forget(ended: Held[Any]) -> None:
    """Drop what Prefect keeps for a whole flow run, in case another task takes it: the links to `ended` and to results
    that are gone, and empty sets of assets."""
    if not (around := FlowRunContext.get()):
        return
    for identity, (_, _, result) in list(around.run_results.items()):
        if result and ((one := result()) is None or one is ended):
            around.run_results.pop(identity, None)
    for run, assets in list(around.task_run_assets.items()):
        if not assets:
            around.task_run_assets.pop(run, None)


@contextmanager
def case_reporter(lasting: bool) -> Iterator[CaseReporter]:
    """The object that shows the cases of a batch while the block lasts."""
    with get_client(sync_client=True) as client:
        yield CaseReporter(lasting, client)


def _pages() -> str:
    """Address of Prefect's pages."""
    return str(PREFECT_UI_URL.value() or (PREFECT_API_URL.value() or "").removesuffix("/api")).rstrip("/")


# ------------------------------------------------------------------ the artifact
WIDE_PX, COLORS = 420, 32
"""Size of the picture: 10 to 20 kB, since the server keeps it in its database."""
MOST_LACKING = 5


def artifact_key(name: str) -> str:
    """A case's name as a key of artifacts: small letters, digits and dashes."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")[:200] or "case"


def markdown(folder: Path, result: Mapping[str, Any], served: Served) -> str:
    """The artifact of the case in a folder."""
    parts = [
        f"# {_plain(folder.name)}: {_plain(_verdict(result))}",
        _picture(folder),
        *_told(result),
        _page_links(folder, served),
    ]
    return "\n\n".join(filter(None, parts)) + "\n"


def _verdict(result: Mapping[str, Any]) -> str:
    account = counts_of(result)
    if account and (said := verdict_sentence(result)):
        return f"{result['status']}: {said}"
    lacking = case_in_words.lacking_counted(account)
    return f"{result['status']}, {lacking}" if lacking else str(result["status"])


def _told(result: Mapping[str, Any]) -> list[str]:
    """The contact or the reason for no scenario, and the account as a table."""
    if result["status"] != "generated":
        return [_plain(str(result["reason"] or result["status"])[:500])]
    near = result.get("near_crash")
    found = [_plain(case_in_words.approach(near) if near else _contact(result))]
    if account := counts_of(result):
        row = " | ".join(str(account[name]) for name in ("told", "has", "lacking", "assumed"))
        found.append(f"| told | in the scenario | lacking | assumed |\n|---|---|---|---|\n| {row} |")
        if account["lacking"]:
            found.append(f"Lacking: {_plain(case_in_words.lacking_in_words(account, MOST_LACKING))}.")
    return found


def _contact(result: Mapping[str, Any]) -> str:
    collision = result["collision"]
    return case_in_words.contact(result) if collision["declared"] or collision["observed"] else "no contact is told"


def _picture(folder: Path) -> str:
    """The case's picture, made smaller; "" if it is missing or cannot be read."""
    from sgcad_core.system.pictures import opened

    try:
        with opened(folder / "picture.png") as found:
            small = found.convert("RGB")
    except OSError:
        return ""
    small.thumbnail((WIDE_PX, WIDE_PX))
    out = io.BytesIO()
    small.quantize(COLORS).save(out, "PNG", optimize=True)
    return f"![The crash from above](data:image/png;base64,{base64.b64encode(out.getvalue()).decode('ascii')})"


def _page_links(folder: Path, served: Served) -> str:
    """Links to pages that are served now, and the folder."""
    kept = case_links.kept(folder)
    mlflow = case_links.resolved(kept["mlflow"], served.mlflow) if "mlflow" in kept else ""
    found = [("Desk", served.case_page(folder)), ("MLflow run", mlflow)]
    if mlflow and (folder / "player.html").is_file():
        found.append(("Report page (player.html among the run's files)", f"{mlflow}/artifacts"))
    lines = [f"- [{name}]({address})" for name, address in found if address]
    page = folder / ("player.html" if (folder / "player.html").is_file() else "result.json")
    return "\n".join([*lines, f"- `{page}`"])


def _plain(text: str) -> str:
    """Text with markdown's special characters escaped."""
    return re.sub(r"([\\`*_\[\]<>|#!])", r"\\\1", " ".join(text.split()))
