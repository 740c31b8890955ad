"""`sgcad doctor`: checks the installation; each line gives the check, its value, and the remedy of a fault."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import httpx
import psutil
from rich.console import Console

from flows import health
from flows.case_files import case_folder
from flows.server import prefect_server
from flows.terminal import escape
from sgcad_core import settings
from sgcad_core.errors import SgcadError
from sgcad_core.system.temp_folders import leftover_folders, temp_folder

PACKAGES = (
    "prefect", "mlflow", "torch", "transformers", "eclipse-sumo", "libsumo", "scenariogeneration", "lancedb",
)  # fmt: skip
LOW_MB = 2000
STALE_S = 24 * 3600
CHILDREN = ("prefect.server.api.server:create_app", "flows.server", "sgcad_core.system.worker_process")
"""Modules that run only as children of another command."""


class CheckFailed(Exception):
    """A check failed; the message says what to do."""


def examine(out: Path) -> bool:
    """Run every check and print a line each; True if none failed."""
    settings.quiet_libraries()
    console = Console(emoji=False, highlight=False)
    fine, wrong = True, set[str]()
    for name, test in CHECKS.items():
        started = time.perf_counter()
        if stands_on := wrong & NEEDS.get(name, set()):
            console.print(f"[yellow]not checked[/] {name}: repair {', '.join(sorted(stands_on))} first")
            continue
        try:
            said, mark = test(out), "[green]ok[/]   "
        except (CheckFailed, SgcadError, OSError, subprocess.SubprocessError) as fault:
            said, mark, fine = str(fault), "[red]wrong[/]", False
            wrong.add(name)
        seconds = time.perf_counter() - started
        console.print(f"{mark} {escape(name)}: {escape(said)} [dim]({seconds:.1f} s)[/]", soft_wrap=True)
    return fine


def _python(out: Path) -> str:
    if not (3, 11) <= sys.version_info[:2] < (3, 14):
        raise CheckFailed(f"Python {sys.version.split()[0]}; 3.11 to 3.13 are supported")
    return sys.version.split()[0]


def _packages(out: Path) -> str:
    return ", ".join(f"{name} {_version(name)}" for name in PACKAGES)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError as fault:
        raise CheckFailed(f"{name} is not installed: pip install -e .") from fault


def _netconvert(out: Path) -> str:
    command, environment = [str(settings.netconvert()), "--version"], settings.subprocess_environment()
    said = subprocess.run(command, capture_output=True, text=True, timeout=30, env=environment)  # noqa: S603 - ours
    if said.returncode:
        raise CheckFailed(f"{settings.netconvert()} does not run: {said.stderr.strip()[:200]}")
    return said.stdout.splitlines()[0]


def _configs(out: Path) -> str:
    from flows.study.plan import arms_of
    from flows.study_file.spec import is_study, load_study
    from sgcad_core.config import load

    files = sorted(settings.CONFIGS.rglob("*.yaml"))
    for file in files:
        if is_study(file):
            arms_of(load_study(file), out)
        else:
            load(file)
    return f"{len(files)} in {settings.CONFIGS} are fine, studies included"


def _writable(out: Path) -> str:
    there = out.exists()
    case_folder.check_writable(out)
    free = shutil.disk_usage(out).free // 2**20
    if not there:
        out.rmdir()
    if free < LOW_MB:
        raise CheckFailed(f"{free:,} MB free at {out.resolve()}; {LOW_MB:,} are advised for a batch of 1,000 cases")
    return f"{out.resolve()} can be written, {free:,} MB free"


def _home(out: Path) -> str:
    """Check Prefect's folder first: Prefect itself would try to create it for half a minute."""
    home = settings.prefect_home()
    try:
        home.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(prefix=".sgcad-", dir=home):
            pass
    except OSError as fault:
        raise CheckFailed(
            f"{home} cannot be written ({fault.strerror}): set PREFECT_HOME to a folder that can"
        ) from fault
    return f"{home} can be written"


def _flow(out: Path) -> str:
    """Run a real flow, on the user's server or on one of this command."""
    with prefect_server() as server:
        if server:
            server.wait()
        try:
            stale = _run_tiny_flow()
        except (RuntimeError, httpx.HTTPError) as fault:
            raise CheckFailed(f"no Prefect flow can run: {fault}; look at PREFECT_HOME and PREFECT_API_URL") from fault
    said = f"a Prefect flow runs (server: {settings.prefect_url() or 'one for each command'})"
    if stale:
        remedy = f"prefect flow-run delete {stale[0]} ..."
        said += f"; {len(stale)} runs of killed batches still say RUNNING, remove them: {remedy}"
    return said


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


def _services(out: Path) -> str:
    """Check the services that `make up` started here, or those of the named server."""
    there = health.noted(health.services_folder(out))
    api = f"{there['server'].address}/api" if "server" in there else settings.prefect_url()
    if not api:
        return "none started here and no server named in PREFECT_API_URL; `make up` starts them"
    said = [(s.healthy(), f"{s.name} {'well' if s.healthy() else f'not well, see {s.log}'}") for s in there.values()]
    said += health.server_lines(api)
    line = "; ".join(text for _, text in said)
    if there and not all(fine for fine, _ in said):
        raise CheckFailed(f"{line}; `make down`, then `make up`")
    return line


def _database(out: Path) -> str:
    from typing import cast

    from sgcad_core.interfaces import Tracker
    from sgcad_core.registry import plugin_class

    tracker = cast("Tracker", plugin_class("tracker", "mlflow")())
    result = {"status": "generated", "seconds": {}}
    with temp_folder("doctor") as place:
        case = place / "config" / "case"
        (case / "attempts").mkdir(parents=True)
        tracker.log_case("doctor", {}, case, result)
    return "MLflow can log a run to sqlite"


def _leftovers(out: Path) -> str:
    processes = [str(p.pid) for p in _orphans()]
    partial = [str(p) for p in out.glob(f"*/{case_folder.PARTIAL}*")] if out.is_dir() else []
    counted = {"half-written case folders": len(partial), "temporary folders": len(leftover_folders())}
    found = [f"{count} {what}" for what, count in counted.items() if count]
    lying = f"{' and '.join(found)} of killed or running batches; the next batch clears them" if found else ""
    if processes:
        ended = f"processes of killed commands still run; end them: kill {' '.join(processes)}"
        raise CheckFailed(f"{ended}; {lying}" if lying else ended)
    if lying:
        return lying
    return "no orphaned process, no half-written case, no temporary folder"


def _orphans() -> Iterator[psutil.Process]:
    """The project's processes without a parent command. In a container the command itself may be process 1."""
    try:
        if any(part in " ".join(psutil.Process(1).cmdline()) for part in ("sgcad", "prefect", "flows.")):
            return
    except psutil.Error:
        return
    for process in psutil.process_iter(["pid", "ppid", "cmdline"]):
        line = process.info["cmdline"] or []
        if process.info["ppid"] == 1 and any(one in line for one in CHILDREN):
            yield process


CHECKS: dict[str, Callable[[Path], str]] = {
    "python": _python,
    "packages": _packages,
    "netconvert": _netconvert,
    "configs": _configs,
    "output": _writable,
    "home": _home,
    "flow": _flow,
    "tracking": _database,
    "services": _services,
    "leftovers": _leftovers,
}
NEEDS: dict[str, set[str]] = {"flow": {"home", "output"}, "tracking": {"output"}, "services": {"home"}}
"""Checks that are skipped if one of these has failed."""
