"""The `inbox` deployment: one flow run turns the waiting reports into scenarios.

    python -m flows.deploy.inbox.inbox s3://reports/new --config fused.yaml --out runs

runs it by hand. Several may run at once, on one machine or many. Import after
`settings.quiet_libraries()`.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from prefect import flow

from flows.batch.batch_flow import run_inside_flow
from flows.batch.plan_batch import MAX_JOBS, batch_of
from flows.batch.prefect_case_task import threads
from flows.case_files.find_cases import Case
from flows.deploy.defaults import inbox_address, overrides_of
from flows.deploy.inbox.claims import Claims
from flows.deploy.inbox.intake import Do, Intake, OnResult
from flows.deploy.storage import Place
from sgcad_core import settings
from sgcad_core.errors import ConfigError
from sgcad_core.system.temp_folders import temp_folder

PORTION = 48
"""Reports claimed at a time: those held by a killed worker, and those per start of worker processes."""


@flow(name="inbox", task_runner=threads(MAX_JOBS), persist_result=False)
def inbox_flow(
    address: str | None = None,
    config: str | None = None,
    out: str = "runs",
    overrides: list[str] | None = None,
    jobs: int | None = None,
    portion: int = PORTION,
    settle_s: float = 10.0,
    lease_s: float = 120.0,
    wait_s: float = 30.0,
    watch_s: float = 0.0,
) -> dict[str, int]:
    """Turn the reports at an address into scenarios; the number of reports by status.

    `address`: any fsspec address; by default the variable SGCAD_INBOX, then runs/inbox. A report counts as complete
    when it did not change for `settle_s`. A worker that is silent for `lease_s` loses its reports. The run ends
    when the inbox is empty or nothing could be taken for `wait_s`, but not before `watch_s` have passed.
    """
    address, named, config = inbox_address(address), overrides_of(overrides), config or settings.default_config()
    batch_of((), [Path(config)], Path(out), named, jobs)  # with a faulty config no report is claimed
    if min(settle_s, wait_s, watch_s) < 0 or lease_s <= 0 or portion < 1:
        raise ConfigError(
            f"settle_s {settle_s}, wait_s {wait_s}, watch_s {watch_s} must not be below 0, "
            f"lease_s {lease_s}, portion {portion} not below or at 0"
        )
    place = Place(address)
    with temp_folder("inbox") as staging:
        intake = Intake(place, Claims(place, lease_s), staging, settle_s, config, Path(out))
        return intake.work(_by_tasks(config, out, named, jobs), portion, wait_s, watch_s)


def _by_tasks(config: str, out: str, overrides: tuple[str, ...], jobs: int | None) -> Do:
    """Runs cases as task runs of the current flow run."""

    def do(cases: Sequence[Case], on_result: OnResult) -> None:
        batch = batch_of(cases, [Path(config)], Path(out), overrides, jobs)
        run_inside_flow(batch, lambda job, ending, _untracked: on_result(job.case, ending.result))

    return do


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the inbox once by hand."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("address")
    parser.add_argument("--config", default=settings.default_config())
    parser.add_argument("--out", default="runs")
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--portion", type=int, default=PORTION)
    for name, value in (("settle", 10.0), ("lease", 120.0), ("wait", 30.0), ("watch", 0.0)):
        parser.add_argument(f"--{name}-s", type=float, default=value)
    asked = vars(parser.parse_args(arguments))
    sys.stdout.write(json.dumps(inbox_flow(**asked)) + "\n")


if __name__ == "__main__":
    from prefect.settings import PREFECT_API_URL, temporary_settings

    from flows.server import prefect_server

    # Prefect was imported before the server was named, and would start a server that survives a kill.
    with prefect_server() as server, temporary_settings({PREFECT_API_URL: settings.prefect_url()}):
        if server:
            server.wait()
        main()
