"""One report as one Prefect flow run, for deployments that are handed reports one by one.

Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from prefect import flow

from flows.batch import find_cases
from flows.batch.evaluate_flow import drive
from flows.batch.plan_batch import Crew, Job, batch_of
from flows.case.chain import Ending
from sgcad_core import settings


@flow(name="generate", flow_run_name="generate {report}", persist_result=False)
def generate_flow(
    report: str, config: str | None = None, out: str = "runs", overrides: list[str] | None = None
) -> dict[str, Any]:
    """Turn one report into a scenario; the content of its result.json."""
    batch = batch_of(
        find_cases.cases_of([Path(report)]),
        [Path(config or settings.default_config())],
        Path(out),
        overrides or (),
        jobs=1,
    )
    plan, crew = batch.plan(), Crew(batch)
    results: list[dict[str, Any]] = []

    def keep(job: Job, ending: Ending, untracked: str) -> None:
        results.append(ending.result)

    crew.begin(plan)
    drive(plan, crew, keep)
    crew.close()
    return results[0]
