"""The inbox under fire: `python -m research.benchmarks.services.inbox [--reports 1000] [--workers 2] [--kills 3]`.

Drops small reports all at once, lets workers at them, each a real flow run in a process of its own on one Prefect
server, ends some with kill -9 at even intervals and starts another in their place, as a worker or the next schedule
does. Then counts, from what lies on disk: every report must have one ledger entry, one result folder and one place
under done/, and none may have been tracked twice. Ends with 1 if that is not so.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from sgcad_core import settings

LIMIT_S = 4 * 3600.0
TEXT = (
    "The crash occurred on a two-lane, undivided road with a speed limit of {limit} mph, in daylight. Vehicle #1, a "
    "passenger car, was traveling north behind Vehicle #2. Vehicle #2 was stopped. Vehicle #1 struck the back of "
    "Vehicle #2 with its front. This is report {number}.\n"
)


class Counted(NamedTuple):
    """What lies on disk at the end."""

    done: int
    ledger: int
    results: int
    tracked_twice: int
    claims: int
    left: int


def drop(count: int, inbox: Path) -> None:
    """Reports of different content, all at once."""
    inbox.mkdir(parents=True)
    for number in range(count):
        (inbox / f"report-{number:05d}.txt").write_text(TEXT.format(limit=25 + 5 * (number % 8), number=number))


def start(inbox: Path, out: Path, portion: int) -> subprocess.Popen[bytes]:
    """One worker: a flow run in a process of its own."""
    command = [sys.executable, "-m", "flows.deploy.inbox.inbox", str(inbox), "--out", str(out), "--jobs", "1"]
    command += ["--settle-s", "0", "--wait-s", "60", "--lease-s", "60", "--portion", str(portion)]
    command += ["--config", str(out.parent / "least.yaml")]
    log = (out.parent / "worker.log").open("ab")
    return subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True)  # noqa: S603 - our own module


def config(folder: Path) -> None:
    """What is measured is the inbox: the cheapest chain that writes every file, and a tracker with a line a case."""
    import yaml

    raw = yaml.safe_load((settings.CONFIGS / "template.yaml").read_text())
    raw |= {"simulator": "kinematic", "validators": [], "tracker": {"name": "jsonl"}}
    (folder / "least.yaml").write_text(yaml.safe_dump(raw))


def run(folder: Path, workers: int, kills: int, portion: int) -> int:
    """Work the inbox off, killing on the way; how many were killed in the midst of work."""
    inbox, out = folder / "inbox", folder / "out"
    total = len(list(inbox.glob("*.txt")))
    marks = [total * (k + 1) // (kills + 1) for k in range(kills)]
    runner = [start(inbox, out, portion) for _ in range(workers)]
    killed, deadline = 0, time.monotonic() + LIMIT_S
    while any(w.poll() is None for w in runner) and time.monotonic() < deadline:
        if killed < kills and len(list((inbox / "done").glob("*"))) >= marks[killed]:
            victim = runner.pop(0)
            os.kill(victim.pid, signal.SIGKILL)
            victim.wait()
            killed += 1
            runner.append(start(inbox, out, portion))
        time.sleep(0.05)
    return killed


def count(folder: Path) -> Counted:
    """Look at the disk."""
    inbox, out = folder / "inbox", folder / "out"
    lines = [line for log in out.rglob("*.jsonl") for line in log.read_text().splitlines()]
    cases = Counter(json.loads(line)["result"]["case"] for line in lines)
    return Counted(
        done=len(list(inbox.glob("done/*/*.txt"))),
        ledger=len(list(inbox.glob(".inbox/ledger/*.json"))),
        results=len(list(out.glob("least/*/result.json"))),
        tracked_twice=sum(n > 1 for n in cases.values()),
        claims=len(list(inbox.glob(".inbox/claims/*"))),
        left=len(list(inbox.glob("*.txt"))),
    )


def main() -> None:
    """Print the figures as a Markdown table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, value in (("reports", 1000), ("workers", 2), ("kills", 3), ("portion", 48)):
        parser.add_argument(f"--{name}", type=int, default=value)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="inbox-") as place:
        folder = Path(place)
        config(folder)
        drop(asked.reports, folder / "inbox")
        os.environ["PREFECT_HOME"] = str(folder / "prefect")
        settings.quiet_libraries()
        from flows.server import Server

        server = Server()
        settings.use_prefect_url(server.address)
        server.wait()
        started = time.perf_counter()
        killed = run(folder, asked.workers, asked.kills, asked.portion)
        wall = time.perf_counter() - started
        server.stop()
        counted = count(folder)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = (spent.ru_utime + spent.ru_stime) / asked.reports
        sys.stdout.write(
            "| reports | workers | killed | done | results | ledger | tracked twice | left | claims left |\n"
        )
        sys.stdout.write("|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n")
        figures = (asked.reports, asked.workers, killed, counted.done, counted.results, counted.ledger)
        figures += (counted.tracked_twice, counted.left, counted.claims)
        sys.stdout.write(f"| {' | '.join(map(str, figures))} |\n")
        sys.stdout.write(f"\n{wall:.0f} s; {cpu:.2f} s of processor time a report, Prefect's server included\n")
        whole = counted == Counted(*[asked.reports] * 3, 0, 0, 0) and killed == asked.kills
        sys.stdout.write("" if whole else (folder / "worker.log").read_text()[-4000:])
    sys.exit(0 if whole else 1)


if __name__ == "__main__":
    main()
