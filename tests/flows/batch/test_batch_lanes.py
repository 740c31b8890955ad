"""Jobs through pools: every job ends once, whatever its pool does."""

import threading
import time
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flows.batch.lanes import LOOK_S, UNSEEN, Death, Lane, Stop, open_threads, through


def jobs(count):
    return [SimpleNamespace(name=f"kit/{n}", number=n) for n in range(count)]


class Pools:
    """Pools of futures that are done at once, and break where told to."""

    def __init__(self, deadly=(), breaks=()):
        self.deadly, self.breaks = set(deadly), set(breaks)
        """Jobs that kill every pool, and jobs at which a pool breaks once."""
        self.opened = []

    @contextmanager
    def open(self, width):
        self.opened.append(width)
        broken = False

        def submit(job):
            nonlocal broken
            broken = broken or job.number in self.deadly or job.number in self.breaks
            self.breaks.discard(job.number)
            future = Future()
            if broken:
                future.set_exception(BrokenProcessPool("gone"))
            else:
                future.set_result(job.number)
            return future

        yield submit


@settings(deadline=None, max_examples=60)
@given(
    count=st.integers(0, 12), width=st.integers(1, 4),
    deadly=st.sets(st.integers(0, 11), max_size=3), breaks=st.sets(st.integers(0, 11), max_size=3),
)  # fmt: skip
def test_every_job_ends_once_and_only_what_kills_its_own_process_fails(count, width, deadly, breaks):
    pools = Pools(deadly, breaks)
    ended = list(through([Lane(jobs(count), width, pools.open)], Stop()))
    assert sorted(job.number for job, _ in ended) == list(range(count))
    assert {job.number for job, outcome in ended if isinstance(outcome, Death)} == deadly & set(range(count))
    assert all(outcome == job.number for job, outcome in ended if not isinstance(outcome, Death))


def test_lanes_go_on_side_by_side():
    meet = threading.Barrier(2)

    def run(number):
        meet.wait(20)
        return number

    def open_one(width):
        return open_threads(width, run, lambda job: job.number)

    lanes = [Lane(jobs(1), 1, open_one), Lane(jobs(1), 1, open_one), Lane([], 1, open_one)]
    assert [outcome for _, outcome in through(lanes, Stop())] == [0, 0]


def test_a_fault_of_a_job_is_raised_where_the_lanes_are_followed():
    def fail(number):
        raise ValueError("no such thing")

    lane = Lane(jobs(2), 1, lambda width: open_threads(width, fail, lambda job: job.number))
    with pytest.raises(ValueError, match="no such thing"):
        list(through([lane], Stop()))


def test_a_stopped_batch_begins_nothing_more():
    stop, begun = Stop(), []

    def run(number):
        begun.append(number)
        stop.ask()
        return number

    lane = Lane(jobs(20), 1, lambda width: open_threads(width, run, lambda job: job.number))
    list(through([lane], stop))
    assert len(begun) <= 2


def test_what_was_lost_with_a_pool_is_told():
    lost = []
    lane = Lane(jobs(3), 1, Pools(breaks={1}).open, lost=lambda future: lost.append(type(future.exception())))
    list(through([lane], Stop()))
    assert lost
    assert set(lost) == {BrokenProcessPool}


def test_lanes_wait_where_nobody_takes_what_they_did():
    pools, held = Pools(), jobs(UNSEEN * 4)
    begun = []
    lane = Lane(held, 2, open_counting(pools, begun))
    ended = through([lane], Stop())
    next(ended)
    deadline = time.monotonic() + 5
    while len(begun) <= UNSEEN and time.monotonic() < deadline:
        time.sleep(0.01)
    time.sleep(3 * LOOK_S)
    assert UNSEEN <= len(begun) <= UNSEEN + 2 * lane.ahead * lane.width
    assert len(list(ended)) == len(held) - 1


def test_a_lane_that_waits_ends_where_the_batch_is_stopped():
    stop, begun = Stop(), []
    ended = through([Lane(jobs(UNSEEN * 4), 2, open_counting(Pools(), begun))], stop)
    next(ended)
    time.sleep(2 * LOOK_S)
    stop.ask()
    assert len(list(ended)) < UNSEEN * 2


def open_counting(pools, begun):
    """Pools whose jobs are noted as they are handed in."""

    @contextmanager
    def open(width):
        with pools.open(width) as submit:
            yield lambda job: (begun.append(job), submit(job))[1]

    return open
