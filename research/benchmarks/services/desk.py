"""How long a person waits for the desk: `python -m research.benchmarks.services.desk [--cases 1000 10000] [--edits 3]`.

Lists: the results of the bundled reports, copied under other names; the first look reads every result.json, later ones
only what changed. Times are those of a request over the application itself, without a network: median and worst of ten.
Edits: the bundled reports' own, each from the request to the page that shows its picture, after the desk's own warm-up;
each is taken back again. Wall seconds of this machine as it is; `load` says how busy it was.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from starlette.testclient import TestClient

from flows.batch.config_folder import write
from flows.batch.plan_batch import batch_of
from flows.case.run_case import run_case
from flows.case_files.find_cases import cases_in
from flows.desk.app import application
from sgcad_core import settings
from sgcad_core.asking.refine import run_at_once

EDITS = {
    "left-turn-at-signal": [{"roads.N.lanes_forward": 2}, {"vehicles.V1.speed_mph": 15}, {"conditions.surface": "wet"}],
    "rear-end-on-arterial": [{"vehicles.V2.speed_mph": 30}, {"vehicles.V1.kind": "van"}, {"conditions.light": "day"}],
    "across-the-centerline": [{"vehicles.V1.speed_mph": 40}, {"conditions.weather": "rain"},
                              {"vehicles.V2.kind": "suv"}],
}  # fmt: skip
LOOKS = 10
LISTS = ("/", "/?sort=confidence", "/?flag=lacking", "/?text=left", "/?page=5&sort=case")


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(prog="research.benchmarks.services.desk", description=__doc__)
    parser.add_argument("--cases", type=int, nargs="*", default=[1000, 10000])
    parser.add_argument("--edits", type=int, default=3, help="edits a report")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="sgcad-desk-") as folder:
        made = demo_runs(Path(folder))
        say(f"load {os.getloadavg()[0]:.1f} on {len(os.sched_getaffinity(0))} cores")
        say("cases   first look s   list, median s   list, worst s")
        for count in asked.cases:
            first, looks = listing_seconds(made, Path(folder) / f"list-{count}", count)
            say(f"{count:5}   {first:12.2f}   {statistics.median(looks):14.3f}   {max(looks):13.3f}")
        say("report                   edit                                   s to the picture")
        for case, edit, seconds in edit_seconds(made, asked.edits):
            say(f"{case:24} {json.dumps(edit):38} {seconds:.2f}")


def say(line: str) -> None:
    """A line at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def demo_runs(folder: Path) -> Path:
    """Results of the bundled reports under the template config, with reports of their own beside them."""
    shutil.copytree(settings.ROOT / "docs" / "demo", folder / "reports")
    configs = [settings.CONFIGS / "template.yaml"]
    batch = batch_of(cases_in([folder / "reports"]), configs, folder / "runs", ["tracker=none"])
    for job in batch.plan():
        write(batch.out / job.config.name, job.config)
        run_case(job.config, job.case, batch.out, job.digest, run_at_once)
    return batch.out


@contextmanager
def served(runs: Path) -> Iterator[TestClient]:
    """The desk over a folder, without a network."""
    with TestClient(application(runs), base_url="http://localhost") as client:
        yield client


# ------------------------------------------------------------------ lists
def listing_seconds(runs: Path, folder: Path, count: int) -> tuple[float, list[float]]:
    """Seconds until so many cases are all in the list, and of every look after that."""
    results = [file.read_bytes() for file in sorted(runs.glob("*/*/result.json"))]
    for k in range(count):
        place = folder / "kit" / f"case-{k:05d}"
        place.mkdir(parents=True)
        (place / "result.json").write_bytes(results[k % len(results)])
    with served(folder) as client:
        started = time.perf_counter()
        while f"{count} cases" not in client.get("/").text:
            time.sleep(0.02)
        first = time.perf_counter() - started
        return first, [look(client, LISTS[k % len(LISTS)]) for k in range(LOOKS)]


def look(client: TestClient, place: str) -> float:
    """Seconds of one page, the folder looked through anew."""
    time.sleep(0.4)  # longer than the index trusts its last look
    started = time.perf_counter()
    client.get(place).raise_for_status()
    return time.perf_counter() - started


# ------------------------------------------------------------------ edits
def edit_seconds(runs: Path, most: int) -> Iterator[tuple[str, dict[str, Any], float]]:
    """(case, edit, seconds from the request to the page with the new player)."""
    with served(runs) as client:
        for file in sorted(runs.glob("*/*/result.json")):
            key = f"{file.parent.parent.name}/{file.parent.name}"
            client.get(f"/case/{key}")
            change(client, "rerun", key, {})  # waits in line behind the warm-up
            for edit in EDITS[file.parent.name][:most]:
                started = time.perf_counter()
                change(client, "edit", key, edit)
                client.get(f"/case/{key}").raise_for_status()
                client.get(f"/player/{key}").raise_for_status()
                yield file.parent.name, edit, time.perf_counter() - started
                change(client, "undo", key, {})


def change(client: TestClient, kind: str, key: str, edits: dict[str, Any]) -> None:
    """What the page's script does. Raises HTTPStatusError where the change is refused."""
    text = client.get(f"/case/{key}").text
    token, version, stamp = (_found(text, name) for name in ('desk-token" content="', 'data-version="', 'data-stamp="'))
    asked = {"version": version, "stamp": stamp, "edits": edits}
    answer = client.post(f"/{kind}/{key}", json=asked, headers={"x-desk-token": token})
    if answer.is_error:
        say(f"{key}: {answer.text}")
    answer.raise_for_status()


def _found(text: str, before: str) -> str:
    found = re.search(re.escape(before) + r"(\w*)", text)
    return found[1] if found else ""


if __name__ == "__main__":
    main()
