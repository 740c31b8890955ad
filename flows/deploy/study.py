"""The `study` deployment: a study file, started by hand from Prefect's page with its parameters.

Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

from pathlib import Path

from prefect import flow

from flows.batch.batch_flow import counts_inside_flow
from flows.batch.plan_batch import MAX_JOBS
from flows.batch.prefect_case_task import threads
from flows.deploy.defaults import overrides_of
from flows.study.plan import plan
from flows.study_file.spec import load_study


@flow(name="study", flow_run_name="study {file}", task_runner=threads(MAX_JOBS), persist_result=False)
def study_flow(
    file: str,
    cases: list[str] | None = None,
    truth: str | None = None,
    out: str = "runs",
    overrides: list[str] | None = None,
    jobs: int | None = None,
    fresh: bool = False,
) -> dict[str, int]:
    """Run a study, as `sgcad study` does; the number of cases by status. `file`: a name or a path."""
    made = plan(
        load_study(Path(file)),
        Path(out),
        cases=[Path(c) for c in cases or ()],
        truth=Path(truth) if truth else None,
        overrides=overrides_of(overrides),
        jobs=jobs,
        fresh=fresh,
    )
    made.write()
    return counts_inside_flow(made.batch, made.jobs)
