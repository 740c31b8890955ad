"""Batches in a Dask cluster of this machine: workers and starters are killed, and every case ends as elsewhere."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time

import psutil
import pytest

pytest.importorskip("prefect_dask", reason="pip install 'sg-cadvlm[dask]'")
WORDS = {f"c{n}": "SLOW" for n in range(5)} | {"last": "REFUSE"}
DEADLINE_S = 300


def start(config, cases, out, alone=False):
    """The command, as a process of its own group; `alone`: without Prefect."""
    code = "from flows.cli import main; main()"
    words = ["run", *map(str, cases.iterdir())] if alone else ["evaluate", str(cases), "--workers", "dask"]
    words += ["-c", str(config), "--out", str(out), "--jobs", "2"]
    with out.with_suffix(".log").open("a") as log:
        return subprocess.Popen(
            [sys.executable, "-c", code, *words], stdout=log, stderr=subprocess.STDOUT, start_new_session=True
        )


def finish(*given, **named):
    """The command's exit code."""
    return start(*given, **named).wait(DEADLINE_S)


def dask_workers(process):
    """Worker processes of a command's cluster."""
    children = psutil.Process(process.pid).children()
    return [child for child in children if any("spawn_main" in word for word in child.cmdline())]


def until(condition, process):
    """Wait for something while a process runs."""
    deadline = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.05)


def results(out):
    """result.json and metrics.json by case, without seconds."""
    found = {}
    for file in out.glob("kit/*/result.json"):
        told = {k: v for k, v in json.loads(file.read_text()).items() if k not in ("seconds", "shared", "steps")}
        metrics = file.with_name("metrics.json")
        found[file.parent.name] = told, metrics.read_bytes() if metrics.exists() else b""
    return found


@pytest.mark.slow
def test_a_worker_killed_costs_no_case_and_a_deadly_case_only_itself(reports, config_file, tmp_path):
    cases = reports(**WORDS, once=f"DIE ONCE {tmp_path / 'mark'}", deadly="DIE")
    config, killed, plain = config_file(), tmp_path / "killed", tmp_path / "plain"
    process = start(config, cases, killed)
    until(lambda: len(results(killed)) >= 1, process)
    victim = dask_workers(process)[0]
    victim.kill()
    assert process.wait(DEADLINE_S) == 1
    assert (tmp_path / "mark").exists()
    assert finish(config, cases, plain, alone=True) == 1
    together, alone = results(killed), results(plain)
    assert together == alone
    assert [name for name, (told, _) in alone.items() if told["status"] == "failed"] == ["deadly"]
    assert len(alone) == len(WORDS) + 2


@pytest.mark.slow
def test_what_a_killed_batch_had_finished_is_taken_from_the_store(reports, config_file, tmp_path):
    cases, config, out = reports(**WORDS), config_file(), tmp_path / "out"
    process = start(config, cases, out)
    until(lambda: len(list((out / ".store").glob("*"))) >= 2, process)
    os.killpg(process.pid, signal.SIGKILL)
    shutil.rmtree(out / "kit", ignore_errors=True)
    kept = {file.name: file.read_bytes() for file in (out / ".store").iterdir()}
    assert finish(config, cases, out) == 0
    assert len(results(out)) == len(WORDS)
    assert kept.items() <= {file.name: file.read_bytes() for file in (out / ".store").iterdir()}.items()
