"""Rules of shards, leases and the watch: nothing lost, nothing twice, the same bytes as one machine."""

import json
import threading
import time
import uuid
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flows.batch import plan_batch as batches
from flows.batch.plan_batch import Job, JobRunner
from flows.case_files import find_cases
from flows.case_files.case_folder import CaseFolder
from flows.case_files.find_cases import Case
from flows.study.shard_lease import Lease, LeaseLost, lease_name
from flows.study.shards import Shard, ShardJob, cut, lay_out, run_shard
from flows.study.shared_storage import SharedFolder, Unreachable
from flows.study.watch_shards import FRUITLESS, PATIENCE_S, START_S, ShardWatch, watch_until_done
from sgcad_core.asking.refine import run_at_once
from sgcad_core.errors import BadInput, ConfigError

MINUTE_S = 60.0
IN_THREADS = {"backbone": {"name": "scripted", "answers": ["-"]}, "decoder": "greedy"}
"""A config with a model runs in this process, which spares the tests the start of others."""


@pytest.fixture
def share():
    return SharedFolder(f"memory://{uuid.uuid4()}/study")


@pytest.fixture
def plan(tmp_path, config_file, reports):
    """Two arms over four cases, one of them refused, as a single machine would plan them."""
    folder = reports(c1="", c2="", c3="REFUSE", c4="")
    files = [config_file("one", **IN_THREADS), config_file("two", max_attempts=3, **IN_THREADS)]
    return batches.batch_of(find_cases.cases_in([folder]), files, tmp_path / "home").plan()


def run(plan, runner, hand_in):
    """What `flows.batch.batch_flow.submit_and_follow` does, without Prefect's view of it."""
    for job in plan:
        hand_in(job, runner.finish(job, run_at_once), "")


class Stop(Exception):
    """The host is gone."""


def run_until(count):
    """A run whose host dies after so many cases."""

    def limited(plan, runner, hand_in):
        for number, job in enumerate(plan):
            if number == count:
                raise Stop
            hand_in(job, runner.finish(job, run_at_once), "")

    return limited


def contents(folder, skip=("seconds", "shared")):
    """result.json and metrics.json of every case, apart from what a clock says and which arm came first to a stage."""
    found = {}
    for file in sorted(Path(folder).glob("*/*/result.json")):
        result = {k: v for k, v in json.loads(file.read_text()).items() if k not in skip}
        metrics = file.with_name("metrics.json")
        found[file.parent.parent.name, file.parent.name] = (result, metrics.read_bytes() if metrics.exists() else b"")
    return found


# ------------------------------------------------------------------ cutting
@st.composite
def job_lists(draw):
    arms = [f"arm{i}" for i in range(draw(st.integers(1, 4)))]
    ids = [f"case{i}" for i in range(draw(st.integers(1, 30)))]
    listed = [
        Job(_Named(arm), Case(Path(c), c), f"{arm}{c}" * 8, CaseFolder(Path(), arm, c)) for arm in arms for c in ids
    ]
    return listed, len(arms), len(ids)


class _Named:
    """As much of a config as cutting looks at."""

    def __init__(self, name):
        self.name = name


@given(job_lists(), st.one_of(st.none(), st.integers(1, 50)))
def test_shards_hold_every_job_once_all_arms_of_a_case_together_and_are_even(made, wanted):
    jobs, arms, count = made
    shards = cut(jobs, wanted)
    works = [work for shard in shards for work in shard]
    assert sorted((w.arm, w.case) for w in works) == sorted((j.config.name, j.case.id) for j in jobs)
    homes = [{work.case for work in shard} for shard in shards]
    assert sum(len(home) for home in homes) == count
    assert all(shards)
    assert max(len(s) for s in shards) - min(len(s) for s in shards) <= arms
    assert wanted is None or len(shards) == min(wanted, count)


