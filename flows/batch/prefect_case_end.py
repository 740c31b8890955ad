"""The end of a case: tracked, its links kept, its Prefect artifact (result, account, picture, links) made.

Called from the flow's own thread. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import base64
import io
import logging
import re
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from prefect.client.orchestration import get_client
from prefect.settings import PREFECT_API_URL, PREFECT_UI_URL

from flows.batch import track_cases
from flows.batch.plan_batch import Job
from flows.batch.prefect_tasks import StepRuns
from flows.case import case_in_words
from flows.case.run_case import Ending
from flows.case.step_log import Step, waits_for
from flows.case_files import case_links
from flows.case_files.case_links import Served
from sgcad_core import settings
from sgcad_core.result import counts_of

BULK_STATES = 10
"""Batch size from which a server counts as writing states of task runs in bulk."""
ARTIFACTS_S = 20.0
"""Time limit of a request to the server, s."""


@dataclass
class CaseReporter:
    """Tracks and shows the cases of one batch as they end. `lasting`: the server outlives the batch."""

    lasting: bool
    _client: Any
    _served: dict[Path, Served] = field(default_factory=dict)
    _silent: bool = False

    def case(self, job: Job, ending: Ending, step_runs: StepRuns | None) -> str:
        """Track a case and show its result; why it could not be tracked, or "". Raises ConfigError (`track_safely`)."""
        if step_runs is None or ending.reused:
            untracked = track_cases.track_safely(job, ending)
            self._link_to_tracker(job)  # a case of an interrupted batch is logged now
            return untracked
        self._link(job, step_runs)
        began = time.time()
        untracked = track_cases.track_safely(job, ending)
        after = waits_for("track", [step.name for step in ending.steps])
        tracked = Step("track", began, time.time(), after=after)
        step_runs.tell(replace(tracked, state="Untracked", kind="failed", message=untracked) if untracked else tracked)
        self._link_to_tracker(job)
        self.artifact(job.folder.path, job.name, ending.result, step_runs)
        return untracked

    def _link(self, job: Job, step_runs: StepRuns) -> None:
        """Keep the links of the case in Prefect, which its tracker shows too."""
        base = _pages() if self.lasting else ""
        found = {"prefect": f"{base}/runs/flow-run/{step_runs.flow_run}"}
        case_links.keep(job.folder.path, found | {"prefect_case": f"{base}/runs/task-run/{step_runs.task_run}"})

    @staticmethod
    def _link_to_tracker(job: Job) -> None:
        """Keep the link to the tracker's page of the case, if this process logged it."""
        if page := job.config.tracker.page(job.config.name, job.case.id):
            case_links.keep(job.folder.path, {"mlflow": page})

    def artifact(self, folder: Path, name: str, result: Mapping[str, Any], step_runs: StepRuns) -> None:
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
            "flow_run_id": step_runs.flow_run, "task_run_id": step_runs.task_run,
        }  # fmt: skip
        try:
            self._client.request("POST", "/artifacts/", json=body, timeout=ARTIFACTS_S)
        except Exception as fault:  # noqa: BLE001 - a server that takes none costs the artifacts, not the batch
            self._silent = True
            told = logging.getLogger(__name__)
            told.warning("Prefect accepts no artifacts (%s); cases are still run and written", fault)


def shows_every_step() -> bool:
    """Whether Prefect is shown every step of a case: as SGCAD_PREFECT_STEPS says ("all", "attempts"), else if the
    server writes states in bulk. A server that writes them one by one needs 8 ms more per step, 150 ms per case.
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
    lacking = f", {account['lacking']} of {account['told']} told lacking" if account and account["lacking"] else ""
    return f"{result['status']}{lacking}"


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
    from PIL import Image

    try:
        with Image.open(folder / "picture.png") as found:
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
