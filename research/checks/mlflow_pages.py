"""Opens MLflow's pages in headless Chromium and checks that they show runs, metrics, files and traces.

    python -m research.checks.mlflow_pages runs/mlflow.db [--experiment study/alpha] [--shots FOLDER] [--wait 120]

Starts `mlflow server` on a free port over the database, asks the database what must be seen, opens the pages of an
experiment (runs, charts, comparison of the arms, traces) and of one case (figures, files), and waits until the
browser shows it. Exit codes: 0 everything was seen; 1 something is missing (named on stderr); 2 no such database
or nothing in it; 3 no Chromium on this machine.
"""

from __future__ import annotations

import argparse
import base64
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sgcad_core import settings

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
START_S = 180.0
LOOK_S = 0.5
QUIET_LOOKS = 4
"""Number of equal looks in a row after which a page counts as painted."""
SIZE = (1700, 950)
LIST = "workflowType=machine_learning"
"""Opens the list of runs as such, whatever the browser remembers."""
TIDY = """document.querySelectorAll('button').forEach(
    b => /^(close|got it|dismiss)/i.test(b.ariaLabel || b.innerText) && b.click())"""
"""Closes what MLflow opens over and beside its pages for newcomers."""


class Failed(Exception):
    """The pages cannot be looked at; `code` is the exit code."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


@dataclass(frozen=True)
class Page:
    """One page, and the words that it must show."""

    name: str
    path: str
    words: tuple[str, ...]


# ------------------------------------------------------------------ what must be seen
def pages_of(database: Path, experiment: str) -> list[Page]:
    """Pages and words, from what the database holds. Raises Failed where there is no run to look at."""
    import mlflow

    client = mlflow.MlflowClient(tracking_uri=f"sqlite:///{database}")
    found = _experiment(client, experiment, database)
    runs = client.search_runs([found.experiment_id], order_by=["attributes.start_time DESC"])
    arms = [r for r in runs if r.data.tags.get("sgcad.level") == "config"][:4]
    cases = [r for r in runs if arms and r.data.tags.get("mlflow.parentRunId") == arms[0].info.run_id]
    if not arms or not cases:
        raise Failed(f"{database}: no arm with cases in {found.name!r}; run `sgcad study` or `sgcad evaluate` first", 2)
    here = f"/#/experiments/{found.experiment_id}"
    return [*_of_arms(here, found, arms), *_of_case(client, here, cases[0])]


def _experiment(client: Any, name: str, database: Path) -> Any:
    """The named experiment, or the one with the newest run."""
    if name:
        if (found := client.get_experiment_by_name(name)) is None:
            known = ", ".join(e.name for e in client.search_experiments())
            raise Failed(f"{database}: no experiment {name!r}; there are {known}", 2)
        return found
    ids = [e.experiment_id for e in client.search_experiments()]
    newest = client.search_runs(ids, "tags.`sgcad.level` = 'config'", max_results=1)
    if not newest:
        raise Failed(f"{database}: no run in it; run `sgcad study` or `sgcad evaluate` first", 2)
    return client.get_experiment(newest[0].info.experiment_id)


def _of_arms(here: str, experiment: Any, arms: list[Any]) -> list[Page]:
    names = tuple(run.info.run_name for run in arms)
    ids = quote(json.dumps([run.info.run_id for run in arms]))
    compare = f"/#/compare-runs?runs={ids}&experiments={quote(json.dumps([experiment.experiment_id]))}"
    share = f"{arms[0].data.metrics['collision_realised']:.3g}"
    figures = ("0_headline/06_generated", "account/whole", share)
    arms_only = quote("tags.`sgcad.level` = 'config'")
    return [
        Page("runs", f"{here}/runs?{LIST}&searchFilter={arms_only}", (experiment.name, *names)),
        Page("charts", f"{here}/runs?{LIST}&compareRunsMode=CHART&searchFilter={arms_only}", ("0_headline", *names)),
        Page("table", f"{here}/runs/{arms[0].info.run_id}/artifacts/cases.json", ("outcome", "verdict", "config.yaml")),
        Page("compare", compare, (*names, "decoder", *figures)),
    ]


def _of_case(client: Any, here: str, case: Any) -> list[Page]:
    run = f"{here}/runs/{case.info.run_id}"
    files = tuple(f.path for f in client.list_artifacts(case.info.run_id) if not f.path.startswith("."))
    figures = ("collision_realised", "road_writer", case.data.params["road_writer"])
    pages = [
        Page("case", run, (case.info.run_name, case.data.tags["sgcad.config"], *figures)),
        Page("files", f"{run}/artifacts", ("result.json", *files)),
    ]
    here = [case.info.experiment_id]
    calls = client.search_traces(locations=here, filter_string=f"attributes.run_id = '{case.info.run_id}'")
    if calls:  # the run's own tab: a trace stands there only if it points to this run
        pages.append(Page("traces", f"{run}/traces", (calls[0].info.response_preview, "1 of 1")))
    return pages


# ------------------------------------------------------------------ the server
@contextmanager
def served(database: Path) -> Iterator[str]:
    """MLflow's own server over the database; its address. Raises Failed if it does not answer."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [
        sys.executable, "-m", "mlflow", "server", "--backend-store-uri", f"sqlite:///{database}", "--host", "127.0.0.1",
        "--port", str(port), "--workers", "1",
    ]  # fmt: skip
    quiet = {"MLFLOW_DISABLE_TELEMETRY": "true", "DO_NOT_TRACK": "1", "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"}
    with _started(command, {**os.environ, **quiet}) as server:
        address = f"http://127.0.0.1:{port}"
        _until(lambda: server.poll() is not None or _answers(f"{address}/health"), START_S)
        if not _answers(f"{address}/health"):
            raise Failed(f"mlflow server does not answer at {address} after {START_S:g} s", 1)
        yield address


