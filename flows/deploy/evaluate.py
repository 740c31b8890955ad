"""The `evaluate` deployment: folders of reports under some configs. Import after `settings.quiet_libraries()`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from prefect import flow
from prefect.client.schemas.objects import State
from prefect.runtime import flow_run

from flows.batch.batch_flow import run_inside_flow
from flows.batch.plan_batch import batch_of
from flows.case_files.find_cases import cases_in
from flows.case_files.folder_cases import left_out
from flows.deploy.case_table import CaseTable, named
from flows.deploy.defaults import overrides_of, results_folder
from flows.deploy.parameters import Config, Jobs
from sgcad_core import settings


def _name() -> str:
    asked = flow_run.parameters
    over = named("over", about=asked["folders"])
    return named("evaluate", about=settings.configs_or_default(asked.get("configs")), more=over)


@flow(name="evaluate", flow_run_name=_name, persist_result=False)
def evaluate_flow(
    folders: tuple[Path, ...],
    configs: tuple[Config, ...] = (),
    out: Path | None = None,
    overrides: tuple[str, ...] = (),
    jobs: Jobs = None,
    fresh: bool = False,
) -> State[Any]:
    """Turn folders of reports into scenarios, as `sgcad evaluate` does.

    Args:
        folders: Folders of reports, or of folders with one report each.
        configs: Configs that write the scenarios. Empty: the default one.
        out: Folder of the results. Empty: SGCAD_OUT, else runs.
        overrides: Changes of every config as key=value, such as max_attempts=3.
        jobs: Cases at a time. Empty: by the cores, or by the model's batch.
        fresh: Repeat finished cases too.
    """
    paths, table = settings.configs_or_default(configs), CaseTable()
    batch = batch_of(cases_in(folders), paths, results_folder(out), overrides_of(overrides), jobs, fresh)
    run_inside_flow(replace(batch, left=left_out(folders)), table.add)
    return table.completed()