# ------------------------------------------------------------------ one shard
def test_results_come_home_as_one_machine_makes_them(plan, share, tmp_path):
    runner = JobRunner(batches.Batch((), (), plan[0].folder.out, 1, 1))
    run(plan, runner, lambda *_: None)
    shards = lay_out(share, "s", plan, 2)
    for number in range(len(shards)):
        tally = run_shard(Shard(share, number, f"run{number}", tmp_path / f"host{number}"), run, 1)
        assert (tally.done, tally.found, tally.doubled, tally.failed) == (4, 0, 0, 0)
    for name in share.names("done/"):
        mark = share.mark(name)
        with CaseFolder(tmp_path / "merged", mark.arm, mark.case).writing() as partial:
            share.fetch(mark, partial)
    assert contents(tmp_path / "merged") == contents(tmp_path / "home")
    assert len(contents(tmp_path / "home")) == 8


def test_a_shard_taken_again_does_only_what_has_no_mark(plan, share, tmp_path):
    lay_out(share, "s", plan, 1)
    with pytest.raises(Stop):
        run_shard(Shard(share, 0, "first", tmp_path / "host1"), run_until(3), 1)
    assert len(share.names("done/")) == 3
    tally = run_shard(Shard(share, 0, "second", tmp_path / "host2"), run, 1)
    assert (tally.done, tally.found) == (5, 3)
    assert {share.mark(name).run for name in share.names("done/")} == {"first", "second"}


def test_a_case_is_not_done_before_its_mark(plan, share, tmp_path):
    lay_out(share, "s", plan, 1)
    share.write(f"results/one/c1/{uuid.uuid4()}.tar.gz", b"half an upload")
    assert run_shard(Shard(share, 0, "run", tmp_path / "host"), run, 1).done == 8


def test_who_marks_second_takes_his_object_away(plan, share, tmp_path):
    lay_out(share, "s", plan, 1)
    shard = Shard(share, 0, "early", tmp_path / "host")
    jobs, _ = shard.jobs()
    runner = JobRunner(batches.Batch((jobs[0].config,), (), tmp_path / "host", 1, 1))
    ending = runner.finish(jobs[0], run_at_once)
    lease = Lease(share, 0, "early")
    assert shard.hand_in(lease, jobs[0], ending) == "done"
    assert replace(shard, run="late").hand_in(Lease(share, 0, "late"), jobs[0], ending) == "doubled"
    assert [name.rpartition("/")[2] for name in share.names("results/")] == ["early.tar.gz"]


def test_a_run_of_an_earlier_plan_leaves_and_takes_no_lease(plan, share, tmp_path):
    lay_out(share, "s", plan, 2, laying="first")
    lay_out(share, "s", plan, 1, laying="second")
    with pytest.raises(LeaseLost, match="started again with other shards"):
        run_shard(Shard(share, 0, "old", tmp_path / "host", "first"), run, 1)
    assert share.names("leases/") == set()
    assert run_shard(Shard(share, 0, "new", tmp_path / "host", "second"), run, 1).done == 8


def test_a_host_with_other_code_refuses(plan, share, tmp_path):
    lay_out(share, "s", [replace(job, digest="0" * 64) for job in plan], 1)
    with pytest.raises(ConfigError, match="install the same version"):
        run_shard(Shard(share, 0, "run", tmp_path / "host"), run, 1)


def test_a_report_that_is_one_file_arrives_as_one_file(config_file, share, tmp_path):
    report = tmp_path / "c1.txt"
    report.write_text("Vehicle #1 struck the back of Vehicle #2 on a two lane road.")
    plan = batches.batch_of(find_cases.cases_of([report]), [config_file(**IN_THREADS)], tmp_path / "home").plan()
    lay_out(share, "s", plan)
    jobs, _ = Shard(share, 0, "run", tmp_path / "host").jobs()
    assert jobs[0].digest == plan[0].digest
    assert jobs[0].case.source.is_file()


def test_a_share_belongs_to_one_study(plan, share):
    lay_out(share, "s", plan)
    with pytest.raises(ConfigError, match="give each study its own folder"):
        lay_out(share, "t", plan)


def test_failed_cases_are_tried_again_by_the_next_study_only(config_file, reports, share, tmp_path):
    folder = reports(c1="RAISE", c2="")
    plan = batches.batch_of(find_cases.cases_in([folder]), [config_file(**IN_THREADS)], tmp_path / "home").plan()
    lay_out(share, "s", plan, 1)
    tally = run_shard(Shard(share, 0, "run", tmp_path / "host"), run, 1)
    assert (tally.done, tally.failed) == (1, 1)
    assert run_shard(Shard(share, 0, "again", tmp_path / "host"), run, 1).found == 2
    lay_out(share, "s", plan, 1)
    assert run_shard(Shard(share, 0, "next", tmp_path / "host"), run, 1).failed == 1


