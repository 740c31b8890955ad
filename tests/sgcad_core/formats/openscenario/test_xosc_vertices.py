"""Vertices that every player keeps: what is written of slow motion, standstills and turns on the spot."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.formats.openscenario.writing.vertices import APART_M, held_at_standstill, vertex_rows
from tests.sgcad_core.formats.xosc_samples import trajectory


def rows_of(x, heading=0.0):
    return vertex_rows(trajectory("V1", x, 0.0, heading))


def test_an_actor_at_speed_has_a_vertex_a_step():
    assert rows_of(np.arange(20) * 0.12) == list(range(20))


def test_vertices_of_slow_motion_lie_apart():
    x = np.cumsum(np.linspace(0.2, 0.0, 60))
    rows = rows_of(x)
    assert (np.diff(x[rows[:-1]]) >= APART_M).all()
    assert (rows[0], rows[-1]) == (0, 59)


def test_what_is_left_out_is_what_even_motion_replaces_best():
    """Braking to rest at 5 m/s2 from 5 m/s: the last vertices lie as near to rest as they may."""
    t = np.arange(41) * 0.05
    x = np.where(t < 1, 5 * t - 2.5 * t**2, 2.5)
    rows = rows_of(x)
    assert np.abs(np.interp(t, t[rows], x[rows]) - x).max() < 0.04


@pytest.mark.parametrize("steps", [25, 60])
def test_a_standstill_of_a_second_keeps_both_of_its_ends(steps):
    x = np.concatenate((np.arange(10) * 0.2, np.full(steps, 2.0), 2.0 + np.arange(1, 10) * 0.3))
    rows = rows_of(x)
    assert {10, 9 + steps} <= set(rows)
    assert not any(10 < row < 9 + steps for row in rows)


def test_a_shorter_one_keeps_its_end_so_that_nobody_moves_off_too_early():
    x = np.concatenate((np.arange(10) * 0.2, np.full(12, 2.0), 2.0 + np.arange(1, 10) * 0.3))
    rows = rows_of(x)
    assert 21 in rows
    assert not any(10 <= row < 21 for row in rows)


def test_an_actor_that_stops_within_a_step_still_reaches_its_place():
    """A crash into a wall: the step before the last place is a full one, the last only a millimetre."""
    x = np.concatenate((np.arange(20) * 1.1, np.full(30, 19 * 1.1 + 0.001)))
    rows = rows_of(x)
    assert rows[:20] == list(range(20))
    assert rows[-1] == 49


def test_an_actor_at_rest_needs_two_vertices():
    assert rows_of(np.zeros(100)) == [0, 99]


def test_one_that_moves_less_than_players_tell_apart_needs_no_more():
    assert set(rows_of(np.linspace(0, 0.05, 80))) <= {0, 79} | set(range(80))
    assert len(rows_of(np.linspace(0, 0.05, 80))) <= 3


@pytest.mark.parametrize("rate", [-3.0, 3.0])
def test_no_turn_on_the_spot_is_lost(rate):
    """Headings go along the shortest arc, so that no two vertices may lie half a turn apart."""
    heading = rate * np.arange(80) * 0.05
    rows = rows_of(np.zeros(80), heading)
    assert np.abs(np.diff(heading[rows])).max() < 1.5


def test_the_moment_of_a_blow_is_a_vertex():
    """From 2.7 m/s to 0.6 m/s within a step: the last row before it is kept, whatever even motion would replace."""
    for before in range(20, 26):
        steps = np.concatenate((np.full(before, 0.135), np.full(30, 0.03)))
        x = np.concatenate(([0.0], np.cumsum(steps)))
        assert before in rows_of(x)


def test_who_is_hardly_moved_from_where_it_stands_stays_there():
    """Players would creep to the last vertex from the start on."""
    x = np.concatenate((np.zeros(60), np.linspace(0.005, 0.06, 12), np.full(30, 0.06)))
    assert np.ptp(held_at_standstill(trajectory("V1", x, 0.0)).x_m) == 0.0


@pytest.mark.parametrize("x", [
    np.concatenate((np.zeros(60), np.linspace(0.02, 0.6, 20), np.full(30, 0.6))),  # moved
    np.concatenate((np.linspace(0, 9, 40), np.full(40, 9.0))),  # comes to rest
    np.concatenate((np.zeros(8), np.linspace(0.005, 0.06, 12), np.full(30, 0.06))),  # stood for less than a second
])  # fmt: skip
def test_all_other_motion_is_as_it_was(x):
    np.testing.assert_array_equal(held_at_standstill(trajectory("V1", x, 0.0)).x_m, x)
