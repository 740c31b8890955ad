"""Shared stages: the same is computed once, another is never taken for it, and the folder is only a cache."""

import hashlib
import pickle
import signal
import subprocess
import sys
import threading
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flows.batch.plan_batch import JobRunner, batch_of
from flows.case_files.find_cases import cases_in
from flows.case_files.record_json import pack
from flows.case_files.stage_cache import Shelf, content_of, keys_of
from sgcad_core.case.records import CrashReport, Diagram, Trajectory
from sgcad_core.config import load

ANSWERS = [{"attempt": 1, "answer": "no"}, {"attempt": 2, "answer": "no"}, {"attempt": 3, "answer": "ok"}]
REPORT = CrashReport(case="c", narrative="V1 struck V2.")
ASKING = {"road_writer": "testkit_asking", "decoder": "greedy", "backbone": {"name": "scripted", "answers": ANSWERS}}


@pytest.fixture
def work(tmp_path, reports):
    """Works off configs over one report; results by config, and the attempts that were made."""
    cases = cases_in([reports(a="")])

    def run(*files, shelf=True, out="out"):
        batch = replace(batch_of(cases, files, tmp_path / out, jobs=2), shelf=tmp_path / "shelf" if shelf else None)
        plan, runner, names = batch.plan(), JobRunner(batch), []

        def note(name, turn):
            names.append(name)
            return turn()

        runner.begin(plan)
        try:
            return {job.config.name: runner.finish(job, note).result for job in plan}, names
        finally:
            runner.close()

    return run


def plain(result):
    """A result without what tells one arm or one run from another."""
    return {k: v for k, v in result.items() if k not in ("config", "seconds", "shared")}


def test_fewer_attempts_are_the_first_of_many(work, config_file):
    arms = [config_file(f"max{n}", **ASKING, max_attempts=n) for n in (1, 2, 3, 10)]
    shared, asked = work(*arms)
    alone, asked_alone = work(*arms, shelf=False, out="alone")
    assert {name: plain(r) for name, r in shared.items()} == {name: plain(r) for name, r in alone.items()}
    assert [r["status"] for r in shared.values()] == ["exhausted", "exhausted", "generated", "generated"]
    assert [n for n in asked if n.startswith("road")] == ["road[1]", "road[2]", "road[3]"]
    assert len([n for n in asked_alone if n.startswith("road")]) == 9


def test_longer_refinement_first_serves_the_shorter_ones(work, config_file):
    arms = [config_file(f"max{n}", **ASKING, max_attempts=n) for n in (10, 2)]
    shared, asked = work(*arms)
    assert asked == ["road[1]", "road[2]", "road[3]", "scenario[1]"]
    assert shared["max2"]["status"] == "exhausted"
    assert shared["max2"]["attempts"] == {"road": 2, "scenario": 0}
    assert shared["max2"]["shared"] == ["read", "road"]


def test_a_shared_stage_keeps_the_time_it_took(work, config_file):
    arms = [config_file(name, **ASKING) for name in ("one", "two")]
    shared, _ = work(*arms)
    assert shared["one"]["shared"] == []
    assert shared["two"]["shared"] == ["read", "road", "scenario", "simulate"]
    for step in shared["two"]["shared"]:
        assert shared["two"]["seconds"][step] == shared["one"]["seconds"][step]


def test_without_a_shelf_nothing_is_said_of_sharing(work, config_file):
    alone, _ = work(config_file(**ASKING), shelf=False)
    assert "shared" not in alone["kit"]


def test_a_damaged_shelf_changes_nothing(work, config_file, tmp_path):
    one, _ = work(config_file("one", **ASKING))
    for file in (tmp_path / "shelf").rglob("*"):
        if file.is_file():
            file.write_bytes(file.read_bytes()[:-7])
    two, asked = work(config_file("two", **ASKING))
    assert plain(one["one"]) == plain(two["two"])
    assert two["two"]["shared"] == []
    assert len(asked) == 4