@contextmanager
def _started(command: list[str], environment: dict[str, str]) -> Iterator[subprocess.Popen[bytes]]:
    """A program and its children, ended with the block."""
    quiet = subprocess.DEVNULL
    program = subprocess.Popen(command, env=environment, stdout=quiet, stderr=quiet, start_new_session=True)  # noqa: S603
    try:
        yield program
    finally:
        os.killpg(program.pid, signal.SIGTERM)
        try:
            program.wait(20)
        except subprocess.TimeoutExpired:
            os.killpg(program.pid, signal.SIGKILL)
            program.wait()


def _answers(url: str) -> bool:
    try:
        with urllib.request.urlopen(url, timeout=5):  # noqa: S310 - our own server
            return True
    except (OSError, urllib.error.URLError):
        return False


def _until(holds: Any, limit_s: float) -> bool:
    deadline = time.monotonic() + limit_s
    while time.monotonic() < deadline:
        if holds():
            return True
        time.sleep(LOOK_S)
    return bool(holds())


# ------------------------------------------------------------------ the browser
class Browser:
    """A tab of a headless Chromium, spoken to over its DevTools socket."""

    def __init__(self, connection: Any) -> None:
        self.connection = connection
        self.number = 0

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        """One DevTools command and its result."""
        self.number += 1
        self.connection.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            said = json.loads(self.connection.recv(timeout=START_S))
            if said.get("id") == self.number:
                result: dict[str, Any] = said.get("result", {})
                return result

    def text(self) -> str:
        """The text, titles and field values that the page shows now."""
        script = "[document.body.innerText, ...[...document.querySelectorAll('[title],input')].map(" \
            "e => e.title || e.value)].join('\\n')"  # fmt: skip
        said = self.call("Runtime.evaluate", expression=script, returnByValue=True)
        return str(said.get("result", {}).get("value", ""))

    def missing(self, url: str, words: tuple[str, ...], wait_s: float) -> list[str]:
        """Open a page; the words that it does not show in that time. Returns when the page has settled."""
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=url)
        seen: list[str] = []

        def settled() -> bool:
            self.call("Runtime.evaluate", expression=TIDY)
            seen.append(self.text())
            shown = all(word in seen[-1] for word in words)
            return shown and len(seen) >= QUIET_LOOKS and len(set(seen[-QUIET_LOOKS:])) == 1

        _until(settled, wait_s)
        return [word for word in words if word not in seen[-1]]

    def shot(self, file: Path) -> None:
        """The page as a PNG."""
        file.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))


