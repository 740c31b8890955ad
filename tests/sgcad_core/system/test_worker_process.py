"""Worker processes: they persist, they may die, they come back."""

from __future__ import annotations

import os
import threading
import time

import numpy as np
import pytest

from sgcad_core.errors import InvalidOutput, ProcessDied, SimulationFailed
from sgcad_core.system.worker_process import Worker

TARGETS = "tests.sgcad_core.worker_targets"


@pytest.fixture
def worker():
    made = []

    def make(name):
        made.append(Worker(f"{TARGETS}:{name}"))
        return made[-1]

    yield make
    for each in made:
        each.close()


def test_calls_run_in_one_other_process(worker):
    where = worker("where")
    first, args = where.call(1, "a")
    assert args == (1, "a")
    assert first != os.getpid()
    assert where.call()[0] == first


def test_a_process_that_was_begun_before_serves_the_first_call(worker):
    where = worker("where")
    where.begin()
    begun = where._process.popen.pid
    where.begin()
    assert where.call()[0] == begun


def test_prints_do_not_disturb_large_answers(worker):
    double = worker("double")
    values = np.arange(500_000, dtype=float)
    assert np.array_equal(double.call(values), values * 2)
    assert "printed" in double.said()


@pytest.mark.parametrize(("how", "message"), [("signal", "SIGSEGV"), ("exit", "exit code 3"), ("raise", "no way")])
def test_a_death_is_simulation_failed_and_the_next_call_starts_anew(worker, how, message):
    die = worker("die")
    for _ in range(2):
        with pytest.raises(SimulationFailed, match=message):
            die.call(how)


@pytest.mark.parametrize(("how", "from_outside"), [("killed", True), ("signal", False), ("exit", False)])
def test_a_kill_is_told_from_a_crash(worker, how, from_outside):
    with pytest.raises(ProcessDied) as death:
        worker("die").call(how)
    assert death.value.from_outside == from_outside


def test_a_late_answer_is_simulation_failed(worker):
    die = worker("die")
    begin = time.monotonic()
    with pytest.raises(SimulationFailed, match=r"no answer within 0\.2 s"):
        die.call("sleep", timeout_s=0.2)
    assert time.monotonic() - begin < 20


def test_a_worker_killed_between_calls_is_replaced(worker):
    where = worker("where")
    first = where.call()[0]
    os.kill(first, 9)
    time.sleep(0.2)
    assert where.call()[0] != first


def test_errors_of_the_project_cross_over(worker):
    with pytest.raises(InvalidOutput, match="bad net") as caught:
        worker("refuse").call()
    assert caught.value.findings[0].what == "bad"


def test_the_error_stream_is_that_of_the_last_call(worker):
    say = worker("say")
    say.call("first")
    assert say.said() == "first"
    say.call("second")
    assert say.said() == "second"


def test_threads_share_one_worker(worker):
    where, seen = worker("where"), []
    threads = [threading.Thread(target=lambda i=i: seen.append(where.call(i)[1])) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(seen) == [(i,) for i in range(8)]


def test_an_unknown_target_is_simulation_failed():
    with pytest.raises(SimulationFailed, match="no_such_module"):
        Worker("no_such_module:f").call()


def test_what_the_first_call_leaves_is_not_walked_by_the_collector_again(worker):
    frozen = worker("frozen")
    assert frozen.call() == 0
    assert frozen.call() > 1000
