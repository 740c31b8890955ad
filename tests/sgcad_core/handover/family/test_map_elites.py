"""MAP-Elites: cells are filled with their hardest, and weights give the family's own rates."""

import numpy as np
import pytest

from sgcad_core.handover.family.map_elites import FAMILY_SHARE, illuminate


def corners(z):
    """Hard far out, in four cells by sign."""
    return float(np.abs(z[:2]).sum()), (int(z[0] > 0), int(z[1] > 0))


def test_every_cell_keeps_its_hardest_sample():
    found = illuminate(corners, 3, 400, seed=2)
    assert set(found.elites) == {(0, 0), (0, 1), (1, 0), (1, 1)}
    for cell, k in found.elites.items():
        mine = [i for i, z in enumerate(found.samples.latents) if corners(z)[1] == cell]
        assert found.samples.hardness[k] == max(found.samples.hardness[mine])


def test_it_finds_harder_ones_than_chance_in_all_cells():
    found = illuminate(corners, 3, 800, seed=5)
    chance = np.random.default_rng(5).standard_normal((800, 3))
    for cell, k in found.elites.items():
        best = max(corners(z)[0] for z in chance if corners(z)[1] == cell)
        assert found.samples.hardness[k] > best


def test_weights_give_the_familys_own_rate_and_are_bounded():
    """P(|z0| + |z1| > 3.5) by chance with many samples, and through batches that sit out there."""
    chance = np.abs(np.random.default_rng(0).standard_normal((400_000, 2))).sum(axis=1)
    rates = []
    for seed in range(6):
        found = illuminate(corners, 2, 1500, seed).samples
        event = np.abs(found.latents).sum(axis=1) > 3.5
        rates.append(found.rate(event)[0])
        assert (found.weights <= 1 / FAMILY_SHARE + 1e-9).all()
        assert found.weights[:450] == pytest.approx(1.0)
    assert np.mean(rates) == pytest.approx((chance > 3.5).mean(), rel=0.15)


def test_the_mean_weight_is_one():
    weights = np.concatenate([illuminate(corners, 4, 1000, seed).samples.weights for seed in range(4)])
    assert weights.mean() == pytest.approx(1.0, abs=0.06)


def test_no_member_falls_into_no_cell_and_equal_seeds_search_alike():
    def half(z):
        return None if z[0] > 0 else (float(z[1]), (0,))

    one, two = (illuminate(half, 2, 90, seed=3) for _ in range(2))
    assert np.array_equal(one.samples.latents, two.samples.latents)
    assert np.isneginf(one.samples.hardness[one.samples.latents[:, 0] > 0]).all()
    assert one.samples.latents[one.elites[0,], 0] <= 0
    nobody = illuminate(lambda z: None, 2, 40, seed=1)
    assert nobody.elites == {}
    assert (nobody.samples.weights == 1.0).all()
