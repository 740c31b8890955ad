"""The `inbox` deployment: a flow run turns the reports that wait into scenarios, and ends.

    python -m flows.deploy.inbox.inbox s3://reports/new --config fused.yaml --out runs

runs it by hand. An inbox is worked by one run at a time: the deployment's limit sees to it, and on local disks a lock
of the operating system, which ends with its process. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from filelock import Timeout
from prefect import flow, get_run_logger
from prefect.client.orchestration import get_client
from prefect.client.schemas.objects import State
from prefect.runtime import flow_run
from prefect.states import Completed

from flows.batch.batch_flow import run_inside_flow
from flows.batch.plan_batch import batch_of
from flows.case_files.find_cases import Case
from flows.deploy.case_table import CaseTable, in_words
from flows.deploy.defaults import inbox_address, overrides_of, results_folder
from flows.deploy.inbox.intake import Do, Intake, OnResult
from flows.deploy.parameters import Config, Jobs, Seconds
from flows.deploy.storage import HIDDEN, Place
from sgcad_core import settings
from sgcad_core.system.locks import lock_file
from sgcad_core.system.private_folders import deny_others
from sgcad_core.system.temp_folders import temp_folder

WORKER = f"{HIDDEN}/worker"
"""Who works a local inbox, in words."""


def _name() -> str:
    return f"inbox, {_stem(flow_run.parameters.get('config'))}"


@flow(name="inbox", flow_run_name=_name, persist_result=False)
def inbox_flow(
    address: str = "",
    config: Config = "",
    out: Path | None = None,
    overrides: tuple[str, ...] = (),
    jobs: Jobs = None,
    settle_s: Seconds = 5.0,
) -> State[Any]:
    """Turn the reports that wait in the inbox into scenarios.

    Args:
        address: Folder or fsspec address (s3://...) of the inbox. Empty: SGCAD_INBOX, else the folder inbox of the
            results.
        config: Config that writes the scenarios. Empty: the default one.
        out: Folder of the results. Empty: SGCAD_OUT, else runs.
        overrides: Changes of the config as key=value, such as max_attempts=3.
        jobs: Cases at a time. Empty: by the cores, or by the model's batch.
        settle_s: Seconds for which a report must be unchanged before it is taken.
    """
    config, out, overrides = config or settings.default_config(), results_folder(out), overrides_of(overrides)
    batch_of((), [Path(config)], out, overrides, jobs)  # with a faulty config no report is taken
    place, table = Place(inbox_address(address)), CaseTable()
    try:
        with _alone(place), temp_folder("inbox") as staging:
            intake = Intake(place, staging, settle_s, config, out, get_run_logger().warning)
            counts = intake.work(_by_tasks(config, out, overrides, jobs, table))
    except Timeout:
        worker = (place.read(WORKER) or b"another run").decode(errors="replace")
        return Completed(name="Busy", message=f"{worker} works {place.address}", data={})
    table.show()
    return Completed(name=None if intake.counts else "Empty", message=in_words(counts) or "nothing waits", data=counts)


@contextmanager
def _alone(place: Place) -> Iterator[None]:
    """Hold a local inbox for the block. Raises Timeout where another run holds it."""
    if not place.is_local:
        yield
        return
    (folder := Path(place.path(HIDDEN))).mkdir(parents=True, exist_ok=True)
    with lock_file(folder / "lock", timeout_s=0):
        place.write(WORKER, f"flow run {flow_run.name or flow_run.id!r} (process {os.getpid()})".encode())
        yield


def _by_tasks(config: str, out: Path, overrides: tuple[str, ...], jobs: int | None, table: CaseTable) -> Do:
    """Runs cases as task runs of the current flow run, whose name tells their number."""

    def do(cases: Sequence[Case], on_result: OnResult) -> None:
        count = sum(table.counts.values()) + len(cases)
        with get_client(sync_client=True) as client:
            name = f"inbox: {count} report{'s' * (count > 1)}, {_stem(config)}"
            client.update_flow_run(flow_run_id=flow_run.id, name=name)

        def ended(job: Any, ending: Any, untracked: str) -> None:
            table.add(job, ending, untracked)
            on_result(job.case, ending.result)

        run_inside_flow(batch_of(cases, [Path(config)], out, overrides, jobs), ended)

    return do


def _stem(config: str | None) -> str:
    return Path(config or settings.default_config()).stem


if __name__ == "__main__":
    from prefect.context import refresh_global_settings_context
    from prefect.settings import PREFECT_API_URL, temporary_settings

    from flows.server import prefect_server

    deny_others()
    # Prefect was imported before the server was named, and would start a server that survives a kill.
    with prefect_server() as server, temporary_settings({PREFECT_API_URL: settings.prefect_url()}):
        refresh_global_settings_context()  # for Prefect's own threads, which see no temporary settings
        if server:
            server.wait()
        asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
        asked.add_argument("address")
        for name in ("config", "out", "settle-s"):
            asked.add_argument(f"--{name}", default=argparse.SUPPRESS)
        sys.stdout.write(json.dumps(inbox_flow(**vars(asked.parse_args()))) + "\n")