# ------------------------------------------------------------------ storage
def test_an_object_that_is_not_what_its_mark_says_is_refused(plan, share, tmp_path):
    folder = tmp_path / "case"
    folder.mkdir()
    (folder / "result.json").write_text("{}")
    assert share.leave(folder, ("one", "c1", "d" * 64), "generated", "run")
    (name,) = share.names("done/")
    share.write(share.mark(name).object, b"something else")
    with pytest.raises(BadInput, match="not what its mark says"):
        share.fetch(share.mark(name), tmp_path)


def test_a_mark_cut_off_in_writing_is_no_mark(tmp_path):
    share = SharedFolder(f"file://{tmp_path}/study")
    folder = tmp_path / "case"
    folder.mkdir()
    work = ShardJob("one", "c1", "d" * 64)
    share.write(work.mark, b'{"arm": "on')
    assert share.mark(work.mark) is None
    assert share.leave(folder, ("one", "c1", work.digest), "generated", "run")
    assert share.mark(work.mark).run == "run"


@pytest.mark.parametrize("address", ["memory://{}/s", "file://{}/s", "{}/plain"])
def test_a_share_keeps_what_it_is_given(address, tmp_path):
    share = SharedFolder(address.format(tmp_path))
    share.write("cases/a b #1/räder.txt", b"x")
    share.write("cases/c.txt", b"y")
    assert share.names("cases/") == {"cases/a b #1/räder.txt", "cases/c.txt"}
    assert share.names("cases/c.txt") == {"cases/c.txt"}
    assert share.names("nothing/") == set()
    assert share.read("cases/nothing") is None
    share.remove("cases/c.txt")
    share.remove("cases/c.txt")
    assert share.names("cases/") == {"cases/a b #1/räder.txt"}


def test_a_storage_that_cannot_be_reached_is_named():
    with pytest.raises(Unreachable, match="nosuch://x"):
        SharedFolder("nosuch://x").names("done/")


# ------------------------------------------------------------------ lease
def test_a_lease_that_was_given_to_another_run_is_lost(share):
    first, second = Lease(share, 0, "first"), Lease(share, 0, "second")
    first.take()
    first.beat()
    first.check()
    second.take()
    first.beat()
    with pytest.raises(LeaseLost, match="was given to flow run second"):
        first.check()
    second.beat()
    second.check()


def test_a_held_lease_counts_on(share):
    with Lease(share, 0, "run", beat_s=0.01).held():
        for _ in range(10_000):
            if share.json(lease_name(0))["count"] > 2:
                break
            time.sleep(0.01)
    assert share.json(lease_name(0))["count"] > 2


# ------------------------------------------------------------------ watch
class Desk:
    """A pool whose workers are the test itself."""

    def __init__(self):
        self.runs, self.crashed = {}, []

    def submit(self, shard):
        run = f"run{len(self.runs)}"
        self.runs[run] = ("waiting", "")
        return run

    def states(self, runs):
        return {run: self.runs[run] for run in runs}

    def give_up(self, run, reason):
        self.runs[run] = ("ended", reason)
        self.crashed.append(run)


@pytest.fixture
def desk():
    return Desk()


@pytest.fixture
def watch(plan, share, desk):
    shards = lay_out(share, "s", plan, 1)
    home = []
    made = ShardWatch(share, desk, shards, home.append)
    made.home = home
    return made


def test_a_shard_that_waits_for_a_worker_waits_for_ever(watch, desk):
    assert all(watch.step(now) for now in (0.0, 1000.0, 1e6))
    assert list(desk.runs) == ["run0"]


def test_a_lease_that_stands_still_is_given_up_and_its_shard_submitted_again(watch, desk, share):
    watch.step(0.0)
    desk.runs["run0"] = ("taken", "")
    Lease(share, 0, "run0").take()
    watch.step(10.0)
    watch.step(10.0 + PATIENCE_S)
    assert not desk.crashed
    watch.step(11.0 + PATIENCE_S)
    assert desk.crashed == ["run0"]
    assert list(desk.runs) == ["run0", "run1"]