def browser_program() -> str:
    """The installed Chromium. Raises Failed where there is none."""
    for name in BROWSERS:
        if found := shutil.which(name):
            return found
    raise Failed(f"no Chromium on this machine ({', '.join(BROWSERS)}): apt-get install chromium, or look yourself: "
                 "mlflow ui --backend-store-uri sqlite:///runs/mlflow.db", 3)  # fmt: skip


@contextmanager
def browsing(program: str) -> Iterator[Browser]:
    """A fresh Chromium with a profile of its own."""
    from websockets.sync.client import connect

    with tempfile.TemporaryDirectory(prefix="sgcad-pages-", ignore_cleanup_errors=True) as profile:
        command = [
            program, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
            "--no-first-run", f"--window-size={SIZE[0]},{SIZE[1]}", f"--user-data-dir={profile}",
            "--remote-debugging-port=0", "about:blank",
        ]  # fmt: skip
        with _started(command, dict(os.environ)):
            ready = Path(profile) / "DevToolsActivePort"
            if not _until(lambda: ready.is_file() and "\n" in ready.read_text(), START_S):
                raise Failed(f"{program} does not start; try it by hand: {' '.join(command[:5])}", 1)
            with connect(_tab(int(ready.read_text().splitlines()[0])), max_size=None, open_timeout=START_S) as socket_:
                browser = Browser(socket_)
                browser.call("Page.enable")
                browser.call("Emulation.setDeviceMetricsOverride", width=SIZE[0], height=SIZE[1],
                             deviceScaleFactor=1, mobile=False)  # fmt: skip
                yield browser


def _tab(port: int) -> str:
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=START_S) as said:
        tabs = json.load(said)
    return str(next(tab["webSocketDebuggerUrl"] for tab in tabs if tab["type"] == "page"))


# ------------------------------------------------------------------ command line
def main(arguments: Sequence[str] | None = None) -> int:
    """Open every page and print what it lacks; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("database", type=Path, nargs="?", default=Path("runs/mlflow.db"))
    parser.add_argument("--experiment", default="", help="default: the one with the newest run")
    parser.add_argument("--shots", type=Path, help="folder for screenshots, mlflow-<page>.png")
    parser.add_argument("--wait", type=float, default=120.0, help="seconds that a page may take")
    asked = parser.parse_args(arguments)
    settings.quiet_libraries()
    try:
        return look(asked)
    except Failed as fault:
        sys.stderr.write(f"pages: {fault}\n")
        return fault.code


def look(asked: argparse.Namespace) -> int:
    """Exit code: 1 if a page lacks something."""
    program = browser_program()
    if not asked.database.is_file():
        raise Failed(f"{asked.database}: no such database; run `sgcad study` or `sgcad evaluate` first", 2)
    pages = pages_of(asked.database.resolve(), asked.experiment)
    lacking = 0
    with served(asked.database.resolve()) as address, browsing(program) as browser:
        for page in pages:
            missing = browser.missing(address + page.path, page.words, asked.wait)
            lacking += bool(missing)
            said = f"lacks {', '.join(map(repr, missing))}" if missing else f"shows {', '.join(page.words)}"
            (sys.stderr if missing else sys.stdout).write(f"{page.name}: {said}\n")
            if asked.shots:
                asked.shots.mkdir(parents=True, exist_ok=True)
                browser.shot(asked.shots / f"mlflow-{page.name}.png")
    return int(lacking > 0)


if __name__ == "__main__":
    sys.exit(main())
