"""A study on two hosts, one of which loses its power and one its network, ends as on one machine.

    sudo make test-hosts            # or: python -m tests.hosts.run [--cases 9] [--keep FOLDER]

Real parts throughout: PostgreSQL, Prefect's server, MLflow's server, object storage and Dask's scheduler on a hub, two
Dask workers, every one in a network namespace of its own. Leaves with code 0 where it cannot run, saying why.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

import httpx

from tests.hosts import services
from tests.hosts.network import Network, missing
from tests.hosts.services import API, BUCKET, COMMON, MLFLOW, ROOT, SCHEDULER, until

STUDY = """title: Two hosts
arms:
  - {name: plain, config: template.yaml}
  - {name: patient, config: template.yaml, set: ["max_attempts=3"]}
"""
ADDRESS = f"s3://{BUCKET}/two_hosts"
ADDRESSES = {"a": "10.77.0.2", "b": "10.77.0.3"}
CASE_S = 600.0
"""Longest wait for any step; the machine may be busy."""


def main() -> None:
    """Run or skip."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=9)
    parser.add_argument("--keep", type=Path, help="a new folder for logs and results, kept afterwards")
    options = parser.parse_args()
    if reason := missing():
        say(f"skipped: {reason}")
        return
    folder = options.keep.resolve() if options.keep else Path(tempfile.mkdtemp(prefix="sgcad-hosts-"))
    folder.mkdir(parents=True, exist_ok=True)
    folder.chmod(0o755)  # PostgreSQL runs as another user
    try:
        with Network(folder) as net:
            Trial(net, options.cases).go()
    except BaseException:
        say(f"logs: {folder}")
        raise
    if not options.keep:
        shutil.rmtree(folder)


class Trial:
    """The study's way, step by step; every step says what it saw."""

    def __init__(self, net: Network, cases: int) -> None:
        self.net, self.cases = net, cases
        self.started = time.monotonic()
        self.study = net.folder / "two_hosts.yaml"
        self.reports = net.folder / "cases"
        self.alone, self.together = net.folder / "alone", net.folder / "together"

    def go(self) -> None:
        """Everything, and the comparison at the end."""
        self._write_study()
        subprocess.run(self._command(self.alone, "--set", "tracker=none"), check=True, cwd=ROOT, **self._log("alone"))
        self.say(f"one machine: {len(contents(self.alone))} results")
        services_up = time.monotonic()
        enter(self.net)
        services.serve(self.net)
        self.say(f"PostgreSQL, Prefect, MLflow, storage, Dask in {time.monotonic() - services_up:.0f} s")
        workers = {host: services.worker(self.net, host) for host in self.net.workers}
        until("both workers", lambda: len(at_work()) == 2, CASE_S)
        begun = time.monotonic()
        tracker = [f"tracker={{name: mlflow, uri: '{MLFLOW}', experiment: study/{self.study.stem}}}"]
        words = [word for value in tracker for word in ("--set", value)]
        starter = self.net.start(
            "hub", self._command(self.together, *words, "--workers", SCHEDULER, "--store", ADDRESS), COMMON
        )
        self.say("two workers are there, the study is started")
        self._trouble(workers)
        until("the study's end", lambda: starter.poll() is not None, CASE_S)
        assert starter.returncode == 0, "the starter failed; see its log"
        self.say(f"the study took {time.monotonic() - begun:.0f} s")
        self._compare()

    def _command(self, out: Path, *words: str) -> list[str]:
        main = [sys.executable, "-m", "flows.cli", "study", str(self.study), "--cases", str(self.reports)]
        return [*main, "--out", str(out), *words]

    def _log(self, name: str) -> dict[str, Any]:
        return {"stdout": (self.net.folder / f"{name}.log").open("wb"), "stderr": subprocess.STDOUT}

    def _write_study(self) -> None:
        self.study.write_text(STUDY)
        demo = sorted(p for p in (ROOT / "docs" / "demo").iterdir() if p.is_dir())
        for number in range(self.cases):
            shutil.copytree(demo[number % len(demo)], self.reports / f"{number:02d}-{demo[number % len(demo)].name}")

    def _trouble(self, workers: dict[str, subprocess.Popen[bytes]]) -> None:
        """Cut b off in the middle of a case, kill a in the middle of one, let both come back."""
        self._in_the_middle("b", 2)
        self.net.cut("b")
        self.say(f"b loses its network in the middle of a case, {self._done()} cases done")
        self._in_the_middle("a", self._done() + 2)
        self.net.kill(workers["a"])
        self.say(f"a's host is killed (-9) in the middle of a case, {self._done()} cases done")
        until("both given up", lambda: at_work() == {}, CASE_S)
        self.say("Dask's scheduler has given both up")
        services.worker(self.net, "a")
        before = self._done()
        until("a case of the new worker", lambda: self._done() > before, CASE_S)
        self.net.mend("b")
        self.say(f"a is back and at work, b's cable is in again, {self._done()} cases done")
        until("b at work", lambda: ADDRESSES["b"] in at_work() or self._done() == 2 * self.cases, CASE_S)
        self.say(f"b is back, {self._done()} cases done")

    def _in_the_middle(self, host: str, done: int) -> None:
        """Wait until so many cases have come home and a host is at another one."""
        until(
            f"{host} in the middle of a case", lambda: self._done() >= done and at_work().get(ADDRESSES[host]), CASE_S
        )

    def _done(self) -> int:
        return len(contents(self.together))

    def _compare(self) -> None:
        alone, together = contents(self.alone), contents(self.together)
        assert len(alone) == 2 * self.cases
        assert together == alone, "results differ from the single machine's"
        logged = mlflow_cases()
        assert logged == dict.fromkeys(alone, 1), f"MLflow has {logged}"
        self.say(f"{len(together)} results equal the single machine's, byte by byte apart from seconds and steps")
        self.say(f"MLflow has each once; flow runs: {dict(states())}, cases in Prefect: {dict(case_states())}")

    def say(self, line: str) -> None:
        """A line with the time since the start."""
        say(f"{time.monotonic() - self.started:6.0f} s  {line}")


