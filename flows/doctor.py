"""`sgcad doctor`: checks the installation; each line gives the check, its value, and the remedy of a fault.

Checks that take long run side by side, those that import much in processes of their own.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import psutil
from rich.console import Console

from flows import health
from flows.service_checks import CheckFailed, can_log, logs_a_run, prefect_opens, runs_a_flow
from flows.terminal import escape
from sgcad_core import settings
from sgcad_core.errors import SgcadError
from sgcad_core.system.temp_folders import leftover_folders
from sgcad_core.system.worker_process import Worker

PACKAGES = (
    "prefect", "mlflow", "torch", "transformers", "eclipse-sumo", "libsumo", "scenariogeneration", "lancedb",
)  # fmt: skip
LOW_MB = 2000
LONGEST_S = 600.0
CHILDREN = ("prefect.server.api.server:create_app", "flows.server", "sgcad_core.system.worker_process")
"""Modules that run only as children of another command."""


@dataclass(frozen=True)
class Said:
    """The outcome of a check."""

    fine: bool
    text: str
    seconds: float = 0.0


def examine(out: Path, services: bool = False) -> bool:
    """Run every check and print a line each; True if none failed.

    `services`: a real flow and a real MLflow run, also where no Prefect server is named.
    """
    settings.quiet_libraries()
    console = Console(emoji=False, highlight=False)
    told = {name: _said(test, out) for name, test in CHECKS.items() if name not in SIDE_BY_SIDE}
    wrong = {name for name, said in told.items() if not said.fine}
    pool = ThreadPoolExecutor(len(SIDE_BY_SIDE))
    try:
        running = {
            name: pool.submit(_said, _test(name, services), out)
            for name in SIDE_BY_SIDE
            if not wrong & NEEDS.get(name, set())
        }
        printed = [_print(console, name, told.get(name) or running.get(name), wrong) for name in CHECKS]
        return all(printed)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _print(console: Console, name: str, found: Said | Future[Said] | None, wrong: set[str]) -> bool:
    """Print a check's line when it has ended; whether nothing is wrong."""
    if found is None:
        first = ", ".join(sorted(wrong & NEEDS[name]))
        console.print(f"[yellow]not checked[/] {name}: repair {first} first")
        return True
    said = found.result() if isinstance(found, Future) else found
    mark = "[green]ok[/]   " if said.fine else "[red]wrong[/]"
    console.print(f"{mark} {escape(name)}: {escape(said.text)} [dim]({said.seconds:.1f} s)[/]", soft_wrap=True)
    return said.fine


def _said(test: Callable[[Path], str], out: Path) -> Said:
    started = time.perf_counter()
    try:
        fine, text = True, test(out)
    except (SgcadError, OSError, subprocess.SubprocessError) as fault:
        fine, text = False, str(fault)
    return Said(fine, text, time.perf_counter() - started)


def _test(name: str, services: bool) -> Callable[[Path], str]:
    """A check to be run beside others: in a process of its own where it imports much."""
    if name not in APART:
        return CHECKS[name]
    return lambda out: str(Worker("flows.doctor:check_apart").call(name, out, services, timeout_s=LONGEST_S))


def check_apart(name: str, out: Path, services: bool) -> str:
    """One check in this process. Raises SgcadError."""
    settings.quiet_libraries()
    real = services or (name == "flow" and settings.prefect_url())
    try:
        return (REAL if real and name in REAL else CHECKS)[name](out)
    except (OSError, subprocess.SubprocessError) as fault:
        raise CheckFailed(str(fault)) from fault
    except ImportError as fault:
        raise CheckFailed(f"cannot be imported ({fault}): pip install -e .") from fault


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
    from flows.case_files import case_folder

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
    return f"{settings.writable_prefect_home()} can be written"


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


def _leftovers(out: Path) -> str:
    from flows.case_files import case_folder

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
    "flow": prefect_opens,
    "tracking": can_log,
    "services": _services,
    "leftovers": _leftovers,
}
REAL: dict[str, Callable[[Path], str]] = {"flow": runs_a_flow, "tracking": logs_a_run}
"""In place of those above with `--services`, the flow also on a server that is named."""
SIDE_BY_SIDE = ("tracking", "flow", "configs", "netconvert", "services")
"""Checks that take long, the longest first."""
APART = ("tracking", "flow", "configs")
NEEDS: dict[str, set[str]] = {"flow": {"home", "output"}, "tracking": {"output"}, "services": {"home"}}
"""Checks that are skipped if one of these has failed."""
