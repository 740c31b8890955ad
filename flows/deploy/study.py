"""The `study` deployment: a study file over a folder of cases. Import after `settings.quiet_libraries()`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from prefect import flow
from prefect.client.schemas.objects import State
from prefect.runtime import flow_run

from flows.batch.batch_flow import run_inside_flow
from flows.deploy.case_table import CaseTable, named
from flows.deploy.defaults import overrides_of, results_folder
from flows.deploy.parameters import Jobs, Study
from flows.study.plan import plan
from flows.study_file.spec import load_study


def _name() -> str:
    over = flow_run.parameters.get("cases")
    return named("study", about=[flow_run.parameters["file"]], more=named("over", about=over) if over else "")


@flow(name="study", flow_run_name=_name, persist_result=False)
def study_flow(
    file: Study,
    cases: tuple[Path, ...] = (),
    truth: Path | None = None,
    out: Path | None = None,
    overrides: tuple[str, ...] = (),
    jobs: Jobs = None,
    fresh: bool = False,
    workers: str = "auto",
    store: str = "",
) -> State[Any]:
    """Run a study, as `sgcad study` does.

    Args:
        file: The study.
        cases: Folders of cases. Empty: those that the study names.
        truth: Folder of labels. Empty: the one that the study names.
        out: Folder of the results. Empty: SGCAD_OUT, else runs.
        overrides: Changes of every arm's config as key=value, such as max_attempts=3.
        jobs: Cases at a time. Empty: by the cores, or by the model's batch.
        fresh: Repeat finished cases too.
        workers: Where cases run: auto, threads, processes, dask, or the address of a Dask scheduler.
        store: Address of the results of a Dask cluster.
    """
    study, changes, table = load_study(Path(file)), overrides_of(overrides), CaseTable()
    made = plan(study, results_folder(out), cases=cases, truth=truth, overrides=changes, jobs=jobs, fresh=fresh)
    made = replace(made, batch=made.batch.shown(made.batch.detail, workers, store))
    made.write()
    run_inside_flow(made.batch, table.add, made.jobs)
    return table.completed()
