"""Whether Prefect and MLflow work: looked at without starting anything, or by a real flow and a real run."""

from __future__ import annotations

import importlib
import sqlite3
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, cast

from flows.server import prefect_server
from sgcad_core import settings
from sgcad_core.errors import SgcadError
from sgcad_core.system.temp_folders import temp_folder

if TYPE_CHECKING:
    from sgcad_core.interfaces import Tracker

STALE_S = 24 * 3600
LOCKED_S = 5.0


class CheckFailed(SgcadError):
    """A check failed; the message says what to do."""


def prefect_opens(out: Path) -> str:
    """Prefect imports and its database opens; no server and no flow is started."""
    importlib.import_module("prefect.main")
    from prefect.settings import get_current_settings

    url = get_current_settings().server.database.connection_url
    kind, _, file = (url.get_secret_value() if url else "").partition(":///")
    more = "; --services runs a flow on a server"
    if not kind.startswith("sqlite") or ":memory:" in file:
        return f"Prefect imports; its database is no file{more}"
    place = Path(file.partition("?")[0])
    if not place.exists():
        return f"Prefect imports; the first batch makes its database{more}"
    try:
        return f"Prefect imports, {place} opens{more}{_told(_stale_runs(place))}"
    except sqlite3.Error as fault:
        raise CheckFailed(
            f"{place}: Prefect's database cannot be used ({fault}): end what locks it, or move it"
        ) from fault


def _stale_runs(database: Path) -> list[str]:
    """Ids of runs in Prefect's database that have been RUNNING for longer than STALE_S. Raises sqlite3.Error."""
    oldest = f"{datetime.now(UTC) - timedelta(seconds=STALE_S):%Y-%m-%d %H:%M:%S}"
    asked = "SELECT id FROM flow_run WHERE state_type = 'RUNNING' AND start_time < ?"
    with closing(sqlite3.connect(database, timeout=LOCKED_S, isolation_level=None)) as found:
        found.execute("BEGIN IMMEDIATE")  # so that it can be written, too
        rows = found.execute(asked, (oldest,)).fetchall()
        found.execute("ROLLBACK")
    return [str(row[0]) for row in rows]


def _told(stale: list[str]) -> str:
    if not stale:
        return ""
    remedy = f"prefect flow-run delete {stale[0]} ..."
    return f"; {len(stale)} runs of killed batches still say RUNNING, remove them: {remedy}"


def runs_a_flow(out: Path) -> str:
    """Run a real flow, on the user's server or on one of this command."""
    import httpx

    with prefect_server() as server:
        if server:
            server.wait()
        try:
            stale = _run_tiny_flow()
        except (RuntimeError, httpx.HTTPError) as fault:
            raise CheckFailed(f"no Prefect flow can run: {fault}; look at PREFECT_HOME and PREFECT_API_URL") from fault
    return f"a Prefect flow runs (server: {settings.prefect_url() or 'one for each command'}){_told(stale)}"


def _run_tiny_flow() -> list[str]:
    """Run a flow; ids of runs that have been RUNNING for longer than STALE_S, left by killed batches."""
    from prefect import flow
    from prefect.client.orchestration import get_client
    from prefect.events.worker import EventsWorker
    from prefect.settings import PREFECT_FLOWS_HEARTBEAT_FREQUENCY, temporary_settings

    def tiny() -> None:
        """Do nothing."""

    with temporary_settings({PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None}):
        flow(name="doctor")(tiny)()
    oldest = datetime.now(UTC) - timedelta(seconds=STALE_S)
    with get_client(sync_client=True) as client:
        runs = client.read_flow_runs(limit=200)
    EventsWorker.drain_all(timeout=5)
    return [str(r.id) for r in runs if r.state and r.state.is_running() and r.start_time and r.start_time < oldest]


def _tracker() -> Tracker:
    from sgcad_core.registry import plugin_class

    return cast("Tracker", plugin_class("tracker", "mlflow")())


def can_log(out: Path) -> str:
    """MLflow imports, and its database opens if there is one; nothing is logged."""
    importlib.import_module("mlflow")
    _tracker().ready(out)
    return "MLflow imports and its database can be used; --services logs a run"


def logs_a_run(out: Path) -> str:
    """Log a real run to a new MLflow database."""
    result = {"status": "generated", "seconds": {}}
    with temp_folder("doctor") as place:
        case = place / "config" / "case"
        (case / "attempts").mkdir(parents=True)
        _tracker().log_case("doctor", {}, case, result)
    return "MLflow can log a run to sqlite"