# ------------------------------------------------------------------ looking at the hub
def enter(net: Network) -> None:
    """Move this process to the hub, to see what the hosts see."""
    import ctypes
    import os

    handle = os.open(f"/run/netns/{net.space('hub')}", os.O_RDONLY)
    if ctypes.CDLL(None, use_errno=True).setns(handle, 0x40000000):  # CLONE_NEWNET
        raise OSError(ctypes.get_errno(), "setns")
    os.close(handle)
    os.environ.update({k: v for k, v in COMMON.items() if k != "PWD"})


def at_work() -> dict[str, int]:
    """How many cases each worker that Dask's scheduler knows is at, by the worker's address."""
    from distributed import Client

    with Client(SCHEDULER, timeout="30s", set_as_default=False) as client:
        known = client.scheduler_info(n_workers=-1)["workers"]
        busy = client.processing()
    return {address.split("/")[-1].split(":")[0]: len(busy.get(address, ())) for address in known}


def states() -> Counter[str]:
    """States of flow runs, as the server has them."""
    return Counter(run["state_type"] for run in ask(f"{API}/flow_runs/filter", {"limit": 200}))


def case_states() -> Counter[str]:
    """States of the cases' task runs."""
    body = {"limit": 200, "task_runs": {"name": {"like_": "/"}}}
    found = ask(f"{API}/task_runs/filter", body)
    return Counter(run["state_name"] for run in found if not run["name"].startswith("track "))


def mlflow_cases() -> Counter[tuple[str, str]]:
    """How many finished runs MLflow has of each case of each arm."""
    listed = ask(f"{MLFLOW}/api/2.0/mlflow/experiments/search", {"max_results": 100})["experiments"]
    ids = [e["experiment_id"] for e in listed if e["name"].startswith("study/")]
    runs = ask(f"{MLFLOW}/api/2.0/mlflow/runs/search", {"experiment_ids": ids, "max_results": 1000})["runs"]
    named = Counter()
    for run in runs:
        tags = {tag["key"]: tag["value"] for tag in run["data"].get("tags", [])}
        if "mlflow.parentRunId" in tags:
            named[tags["sgcad.config"], tags["mlflow.runName"]] += run["info"]["status"] == "FINISHED"
    return named


def ask(address: str, body: dict[str, Any]) -> Any:
    """A JSON answer to a JSON question."""
    return httpx.post(address, json=body, timeout=60).raise_for_status().json()


def contents(out: Path) -> dict[tuple[str, str], Any]:
    """result.json and metrics.json of every case; without seconds, and without which arm shared whose step."""
    found = {}
    for file in sorted(out.glob("studies/*/*/*/result.json")):
        result = {k: v for k, v in json.loads(file.read_text()).items() if k not in ("seconds", "shared", "steps")}
        metrics = file.with_name("metrics.json")
        bytes_of = json.dumps(result).encode(), metrics.read_bytes() if metrics.exists() else b""
        found[file.parent.parent.name, file.parent.name] = bytes_of
    return found


def say(line: str) -> None:
    """A line on stdout, at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
