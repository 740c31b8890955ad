"""Whole studies with real parts: killed and resumed, they end as one that nobody disturbed."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
import yaml

from flows.batch import run_batch
from flows.study import run_study
from flows.study.plan import plan
from flows.study_file.spec import load_study

DEMO = Path(__file__).resolve().parents[3] / "docs" / "demo"
ARMS = [
    {"name": "defaults", "config": "template.yaml"},
    {"name": "slow", "config": "template.yaml", "set": ["road_writer.speed_limit_mph=25"]},
    {"name": "unread", "config": "template.yaml", "set": ["report_reader.robustness_level=total_sparsity"]},
]
DEADLINE_S = 300


@pytest.fixture
def study(tmp_path):
    """A study of three arms without a model; jsonl, so that lines can be counted."""
    arms = [arm | {"set": [*arm.get("set", []), "tracker=jsonl"]} for arm in ARMS]
    file = tmp_path / "resume.yaml"
    file.write_text(yaml.safe_dump({"title": "Resume", "reference": "defaults", "arms": arms, "cases": [str(DEMO)]}))
    return file


def start(study, out):
    """The command as a process of its own group."""
    code = "from flows.cli import main; main()"
    command = [sys.executable, "-c", code, "study", str(study), "--out", str(out), "--jobs", "2"]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )


def wait_until(condition, otherwise):
    """Look until something holds."""
    deadline = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline, otherwise
        time.sleep(0.02)


def alive(process):
    """Whether a process runs; a dead one may stay listed where nobody asks for its end."""
    try:
        return process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def figures(folder):
    """All numbers of a study, by file; without times, and without who happened to compute what is shared."""
    found = {}
    for file in sorted(folder.glob("*/*/*")):
        name = str(file.relative_to(folder))
        if file.name == "result.json":
            found[name] = {k: v for k, v in json.loads(file.read_text()).items() if k not in ("seconds", "shared")}
        elif file.name in ("metrics.json", "trajectories.csv", "road.net.xml", "road.xodr", "scenario.xosc", ".digest"):
            found[name] = file.read_bytes()
    return found


@pytest.mark.slow
def test_a_killed_study_goes_on_where_it_stopped_and_no_number_changes(study, tmp_path):
    whole = plan(load_study(study), tmp_path / "whole")
    run_batch.evaluate_alone(whole.batch, lambda *_: None, whole.jobs)

    folder = tmp_path / "killed" / "studies" / "resume"
    first = start(study, tmp_path / "killed")
    wait_until(lambda: list(folder.glob("*/*/result.json")) or first.poll() is not None, "no case was done")
    assert first.poll() is None, first.communicate()[0]
    orphans = psutil.Process(first.pid).children(recursive=True)
    os.kill(first.pid, signal.SIGKILL)
    first.communicate()
    wait_until(lambda: not any(alive(p) for p in orphans), "workers outlive their study")
    done = sorted(folder.glob("*/*/result.json"))
    before = {file: file.stat().st_mtime_ns for file in done}
    assert json.loads((folder / "study.json").read_text())["cases"]

    again = start(study, tmp_path / "killed")
    said, _ = again.communicate(timeout=DEADLINE_S)
    assert again.returncode == 0, said
    assert {file: file.stat().st_mtime_ns for file in done} == before
    assert figures(folder) == figures(whole.folder)
    assert len(figures(folder)) > 6 * 6
    lines = [json.loads(line) for line in (folder / "cases.jsonl").read_text().splitlines()]
    assert sorted((line["config"], line["result"]["case"]) for line in lines) == sorted(
        (job.config.name, job.case.id) for job in whole.jobs
    )
    assert not list(folder.glob("**/.partial-*"))


@pytest.mark.slow
def test_what_arms_share_is_computed_once(under_server, tmp_path, config_file, reports):
    config_file()
    file = tmp_path / "kits.yaml"
    arms = [{"name": f"k{n}", "config": "kit.yaml", "set": [f"seed={n}"]} for n in range(3)]
    file.write_text(yaml.safe_dump({"title": "Kits", "arms": arms}))
    made = plan(load_study(file), tmp_path / "out", cases=[reports(a="", b="REFUSE")], jobs=1)
    results = {}
    run_study.run(made, lambda job, ending, _: results.update({job.name: ending.result}))
    assert [results[f"k{n}/a"]["shared"] for n in range(3)] == [[], *[["read", "road", "scenario", "simulate"]] * 2]
    assert [results[f"k{n}/b"]["shared"] for n in range(3)] == [[], ["read", "road"], ["read", "road"]]
    assert {results[f"k{n}/b"]["status"] for n in range(3)} == {"refused"}
    shutil.rmtree(made.folder / ".stages")
    again = plan(load_study(file), tmp_path / "out", cases=[tmp_path / "cases"], jobs=1)
    assert all(again.batch.reusable(job) for job in again.jobs), "finished cases need no shelf"


def test_a_fresh_study_forgets_what_was_shared(tmp_path, config_file, reports, monkeypatch):
    config_file()
    file = tmp_path / "kits.yaml"
    file.write_text(yaml.safe_dump({"title": "Kits", "arms": [{"name": "one", "config": "kit.yaml"}]}))
    cases = [reports(a="")]
    for fresh, left in ((False, True), (True, False)):
        made = plan(load_study(file), tmp_path / "out", cases=cases, fresh=fresh)
        old = made.batch.shelf / "ab" / "abc"
        old.parent.mkdir(parents=True, exist_ok=True)
        old.write_bytes(b"old")
        monkeypatch.setattr(
            "flows.batch.run_batch.evaluate", lambda batch, on_ending, jobs, on_step: None
        )  # no server for this
        run_study.run(made, print)
        assert old.exists() is left
