"""Faults on purpose: a small campaign, and that its comparison notices what it is for."""

import json
import random

import pytest

from research.benchmarks.faults import alike
from research.benchmarks.faults.__main__ import Kept, kills, tables
from research.benchmarks.faults.disasters import Happened
from research.benchmarks.faults.kills import Trial, trial, undisturbed
from research.benchmarks.faults.places import Place
from research.benchmarks.faults.targets import TARGETS


@pytest.mark.slow
def test_what_is_killed_three_times_is_finished_the_next_time(tmp_path):
    peace = undisturbed(TARGETS["index"], tmp_path / "peace")
    for number in range(3):
        told = trial(peace, tmp_path / f"kill-{number}", random.Random(number))
        assert told.faults == ()


def test_only_times_and_the_place_are_left_out_of_a_comparison(tmp_path):
    for name, seconds, status in (("a", 1.5, "x"), ("b", 2.5, "x"), ("c", 1.5, "y")):
        (folder := tmp_path / name / "out").mkdir(parents=True)
        times = f'"seconds": {{"road": {seconds}}}, "shared": ["{name}"], "began_s": {seconds}, "ended_s": 1e9'
        told = f'{{{times}, "status": "{status}", "at": "{tmp_path / name}"}}'
        (folder / "result.json").write_text(told)
    (tmp_path / "c" / "out" / "more").write_text("")
    assert alike.differences(tmp_path / "a", tmp_path / "b", "out") == []
    assert alike.differences(tmp_path / "a", tmp_path / "c", "out") == ["more is there once", "result.json differs"]


def test_a_process_that_stays_is_named_and_ended(tmp_path):
    place = Place(tmp_path / "place")
    process = place.start(["-c", "import time; time.sleep(600)"])
    assert "time.sleep(600)" in place.wait_for_all(1.0)[0]
    assert process.wait(10) == -9
    assert place.alive() == []


def test_the_table_counts_what_was_hit_and_what_went_wrong():
    told = [
        Trial("index", 1.0, "command", ()),
        Trial("index", 1.0, "netconvert", ("left",)),
        Trial("index", 9.0, "nothing", ()),
    ]
    assert "| index | 1 | 1 | 1 | 1 |" in tables(told, ())


def test_what_is_kept_is_not_tried_again(tmp_path):
    kept = Kept(tmp_path / "kept", 2)
    killed, struck = Trial("index", 1.5, "command", ("left",)), Happened("disk", "exit 1", ())
    kept.add("0 index", killed)
    kept.add("disk", struck)
    assert kills(["index"], range(1), kept, tmp_path / "nowhere") == [killed]
    assert kept.of(Happened) == {"disk": struck}
    assert Kept(tmp_path / "kept", 3).of(Trial) == {}
    assert not (tmp_path / "nowhere").exists()


def test_a_case_that_names_no_run_is_told(tmp_path):
    for name, said in (("a", {"mlflow": "/#/experiments/1/runs/1"}), ("b", {"prefect": "/runs/flow-run/1"})):
        (tmp_path / name).mkdir()
        (tmp_path / name / "result.json").write_text("{}")
        (tmp_path / name / "links.json").write_text(json.dumps(said))
    assert alike.unlinked(tmp_path) == ["b has no link to MLflow"]
