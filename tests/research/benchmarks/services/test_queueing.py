"""The queue's simulation against closed forms: Erlang C for M/M/c, Pollaczek and Khinchine for M/G/1, Little's law."""

import math
import random

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from research.benchmarks.services.queueing import (
    DAY_S,
    Station,
    arrivals,
    erlang_c,
    servers_for,
    simulate,
    working_hours,
)

REPORTS = 20_000
CHANCE = settings(max_examples=6, deadline=None, derandomize=True, phases=(Phase.explicit, Phase.generate))
"""Tests whose truth is a mean over chance: the same examples every time, and no shrinking."""


def run(station, load, seed, reports=REPORTS):
    """A simulation of one station kept busy for `load` of its servers' time."""
    per_day = load * station.capacity * DAY_S
    return simulate([station], arrivals(per_day, reports, random.Random(seed)), seed)


@pytest.mark.parametrize(("servers", "load", "waits", "mean"), [(1, 0.5, 0.5, 1.0), (2, 0.5, 1 / 3, 1 / 3)])
def test_erlang_c_gives_the_textbook_values(servers, load, waits, mean):
    probability, wait = erlang_c(servers, load * servers, 1.0)
    assert probability == pytest.approx(waits)
    assert wait == pytest.approx(mean)


def test_erlang_c_is_infinite_where_servers_cannot_keep_up():
    assert erlang_c(3, 3.0, 1.0) == (1.0, math.inf)


@CHANCE
@given(st.integers(1, 20), st.floats(0.2, 0.85), st.floats(0.01, 100.0), st.integers(0, 2**32))
def test_waiting_and_utilisation_are_erlangs_with_exponential_service(servers, load, seconds, seed):
    station = Station("s", servers, seconds)
    outcome = run(station, load, seed)
    (seen,) = outcome.seen
    assert seen.utilisation(outcome.elapsed_s) == pytest.approx(load, abs=0.06)
    probability, wait = erlang_c(servers, load * station.capacity, seconds)
    assert sum(w > 0 for w in seen.waits) / REPORTS == pytest.approx(probability, abs=0.1)
    # Waits are correlated: the error of a mean grows as 1 / (1 - load), so the bound does too.
    assert seen.mean_wait == pytest.approx(wait, rel=0.35, abs=0.1 * seconds / servers / (1 - load))


@CHANCE
@given(st.floats(0.2, 0.8), st.floats(0.0, 1.5), st.integers(0, 2**32))
def test_waiting_at_one_server_is_pollaczek_and_khinchines_for_any_service(load, variation, seed):
    outcome = run(Station("s", 1, 1.0, variation), load, seed)
    expected = load / (1 - load) * (1 + variation**2) / 2
    assert outcome.seen[0].mean_wait == pytest.approx(expected, rel=0.4, abs=0.1)


@settings(max_examples=10, deadline=None)
@given(
    st.lists(st.tuples(st.integers(1, 5), st.floats(0.1, 2.0)), min_size=1, max_size=4),
    st.floats(10.0, 1e5),
    st.integers(0, 2**32),
)
def test_every_report_leaves_once_and_time_is_waiting_plus_service(parts, per_day, seed):
    stations = [Station(str(i), servers, seconds) for i, (servers, seconds) in enumerate(parts)]
    outcome = simulate(stations, list(arrivals(per_day, 500, random.Random(seed))), seed)
    assert len(outcome.through) == 500
    assert all(len(seen.waits) == 500 for seen in outcome.seen)
    spent = sum(sum(seen.waits) + seen.busy_s for seen in outcome.seen)
    assert sum(outcome.through) == pytest.approx(spent)
    assert all(wait >= 0 for seen in outcome.seen for wait in seen.waits)
    assert all(0 < seen.utilisation(outcome.elapsed_s) <= 1 for seen in outcome.seen)


def test_the_same_seed_gives_the_same_day():
    stations = [Station("a", 2, 1.0), Station("b", 1, 0.5)]
    times = list(arrivals(1e5, 1000, random.Random(3)))
    assert simulate(stations, times, 5).through == simulate(stations, times, 5).through


def test_a_day_with_hours_has_its_number_of_reports_and_its_peak():
    times = [t for t in arrivals(10_000, 12_000, random.Random(2), working_hours) if t < DAY_S]
    assert len(times) == pytest.approx(10_000, rel=0.05)
    afternoon = sum(13 <= t / 3600 % 24 < 15 for t in times)
    night = sum(1 <= t / 3600 % 24 < 3 for t in times)
    assert afternoon == pytest.approx(10_000 * 2 / 24 * 1.9, rel=0.1)
    assert night == pytest.approx(10_000 * 2 / 24 * 0.1, rel=0.4)


@given(st.floats(100, 1e6), st.floats(0.05, 20), st.floats(0.01, 100), st.floats(1, 2))
def test_servers_for_is_the_smallest_number_that_suffices(per_day, seconds, wait_s, peak):
    servers = servers_for(per_day, seconds, wait_s, peak)
    rate = peak * per_day / DAY_S
    assert erlang_c(servers, rate, seconds)[1] <= wait_s
    assert servers == 1 or erlang_c(servers - 1, rate, seconds)[1] > wait_s
