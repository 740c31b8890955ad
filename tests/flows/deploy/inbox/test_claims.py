"""Claims: of many one gets a report; the dead lose theirs, the living do not."""

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from flows.deploy.inbox.claims import CLAIMS, Claims
from flows.deploy.storage import Place

TAKE = "import sys; from flows.deploy.inbox.claims import Claims; from flows.deploy.storage import Place\n"
TAKE += "print(Claims(Place(sys.argv[1])).take('d').number)\n"


@pytest.fixture
def claims(tmp_path):
    """Makes another worker's view of the same place."""
    return lambda lease_s=3600.0: Claims(Place(str(tmp_path)), lease_s)


def foreign(tmp_path, number=1, age_s=0.0):
    """A claim of a worker on another machine, last heard of so long ago."""
    file = tmp_path / CLAIMS / f"d.{number}"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({"token": "t", "machine": "elsewhere", "pid": 1, "born": 0.0}))
    os.utime(file, (time.time() - age_s,) * 2)


def test_of_many_at_once_one_gets_the_report(claims):
    with ThreadPoolExecutor(8) as threads:
        got = list(threads.map(lambda _: claims().take("d"), range(32)))
    assert len([c for c in got if c]) == 1


def test_of_many_that_see_a_dead_claim_one_takes_it_over(claims, tmp_path):
    foreign(tmp_path, age_s=7200)
    with ThreadPoolExecutor(8) as threads:
        got = list(threads.map(lambda _: claims().take("d"), range(32)))
    assert [c.number for c in got if c] == [2]


def test_a_living_worker_keeps_its_report_and_one_on_another_machine_until_its_lease_ends(claims, tmp_path):
    mine = claims().take("mine")
    assert claims().take("mine") is None
    foreign(tmp_path)
    assert claims().take("d") is None
    assert claims().is_mine(mine)


def test_a_report_of_a_process_that_ended_is_free_at_once(claims, tmp_path):
    ended = subprocess.run([sys.executable, "-c", TAKE, tmp_path], capture_output=True, text=True)
    assert ended.stdout == "1\n", ended.stderr
    assert claims().take("d").number == 2


def test_a_worker_that_was_stopped_for_too_long_learns_that_it_lost(claims, tmp_path):
    slow = claims()
    held = slow.take("d")
    os.utime(tmp_path / held.name, (0, 0))
    quick = claims()
    foreign_view = quick.take("d")
    assert foreign_view.number == 2
    assert not slow.is_mine(held)
    quick.release(foreign_view)
    assert not list((tmp_path / CLAIMS).iterdir())


def test_a_beat_keeps_a_claim(claims, tmp_path):
    held = (worker := claims()).take("d")
    os.utime(tmp_path / held.name, (0, 0))
    worker.beat()
    assert claims().take("d") is None


def test_a_report_that_two_workers_died_with_is_taken_alone(claims, tmp_path):
    foreign(tmp_path, 1, 7200)
    foreign(tmp_path, 2, 7200)
    assert claims().take("d", alone=False) is None
    assert claims().take("d", alone=True).number == 3


def test_what_a_dead_worker_left_of_a_report_that_is_done_is_removed(claims, tmp_path):
    foreign(tmp_path, age_s=7200)
    mine = claims()
    mine.drop_dead(lambda _: False)
    assert (tmp_path / CLAIMS / "d.1").exists()
    foreign(tmp_path, age_s=0)
    mine.drop_dead(lambda _: True)
    assert (tmp_path / CLAIMS / "d.1").exists()
    foreign(tmp_path, age_s=7200)
    mine.drop_dead(lambda digest: digest == "d")
    assert not (tmp_path / CLAIMS / "d.1").exists()