@pytest.mark.parametrize(
    ("changes", "same"),
    [
        ({"max_attempts": 3}, {"read", "road", "scenario", "simulate"}),
        ({"tracker": "jsonl"}, {"read", "road", "scenario", "simulate"}),
        ({"retriever": {"name": "lancedb"}}, {"read", "road", "scenario", "simulate"}),  # passages count by content
        ({"seed": 7}, {"read", "scenario", "simulate"}),
        ({"show_findings": False}, {"read", "scenario", "simulate"}),
        ({"decoder": "nucleus"}, {"read", "scenario", "simulate"}),
        ({"backbone": {"name": "scripted", "answers": ["ok"]}}, {"read", "scenario", "simulate"}),
        ({"validators": []}, {"read", "scenario", "simulate"}),
        ({"validators": ["testkit", "openscenario"]}, {"read", "road", "simulate"}),
        ({"road_writer": "testkit"}, {"read", "scenario", "simulate"}),
        ({"scenario_writer": "rules"}, {"read", "road", "simulate"}),
        ({"simulator": {"name": "testkit", "fails": True}}, {"read", "road", "scenario"}),
        ({"report_reader": {"name": "auto", "use_diagrams": False}}, {"road", "scenario", "simulate"}),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)  # fmt: skip
def test_a_step_is_the_same_if_what_it_depends_on_is(config_file, changes, same):
    before = keys_of(load(config_file("one", **ASKING)))
    after = keys_of(load(config_file("two", **(ASKING | changes))))
    unchanged = {step for step in vars(before) if getattr(before, step) == getattr(after, step)}
    assert unchanged == same | {"opinion"}, "nobody is asked for one"


@pytest.mark.parametrize(
    ("changes", "same"),
    [({"seed": 7}, False), ({"decoder": "nucleus"}, False), ({"scenario_writer": "rules"}, True)],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_a_second_opinion_is_another_with_another_model_or_seed(config_file, changes, same):
    seconded = ASKING | {"second_opinion": "mini_gist"}
    before, after = (keys_of(load(config_file(n, **(seconded | c)))) for n, c in (("one", {}), ("two", changes)))
    assert (before.opinion == after.opinion) is same
    assert before.opinion != keys_of(load(config_file("three", **ASKING))).opinion


def test_a_plugins_new_version_is_another_step(config_file, testkit, monkeypatch):
    before = keys_of(load(config_file("one", **ASKING)))
    monkeypatch.setattr(sys.modules["sgcad_testkit"].KitAskingRoad, "version", "2")
    after = keys_of(load(config_file("one", **ASKING)))
    assert before.road != after.road
    assert before.scenario == after.scenario


def test_content_is_what_counts():
    def report(text="a", png=b"1"):
        return CrashReport(case="c", narrative=text, diagrams=(Diagram(png=png, width_px=1, height_px=1),))

    def track(x):
        t = np.arange(2) * 0.05
        return Trajectory(actor="V1", t_s=t, x_m=np.array(x), y_m=t, heading_rad=t, speed_mps=t)

    assert content_of(report()) == content_of(report())
    assert content_of(track([0.0, 1.0])) == content_of(track([0.0, 1.0]))
    different = [
        report(),
        report("b"),
        report(png=b"2"),
        (report(),),
        track([0.0, 1.0]),
        track([0.0, 1.5]),
        None,
        "",
        b"",
        0,
        0.0,
    ]
    assert len({content_of(value) for value in different}) == len(different)


def test_two_who_want_the_same_compute_it_once(tmp_path):
    shelf, meet, computed = Shelf(tmp_path), threading.Barrier(4), []

    def compute():
        computed.append(threading.get_ident())
        return REPORT, 1.5

    def want(into):
        meet.wait(60)
        into.append(shelf.timed("abc", compute))

    found = []
    threads = [threading.Thread(target=want, args=(found,)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert len(computed) == 1
    assert sorted(known for *_, known in found) == [False, True, True, True]
    assert [(value, seconds) for value, seconds, _ in found] == [(REPORT, 1.5)] * 4


def test_who_is_killed_holds_nobody_up(tmp_path):
    code = f"""
import sys, time
from pathlib import Path
from flows.case_files.record_json import pack
from flows.case_files.stage_cache import Shelf
with Shelf(Path({str(tmp_path)!r})).alone("abc"):
    print("held", flush=True)
    time.sleep(600)
"""
    holder = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert holder.stdout.readline() == "held\n"
    holder.send_signal(signal.SIGKILL)
    holder.wait(60)
    holder.stdout.close()
    assert Shelf(tmp_path).timed("abc", lambda: (REPORT, 1.0)) == (REPORT, 1.0, False)
    assert Shelf(tmp_path).timed("abc", lambda: (REPORT, 2.0)) == (REPORT, 1.0, True)
    assert not list(tmp_path.rglob("*.lock"))


def test_a_folder_that_cannot_be_written_costs_the_sharing_only(tmp_path):
    (tmp_path / "file").write_text("")
    assert Shelf(tmp_path / "file").timed("abc", lambda: (REPORT, 1.0)) == (REPORT, 1.0, False)


class Planted:
    """Makes a file when it is unpickled."""

    def __init__(self, file):
        self.file = file

    def __reduce__(self):
        return Path.touch, (self.file,)


def test_a_planted_entry_runs_nothing_and_is_computed_again(tmp_path):
    shelf, canary = Shelf(tmp_path / "shelf"), tmp_path / "canary"
    shelf.put("abc", (REPORT, 1.0))
    for packed in (pickle.dumps(Planted(canary)), zlib.compress(pickle.dumps(Planted(canary))), pack("a text")):
        shelf._file("abc").write_bytes(hashlib.sha256(packed).hexdigest().encode() + b"\n" + packed)
        assert shelf.timed("abc", lambda: (REPORT, 2.0)) == (REPORT, 2.0, False)
    assert not canary.exists()