def test_a_lease_that_moves_is_kept_however_long_a_case_takes(watch, desk, share):
    watch.step(0.0)
    desk.runs["run0"] = ("taken", "")
    lease = Lease(share, 0, "run0")
    for minute in range(100):
        lease.beat()
        assert watch.step(MINUTE_S * minute)
    assert not desk.crashed


def test_a_run_that_was_taken_and_never_began_is_given_up(watch, desk):
    watch.step(0.0)
    desk.runs["run0"] = ("taken", "")
    watch.step(START_S)
    assert not desk.crashed
    watch.step(START_S + 1)
    assert desk.crashed == ["run0"]


def test_the_lease_of_an_earlier_run_is_no_sign_of_life(watch, desk, share):
    watch.step(0.0)
    desk.runs["run0"] = ("taken", "")
    other = Lease(share, 0, "somebody")
    for second in range(int(START_S) + 2):
        other.beat()
        watch.step(float(second))
    assert desk.crashed == ["run0"]


def test_every_mark_comes_home_once_and_then_the_watch_ends(watch, desk, share, tmp_path):
    watch.step(0.0)
    with pytest.raises(Stop):
        run_shard(Shard(share, 0, "run0", tmp_path / "host"), run_until(3), 1)
    desk.runs["run0"] = ("ended", "Crashed: host gone")
    assert watch.step(1.0)
    assert len(watch.home) == 3
    assert watch.again == ["shard 0: ended with 5 jobs left (Crashed: host gone)"]
    run_shard(Shard(share, 0, "run1", tmp_path / "host"), run, 1)
    assert not watch.step(2.0)
    assert len({(mark.arm, mark.case) for mark in watch.home}) == len(watch.home) == 8


def test_a_shard_that_comes_to_nothing_ends_the_study_with_its_last_words(watch, desk):
    watch.step(0.0)
    for number in range(FRUITLESS - 1):
        desk.runs[f"run{number}"] = ("ended", "Failed: no such file")
        assert watch.step(1.0)
    desk.runs[f"run{FRUITLESS - 1}"] = ("ended", "Failed: no such file")
    with pytest.raises(ConfigError, match="Failed: no such file"):
        watch.step(2.0)


def test_a_watch_begun_again_goes_on_where_the_marks_are(plan, share, desk, tmp_path):
    lay_out(share, "s", plan, 1)
    with pytest.raises(Stop):
        run_shard(Shard(share, 0, "gone", tmp_path / "host"), run_until(3), 1)
    home = []
    watch = ShardWatch(share, desk, lay_out(share, "s", plan, 2), home.append)
    assert watch.step(0.0)
    assert len(home) == 3
    for number in range(2):
        run_shard(Shard(share, number, f"run{number}", tmp_path / "host"), run, 1)
    assert not watch.step(1.0)
    assert len(home) == 8


def test_a_short_cut_is_waited_for_and_a_long_one_is_told():
    class Cut:
        steps = 0

        def step(self, now):
            self.steps += 1
            if self.steps < 5:
                raise Unreachable("gone")
            return False

    ticks = iter(range(1000))
    watch_until_done(Cut(), lambda: float(next(ticks)), lambda: None, cut_s=100.0)
    with pytest.raises(Unreachable, match="gone"):
        watch_until_done(Cut(), lambda: float(next(ticks)), lambda: None, cut_s=1.0)


def test_a_crew_has_no_more_cases_on_their_way_than_it_was_told(plan):
    """However many threads ask: a model's memory is laid out for so many."""
    lock, inside, most = threading.Lock(), [0], [0]

    def watched(work):
        def turn(name, attempt):
            with lock:
                inside[0] += 1
                most[0] = max(most[0], inside[0])
            try:
                return attempt()
            finally:
                with lock:
                    inside[0] -= 1

        return turn

    runner = JobRunner(batches.Batch((), (), plan[0].folder.out, 2, 1))
    with ThreadPoolExecutor(8) as threads:
        endings = list(threads.map(lambda job: runner.finish(job, watched(job)), plan))
    assert len(endings) == 8
    assert 1 <= most[0] <= 2
