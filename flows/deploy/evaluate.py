"""Deployments of one report or of folders of reports, from plain parameters.

Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from prefect import flow

from flows.batch.batch_flow import counts_inside_flow, run_inside_flow
from flows.batch.plan_batch import MAX_JOBS, batch_of
from flows.batch.prefect_case_task import threads
from flows.case_files.find_cases import cases_in, cases_of
from sgcad_core import settings


@flow(name="generate", flow_run_name="generate {report}", persist_result=False)
def generate_flow(
    report: str, config: str | None = None, out: str = "runs", overrides: list[str] | None = None
) -> dict[str, Any]:
    """Turn one report into a scenario; the content of its result.json."""
    configs = [Path(config or settings.default_config())]
    results: list[dict[str, Any]] = []
    batch = batch_of(cases_of([Path(report)]), configs, Path(out), overrides or (), jobs=1)
    run_inside_flow(batch, lambda _job, ending, _untracked: results.append(ending.result))
    return results[0]


@flow(name="evaluate-deployed", flow_run_name="evaluate {folders}", task_runner=threads(MAX_JOBS), persist_result=False)
def evaluate_flow(
    folders: list[str],
    configs: list[str] | None = None,
    out: str = "runs",
    overrides: list[str] | None = None,
    jobs: int | None = None,
) -> dict[str, int]:
    """Run a batch; the number of cases by the status that they ended with."""
    cases, paths = cases_in([Path(f) for f in folders]), settings.configs_or_default(configs)
    return counts_inside_flow(batch_of(cases, paths, Path(out), overrides or (), jobs))
