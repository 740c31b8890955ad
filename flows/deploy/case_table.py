"""What a deployed run shows of its cases: counts in its state's message, and a table among its artifacts.

Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from prefect.artifacts import create_markdown_artifact
from prefect.client.schemas.objects import State
from prefect.runtime import flow_run
from prefect.states import Completed

from flows.batch.plan_batch import Job
from flows.case.run_case import Ending
from flows.case_files import case_links
from flows.deploy.defaults import results_folder
from sgcad_core.result import counts_of

MOST_ROWS = 500
HEAD = "| case | config | status | verdict | pages |\n|---|---|---|---|---|\n"


@dataclass
class CaseTable:
    """The cases of one flow run as they end."""

    counts: Counter[str] = field(default_factory=Counter)
    rows: list[str] = field(default_factory=list)

    def add(self, job: Job, ending: Ending, _untracked: str = "") -> None:
        """Add a case (an `OnEnding`)."""
        status = str(ending.result["status"])
        self.counts[status] += 1
        account = counts_of(ending.result)
        said = account["verdict"] if account else str(ending.result["reason"] or "")[:200]
        cells = (job.case.id, job.config.name, status, said, _pages(job.folder.path))
        self.rows.append("| " + " | ".join(" ".join(c.replace("|", "\\|").split()) for c in cells) + " |\n")

    def show(self) -> None:
        """Make the table an artifact of the current flow run; nothing without cases."""
        if self.rows:
            more = f"\n{len(self.rows) - MOST_ROWS} more are in the results folder." if self.rows[MOST_ROWS:] else ""
            key = f"{flow_run.flow_name}-cases"
            create_markdown_artifact(HEAD + "".join(self.rows[:MOST_ROWS]) + more, key, in_words(self.counts))

    def completed(self) -> State[Any]:
        """Show the table; the run's last state, with the counts."""
        self.show()
        return Completed(message=in_words(self.counts), data=dict(self.counts))


def _pages(folder: Path) -> str:
    """Links to a case's pages that are served now, else its folder."""
    served, run = case_links.served(folder.parent.parent), case_links.kept(folder).get("mlflow", "")
    mlflow = served.mlflow or case_links.served(results_folder(None).resolve()).mlflow
    found = {"desk": served.case_page(folder), "MLflow": run and case_links.resolved(run, mlflow)}
    return ", ".join(f"[{name}]({page})" for name, page in found.items() if page) or f"`{folder}`"


def in_words(counts: Mapping[str, int]) -> str:
    """Such as "3 generated, 1 refused"."""
    return ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in sorted(counts.items()))


def named(kind: str, *, about: Sequence[object], more: str = "") -> str:
    """A flow run's name, such as "nightly template 2026-11-27"; of many configs or folders the first."""
    first = [Path(str(one)).stem for one in about[:2]] + ["..."] * (len(about) > 2)
    return " ".join(filter(None, [kind, ", ".join(first), more]))
