"""Cells that two boxes sweep: the same whether the area is kept whole or not, and no memory for what is not swept."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from sgcad_core.metrics import swept_cells
from sgcad_core.metrics.conflict import post_encroachment_time, post_encroachment_time_paper
from sgcad_core.metrics.swept_cells import Track


def drawn(rng, count):
    t = np.arange(count) * 0.05
    velocity = rng.uniform(-20, 20, 2) * rng.choice([0, 1, 1])
    heading = np.cumsum(rng.normal(0, 0.02, count))
    place = rng.uniform(-40, 40, 2) + np.cumsum(np.tile(velocity * 0.05, (count, 1)), axis=0)
    size = (float(rng.uniform(0.5, 20)), float(rng.uniform(0.5, 3)))
    return Track(t, np.column_stack((place, heading)), np.tile(velocity, (count, 1)), size)


def test_a_large_area_is_measured_as_a_small_one(monkeypatch):
    rng = np.random.default_rng(3)
    pairs = [(drawn(rng, n), drawn(rng, n)) for n in rng.integers(2, 200, 60)]
    found = [(post_encroachment_time(a, b), post_encroachment_time_paper(a, b)) for a, b in pairs]
    monkeypatch.setattr(swept_cells, "_DENSE", 0)
    assert [(post_encroachment_time(a, b), post_encroachment_time_paper(a, b)) for a, b in pairs] == found
    assert len({e.reason for pair in found for e in pair}) >= 4


@pytest.mark.parametrize("size", [(4.7, 1.8), (500.0, 500.0)])
def test_motion_over_a_thousand_kilometres_takes_little_memory(size):
    t = np.arange(400) * 0.05
    x = np.linspace(0, 1e6, 400)
    one = Track(t, np.column_stack((x, x, np.full(400, 0.78))), np.zeros((400, 2)), size)
    two = Track(t, np.column_stack((x, x[::-1] + 3, np.full(400, 0.78))), np.zeros((400, 2)), (4.7, 1.8))
    tracemalloc.start()
    assert swept_cells.common_cells(one, two, np.zeros(2), np.full(2, 1e6)) is None
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 250e6
