"""Results of steps in Prefect's storage: shared by configs, the same with and without, only a cache."""

import base64
import json
import pickle
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from prefect.filesystems import LocalFileSystem

from flows.batch import run_batch
from flows.batch.kept_results import KeptRecords, StepLocks, own_record
from flows.batch.plan_batch import batch_of
from flows.case.steps import Held
from flows.case_files.find_cases import cases_in
from sgcad_core.asking.refine import Turn
from sgcad_core.case.records import Attempt, CrashReport

ANSWERS = [{"attempt": 1, "answer": "no"}, {"attempt": 2, "answer": "no"}, {"attempt": 3, "answer": "ok"}]
ASKING = {"road_writer": "testkit_asking", "decoder": "greedy", "backbone": {"name": "scripted", "answers": ANSWERS}}
REPORT = CrashReport(case="c", narrative="V1 struck V2.")
STEPS = ["read", "road", "scenario", "simulate"]

pytestmark = pytest.mark.usefixtures("under_server")


@pytest.fixture
def work(tmp_path, reports):
    """Works off configs over one report, one after the other; results by config, and the attempts that were made."""
    cases = cases_in([reports(a="")])

    def run(*files, shelf=True, out="out"):
        batch = replace(batch_of(cases, files, tmp_path / out, jobs=1), shelf=tmp_path / "shelf" if shelf else None)
        results, made = {}, []
        run_batch.evaluate(batch, lambda job, ending, _: results.update({job.config.name: ending.result}))
        for name in results:
            told = json.loads((tmp_path / out / name / "a" / "steps.json").read_text())
            made += [s["name"] for s in told if "[" in s["name"] and s["state"] not in ("Cached", "Completed")]
        return results, made

    return run


def plain(result):
    """A result without what tells one arm or one run from another."""
    return {k: v for k, v in result.items() if k not in ("config", "seconds", "shared")}


@pytest.mark.slow
def test_fewer_attempts_are_the_first_of_many(work, config_file):
    arms = [config_file(f"max{n}", **ASKING, max_attempts=n) for n in (1, 2, 3, 10)]
    shared, asked = work(*arms)
    alone, asked_alone = work(*arms, shelf=False, out="alone")
    assert {name: plain(r) for name, r in shared.items()} == {name: plain(r) for name, r in alone.items()}
    assert [r["status"] for r in shared.values()] == ["exhausted", "exhausted", "generated", "generated"]
    assert [n for n in asked if n.startswith("road")] == ["road[1]", "road[2]", "road[3]"]
    assert len([n for n in asked_alone if n.startswith("road")]) == 9


@pytest.mark.slow
def test_longer_refinement_first_serves_the_shorter_ones(work, config_file):
    arms = [config_file(f"max{n}", **ASKING, max_attempts=n) for n in (10, 2)]
    shared, asked = work(*arms)
    assert asked == ["road[1]", "road[2]", "road[3]", "scenario[1]"]
    assert shared["max2"]["status"] == "exhausted"
    assert shared["max2"]["attempts"] == {"road": 2, "scenario": 0}
    assert shared["max10"]["shared"] == []
    assert shared["max2"]["shared"] == ["read", "road"]


def test_a_kept_result_has_the_time_it_took_and_a_damaged_one_is_made_again(work, config_file, tmp_path):
    arms = [config_file(name, **ASKING) for name in ("one", "two")]
    shared, _ = work(*arms)
    assert shared["two"]["shared"] == STEPS
    for step in STEPS:
        assert shared["two"]["seconds"][step] == shared["one"]["seconds"][step]
    kept = [file for file in (tmp_path / "shelf").iterdir() if file.is_file()]
    assert len(kept) == 6
    for file in kept:
        file.write_bytes(file.read_bytes()[:-7])
    three, asked = work(config_file("three", **ASKING))
    assert plain(three["three"]) == plain(shared["one"])
    assert three["three"]["shared"] == []
    assert len(asked) == 4


def test_a_kept_result_of_another_step_is_made_again(work, config_file, tmp_path):
    one, _ = work(config_file("one", **ASKING))
    for file in (file for file in (tmp_path / "shelf").iterdir() if file.is_file()):
        record = json.loads(file.read_bytes())
        is_turn = isinstance(KeptRecords().loads(record["result"].encode()).value, Turn)
        other = REPORT if is_turn else Turn(Attempt(stage="road", number=1))
        file.write_text(json.dumps(record | {"result": KeptRecords().dumps(Held(other)).decode()}))
    two, asked = work(config_file("two", **ASKING))
    assert plain(two["two"]) == plain(one["one"])
    assert two["two"]["shared"] == []
    assert len(asked) == 4


def test_without_a_shelf_nothing_is_said_of_sharing(work, config_file):
    alone, _ = work(config_file(**ASKING), shelf=False)
    assert "shared" not in alone["kit"]


# ------------------------------------------------------------------ the form
def test_a_value_comes_back_with_its_seconds_and_is_marked():
    back = KeptRecords().loads(KeptRecords().dumps(Held(REPORT, 1.5)))
    assert (back.value, back.seconds, back.kept) == (REPORT, 1.5, True)


class Planted:
    """Makes a file when it is unpickled."""

    def __init__(self, file):
        self.file = file

    def __reduce__(self):
        return Path.touch, (self.file,)


def test_a_planted_entry_runs_nothing_and_is_discarded(tmp_path):
    canary, entry = tmp_path / "canary", tmp_path / "key"
    planted = base64.b64encode(pickle.dumps(Planted(canary))).decode()
    assert KeptRecords().loads(planted.encode()) is None
    for serializer in ({"type": "pickle"}, {"type": "compressed/pickle"}, None):
        entry.write_text(json.dumps({"metadata": {"serializer": serializer}, "result": planted}))
        own_record(LocalFileSystem(basepath=str(tmp_path)), entry.name)
        assert not entry.exists()
    assert not canary.exists()
    ours = json.dumps({"metadata": {"serializer": {"type": "sgcad-records"}}, "result": "x"})
    entry.write_text(ours)
    own_record(LocalFileSystem(basepath=str(tmp_path)), entry.name)
    assert entry.read_text() == ours


# ------------------------------------------------------------------ the locks
def test_of_many_that_want_a_key_one_has_it(tmp_path):
    locks, meet, order = StepLocks(tmp_path), threading.Barrier(4), []

    def want(name):
        meet.wait(60)
        assert locks.acquire_lock("abc", name)
        assert locks.is_lock_holder("abc", name)
        order.append(f"{name} in")
        order.append(f"{name} out")
        locks.release_lock("abc", name)

    threads = [threading.Thread(target=want, args=(str(n),)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert [line.split()[1] for line in order] == ["in", "out"] * 4
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_who_is_killed_holds_nobody_up(tmp_path):
    code = f"""
import time
from pathlib import Path
from flows.batch.kept_results import StepLocks
StepLocks(Path({str(tmp_path)!r})).acquire_lock("abc", "other")
print("held", flush=True)
time.sleep(600)
"""
    holder = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert holder.stdout.readline() == "held\n"
    holder.send_signal(signal.SIGKILL)
    holder.wait(60)
    holder.stdout.close()
    locks = StepLocks(tmp_path)
    assert locks.acquire_lock("abc", "me", acquire_timeout=5)
    assert locks.is_lock_holder("abc", "me")
    locks.release_lock("abc", "me")


def test_a_folder_that_cannot_be_written_costs_the_sharing_only(tmp_path):
    (tmp_path / "file").write_text("")
    locks = StepLocks(tmp_path / "file")
    assert locks.acquire_lock("abc", "me")
    locks.release_lock("abc", "me")
