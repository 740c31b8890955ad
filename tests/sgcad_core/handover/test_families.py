"""Families: what varies and why, members that stay the same crash, energy, and the hardest ones."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.execution.contact import first_contact, realised
from sgcad_core.handover.family.cross_entropy import rank_correlations, search
from sgcad_core.handover.family.parameter_priors import open_parameters
from sgcad_core.handover.family.variant import basis_of, member, undisturbed
from sgcad_core.kinds import mass_kg
from tests.sgcad_core.handover.scenes import crossing, rear_end

STATED = [
    {"field": "vehicles.V1.speed_mph", "value": 30, "status": "stated"},
    {"field": "vehicles.V1.kind", "value": "car", "status": "stated"},
    {"field": "conditions.surface", "value": "wet", "status": "stated"},
]


def by_name(made, facts=()):
    return {p.name: p for p in open_parameters(made, facts)}


def test_what_is_stated_is_narrow_and_what_is_not_is_wide():
    told, silent = by_name(crossing(surface="wet"), STATED), by_name(crossing(surface=None))
    assert (told["V1_pace"].low, told["V1_pace"].high) == pytest.approx((1 - 5 / 30, 1 + 5 / 30))
    assert (told["V2_pace"].low, told["V2_pace"].high) == (0.6, 1.4)
    assert (told["friction"].low, told["friction"].high) == (0.5, 0.7)
    assert silent["friction"].high - silent["friction"].low > 0.3
    assert told["V1_length"].high < silent["V1_length"].high
    assert told["V1_pace"].field == "vehicles.V1.speed_mph"
    assert silent["V1_pace"].field == ""


@given(latent=st.floats(-12, 12))
def test_no_value_leaves_its_limits_and_all_rise_with_their_latents(latent):
    for p in open_parameters(crossing(), STATED):
        assert p.low <= p.value(latent) <= p.high
        assert p.value(latent) <= p.value(latent + 0.5) + 1e-12


def test_the_middle_of_a_distribution_is_the_script():
    made = crossing()
    middle = {p.name: p.value(0.0) for p in open_parameters(made, STATED)}
    assert {k: v for k, v in middle.items() if k != "friction"} == pytest.approx(
        {k: p.nominal for k, p in by_name(made, STATED).items() if k != "friction"}
    )
    same = undisturbed(basis_of(made), middle)
    k = round(5.5 / 0.05)
    for mine, theirs in zip(same.trajectories, made.trajectories, strict=True):
        assert (mine.x_m[k], mine.y_m[k]) == pytest.approx((theirs.x_m[k], theirs.y_m[k]), abs=1e-6)


def test_an_actor_that_stands_has_no_pace_and_an_object_no_size():
    assert "V2_pace" not in by_name(rear_end(kinds={"V2": "object"}))
    assert "V2_length" not in by_name(rear_end(kinds={"V2": "object"}))
    assert "V2_late_s" not in by_name(rear_end())


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), own=st.floats(6, 25), other=st.floats(4, 25))
def test_a_member_is_the_declared_crash_and_its_energy_never_grows(seed, own, other):
    made = crossing(own, other)
    basis = basis_of(made)
    latents = np.random.default_rng(seed)
    values = {p.name: p.value(float(latents.standard_normal())) for p in open_parameters(made, ())}
    found = member(basis, values)
    if found is None:
        return
    contact = first_contact(found.trajectories, found.sizes)
    assert realised(found.declared, contact)
    k = round(contact.t_s / 0.05)
    energy = [sum(kinetic(found, t, i) for t in found.trajectories) for i in (k - 2, k + 3, k + 6, k + 10, k + 20)]
    # spin is left out of the sum, which is why a little may come back from it
    assert all(b <= a * 1.02 + 50 for a, b in pairwise(energy))


def kinetic(script, track, k):
    info = script.info(track.actor)
    moved = math.hypot(track.x_m[k + 1] - track.x_m[k], track.y_m[k + 1] - track.y_m[k]) / 0.05
    return mass_kg(info.type, info.length_m) * moved**2 / 2


def test_pace_keeps_the_place_and_the_time_of_the_contact():
    made = crossing()
    basis = basis_of(made)
    fast = undisturbed(basis, {"V1_pace": 1.3, "V2_pace": 0.7})
    contact = first_contact(fast.trajectories, fast.sizes)
    assert contact.t_s == pytest.approx(6.0, abs=0.051)
    v1, v2 = fast.trajectories
    assert (v1.speed_mps[10], v2.speed_mps[10]) == pytest.approx((13.0, 7.0), rel=1e-6)


def test_a_script_that_does_not_begin_with_its_declared_contact_has_no_family():
    made = crossing()
    other = made.declared.model_copy(update={"struck_area": "right"})
    assert basis_of(type(made)(made.case, made.actors, made.trajectories, made.graph, other)) is None


# ------------------------------------------------------------------ the hardest
def test_the_search_moves_to_the_hard_corner_and_finds_harder_ones_than_chance():
    found = search(lambda z: float(z[0] - 0.5 * z[1]), 4, 400, 5, seed=3)
    assert found.mean[0] > 1.0
    assert found.mean[1] < -0.2
    assert found.hardness[-80:].mean() > found.hardness[:80].mean() + 1.0


def test_importance_weights_give_the_familys_own_rate():
    """P(z > 2) of a standard normal is 0.02275, seen through proposals that sit out there."""
    found = search(lambda z: float(z[0]), 2, 4000, 5, seed=1)
    rate, error = found.rate(found.latents[:, 0] > 2.0)
    assert rate == pytest.approx(0.02275, abs=4 * error)
    assert error < 0.004
    assert found.weights[:800] == pytest.approx(1.0)


def test_equal_seeds_search_alike_and_no_member_is_no_hardness():
    one, two = (search(lambda z: None if z[0] > 0 else float(z[1]), 2, 60, 3, seed=7) for _ in range(2))
    assert np.array_equal(one.latents, two.latents)
    assert np.isneginf(one.hardness[one.latents[:, 0] > 0]).all()


def test_what_decides_is_the_rank_correlation():
    z = np.random.default_rng(0).standard_normal((200, 3))
    found = rank_correlations(z, np.exp(z[:, 1]))
    assert found[1] == pytest.approx(1.0)
    assert abs(found[0]) < 0.2
    assert rank_correlations(z[:2], np.array([1.0, 2.0])).tolist() == [0.0, 0.0, 0.0]
