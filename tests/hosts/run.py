"""A study on two hosts, one of which loses its network and one its power, ends as on one machine.

    sudo make test-hosts            # or: python -m tests.hosts.run [--cases 9] [--keep FOLDER]

Real parts throughout: PostgreSQL, Prefect's server, MLflow's server and object storage on a hub, two Prefect
workers, every one in a network namespace of its own. Leaves with code 0 where it cannot run, saying why.
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
from tests.hosts.coordinate import SHARDS
from tests.hosts.network import Network, missing
from tests.hosts.services import API, BUCKET, COMMON, MLFLOW, ROOT, python, until

STUDY = """title: Two hosts
arms:
  - {name: plain, config: template.yaml}
  - {name: patient, config: template.yaml, set: ["max_attempts=3"]}
"""
ADDRESS = f"s3://{BUCKET}/two_hosts"
CASE_S = 900.0
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
        self.net, self.cases = net, max(SHARDS, cases // SHARDS * SHARDS)
        self.size = 2 * self.cases // SHARDS
        self.started = time.monotonic()
        self.study = net.folder / "two_hosts.yaml"
        self.reports = net.folder / "cases"

    def go(self) -> None:
        """Everything, and the comparison at the end."""
        self._write_study()
        self._alone()
        services_up = time.monotonic()
        enter(self.net)
        services.serve(self.net)
        deploy()
        self.say(f"PostgreSQL, Prefect, MLflow, storage in {time.monotonic() - services_up:.0f} s")
        workers = {host: services.worker(self.net, host) for host in self.net.workers}
        out = self.net.folder / "together"
        words = [str(self.study), str(self.reports), str(out), ADDRESS]
        coordinator = self.net.start("hub", python("tests.hosts.coordinate", *words), COMMON)
        self._trouble(workers)
        until("the study's end", lambda: coordinator.poll() is not None, CASE_S)
        assert coordinator.returncode == 0, "the coordinator failed; see its log"
        self._compare(out)

    def _write_study(self) -> None:
        self.study.write_text(STUDY)
        demo = sorted(p for p in (ROOT / "docs" / "demo").iterdir() if p.is_dir())
        for number in range(self.cases):
            shutil.copytree(demo[number % len(demo)], self.reports / f"{number:02d}-{demo[number % len(demo)].name}")

    def _alone(self) -> None:
        """The same study on one machine, without any of this."""
        words = [str(self.study), "--cases", str(self.reports), "--out", str(self.net.folder / "alone")]
        main = [sys.executable, "-c", "from flows.cli import main; main()"]
        command = [*main, "study", *words, "--set", "tracker=none"]
        with (self.net.folder / "alone.log").open("wb") as log:
            subprocess.run(command, check=True, cwd=ROOT, stdout=log, stderr=subprocess.STDOUT)
        self.say(f"one machine: {len(contents(self.net.folder / 'alone'))} results")

    def _trouble(self, workers: dict[str, subprocess.Popen[bytes]]) -> None:
        """Cut b off in the middle of a shard, kill a in the middle of one, let both come back."""
        run_b = self._in_the_middle("b")
        self.net.cut("b")
        self.say(f"b is cut off in the middle of flow run {run_b[:8]}, {len(marks())} cases done")
        run_a = self._in_the_middle("a")
        self.net.kill(workers["a"])
        self.say(f"a is killed in the middle of flow run {run_a[:8]}, {len(marks())} cases done")
        until("both runs given up", lambda: states({run_a, run_b}) == {"CRASHED": 2}, CASE_S)
        self.say("both flow runs were given up and their shards submitted again")
        services.worker(self.net, "a")
        until("a case of the new worker", lambda: any(m["run"] not in {run_a, run_b} for m in marks().values()), CASE_S)
        self.net.mend("b")
        self.say(f"a is back and at work, b's cable is in again, {len(marks())} cases done")

    def _in_the_middle(self, host: str) -> str:
        """Wait until a host has done something of a shard and at most half of it; the flow run."""
        found: list[str] = []

        def middle() -> bool:
            held = [lease for lease in read_all(f"{ADDRESS}/leases").values() if lease["host"] == host]
            done = Counter(mark["run"] for mark in marks().values())
            found.extend(lease["run"] for lease in held if 0 < done[lease["run"]] <= self.size // 2)
            return bool(found)

        until(f"{host} in the middle of a shard", middle, CASE_S)
        return found[0]

    def _compare(self, out: Path) -> None:
        alone, together = contents(self.net.folder / "alone"), contents(out)
        assert len(alone) == 2 * self.cases
        assert together == alone, "results differ from the single machine's"
        done = marks()
        assert len(done) == len(alone)
        objects = len(storage().find(f"{BUCKET}/two_hosts/results"))
        hosts = Counter(mark["host"] for mark in done.values())
        logged = mlflow_cases()
        assert logged == dict.fromkeys(alone, 1), f"MLflow has {logged}"
        until("no flow run still at work", lambda: not (states() & Counter(("RUNNING", "PENDING"))), CASE_S)
        self.say(
            f"{len(done)} results equal the single machine's, byte by byte apart from seconds; by host {dict(hosts)}"
        )
        self.say(f"{objects - len(done)} of them were done twice, one result of each was kept; MLflow has each once")
        self.say(f"flow runs: {dict(states())}")

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


def deploy() -> None:
    """The pool, and the deployments of deploy/prefect.yaml."""
    for words in (["work-pool", "create", services.POOL, "--type", "process"],
                  ["deploy", "-n", "shard", "--prefect-file", str(ROOT / "deploy" / "prefect.yaml")]):  # fmt: skip
        done = subprocess.run(python("prefect", "--no-prompt", *words), cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr


def storage() -> Any:
    """The object storage, never from a cache."""
    import s3fs

    found = s3fs.S3FileSystem(use_listings_cache=False)
    found.invalidate_cache()
    return found


def read_all(prefix: str) -> dict[str, Any]:
    """Every JSON object below a prefix."""
    fs, found = storage(), {}
    for name in fs.find(prefix):
        try:
            found[name] = json.loads(fs.cat_file(name))
        except (ValueError, FileNotFoundError):
            continue
    return found


def marks() -> dict[str, Any]:
    """All marks of finished cases."""
    return read_all(f"{ADDRESS}/done")


def states(runs: set[str] | None = None) -> Counter[str]:
    """States of flow runs, of all or some, as the server has them."""
    found = ask(f"{API}/flow_runs/filter", {"limit": 200})
    return Counter(run["state_type"] for run in found if runs is None or run["id"] in runs)


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
    """result.json and metrics.json of every case; without seconds, and without which arm shared whose stage."""
    found = {}
    for file in sorted(out.glob("studies/*/*/*/result.json")):
        result = {k: v for k, v in json.loads(file.read_text()).items() if k not in ("seconds", "shared")}
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
