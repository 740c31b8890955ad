"""Many drives in one run: killed and run again nothing finished is redone, and memory does not grow with them."""

import gc
import os
import signal
import subprocess
import sys
import time
import tracemalloc
from pathlib import Path

import pytest

from flows.drive import table
from flows.drive.run_drive import Order, drive_folders
from flows.drive.script_of_case import case_folders
from sgcad_core.config import driver_entry
from tests.flows.drive.test_drives import run, written
from tests.sgcad_core.handover.scenes import crossing

DRIVERS = [{"name": "aeb", "ttc_s": round(1.0 + 0.1 * k, 1)} for k in range(12)]


@pytest.fixture
def cases(tmp_path):
    for k in range(4):
        written(tmp_path / "runs" / "kit" / f"case-{k}", crossing(own=8.0 + 4 * k))
    return tmp_path / "runs"


def finished(folder):
    walked = os.walk(folder)  # unlike rglob it passes over folders that vanish while it looks
    found = (Path(root) / "drive.json" for root, _, files in walked if "drive.json" in files)
    return {f: f.stat().st_mtime_ns for f in found if f.exists()}


@pytest.mark.slow
def test_a_killed_run_goes_on_where_it_was(cases, tmp_path):
    listed = tmp_path / "drivers.yaml"
    listed.write_text("\n".join(f"- {{name: aeb, ttc_s: {d['ttc_s']}}}" for d in DRIVERS))
    command = [sys.executable, "-c", "from flows.cli import main; main()", "drive", str(cases), "-d", f"@{listed}"]
    first = subprocess.Popen([*command, "--no-pages"], start_new_session=True, stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + 240
    while len(finished(cases)) < 10 and time.monotonic() < deadline and first.poll() is None:
        time.sleep(0.02)
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    before = finished(cases)
    assert 10 <= len(before) < 4 * 2 * len(DRIVERS)
    again = subprocess.run([*command, "--no-pages"], capture_output=True, text=True, timeout=500)
    assert again.returncode == 0, again.stderr
    after = finished(cases)
    assert len(after) == 4 * 2 * len(DRIVERS)
    assert {f: after[f] for f in before} == before
    assert not list(cases.rglob(".*partial*"))


@pytest.mark.slow
def test_memory_does_not_grow_with_the_number_of_drives(cases):
    order = Order(tuple(driver_entry(d) for d in DRIVERS[:2]), pages=False, fresh=True)
    folders = case_folders([cases])
    tally = table.Tally()

    def held():
        for told in drive_folders(folders, order, 1):
            tally.add(told)
        gc.collect()  # what only waits for it is not held
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        first, second, third = held(), held(), held()
    finally:
        tracemalloc.stop()
    assert sum(r["n"] for r in tally.rows()) == 3 * 2 * 4 * 2
    assert third - second < 16 * 1024
    assert second - first < 400 * 1024  # caches


@pytest.mark.parametrize(
    ("text", "message"), [("{a: 1}", "no list of drivers"), ("[]", "no list of drivers"), (None, "cannot be read")]
)
def test_a_file_of_drivers_that_is_none_is_named(cases, tmp_path, text, message):
    file = tmp_path / "drivers.yaml"
    if text is not None:
        file.write_text(text)
    ended = run(cases, "-d", f"@{file}")
    assert ended.exit_code != 0
    assert message in str(ended.exception) + ended.output
