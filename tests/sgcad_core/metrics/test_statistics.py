"""Intervals and paired tests keep what statistics promises: coverage, symmetry, exactness, the same digits again."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.metrics import statistics

stats = pytest.importorskip("scipy.stats")

VALUES = st.lists(st.floats(-100, 100, allow_subnormal=False), min_size=2, max_size=40)
BITS = st.lists(st.tuples(st.integers(0, 1), st.integers(0, 1)), min_size=1, max_size=40)


@settings(max_examples=40, deadline=None)
@given(VALUES)
def test_an_interval_lies_within_the_values_and_repeats_to_the_digit(values):
    found = statistics.mean_interval(values)
    assert min(values) - 1e-9 <= found.low <= found.high <= max(values) + 1e-9
    assert statistics.mean_interval(values) == found


def test_the_interval_is_scipys_bca_interval():
    values = np.random.default_rng(3).gamma(2.0, size=60)
    ours = statistics.mean_interval(values)
    theirs = stats.bootstrap((values,), np.mean, n_resamples=20_000, method="BCa", rng=1).confidence_interval
    assert ours.method == "bca"
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=0.03)


def test_an_interval_covers_the_truth_about_as_often_as_it_says():
    draw = np.random.default_rng(5)
    hits = [
        found.low <= 0.3 <= found.high
        for _ in range(200)
        if (found := statistics.share_interval((draw.random(60) < 0.3).astype(float)))
    ]
    assert 0.88 <= np.mean(hits) <= 1.0


@pytest.mark.parametrize("n", [1, 5, 27, 109])
def test_unanimous_shares_are_not_taken_for_certain(n):
    low, high, method = statistics.share_interval([1.0] * n)
    assert (low, high, method) == (pytest.approx(stats.beta.ppf(0.025, n, 1)), 1.0, "exact")
    assert statistics.share_interval([0.0] * n)[:2] == (0.0, pytest.approx(1 - low))


def test_nothing_has_no_interval():
    assert statistics.mean_interval([]) is None
    assert statistics.ratio_interval([0.0, 0.0], [0.0, 0.0]) is None


def test_a_mean_error_of_zero_is_no_share():
    assert statistics.mean_interval([0.0, 0.0, 0.0])[:2] == (0.0, 0.0)


def test_constant_values_other_than_shares_have_a_point():
    assert statistics.mean_interval([2.5, 2.5, 2.5])[:2] == (2.5, 2.5)


def test_a_ratio_of_many_cases_is_resampled_in_blocks(monkeypatch):
    a, b = np.arange(50.0), np.full(50, 3.0)
    whole = statistics.ratio_interval(a, b)
    monkeypatch.setattr(statistics, "BLOCK", 50 * 700)
    assert statistics.ratio_interval(a, b)[:2] == pytest.approx(whole[:2], rel=0.02)
    assert whole.low < a.sum() / b.sum() < whole.high


@settings(max_examples=60, deadline=None)
@given(BITS)
def test_mcnemar_is_the_binomial_test_of_the_differing_pairs(pairs):
    first, second = zip(*pairs, strict=True)
    only_first, only_second = sum(a > b for a, b in pairs), sum(a < b for a, b in pairs)
    n = only_first + only_second
    assert statistics.mcnemar(first, second) == pytest.approx(stats.binomtest(only_first, n).pvalue if n else 1.0)
    assert statistics.mcnemar(first, second) == statistics.mcnemar(second, first)


def sign_flip(x, y):
    """The swap test on means: every case counts one."""
    return statistics.swap_test((x, np.ones_like(x)), (y, np.ones_like(y)))


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(st.integers(-99, 99), st.integers(-99, 99)), min_size=1, max_size=7))
def test_sign_flips_of_few_cases_are_all_counted(pairs):
    x, y = (np.array(v) for v in zip(*pairs, strict=True))
    seen = abs(np.mean(x - y))
    patterns = list(itertools.product((1, -1), repeat=len(x)))
    as_far = sum(abs(np.mean((x - y) * np.array(p))) >= seen - 1e-12 for p in patterns)
    assert sign_flip(x, y) == pytest.approx(as_far / len(patterns))


def test_many_sign_flips_are_drawn_and_tell_a_difference_from_none():
    draw = np.random.default_rng(1)
    x = draw.normal(size=80)
    assert sign_flip(x, x + 1 + 0.1 * draw.normal(size=80)) == 1 / (statistics.FLIPS + 1)
    assert sign_flip(x, x) == 1.0
    noise = draw.normal(size=80)
    assert sign_flip(x, noise) == sign_flip(x, noise)
    assert sign_flip(x, noise) > 0.01


def test_swapping_arms_compares_ratios_and_not_means_of_ratios():
    first = (np.array([1.0, 0.0, 0.0]), np.array([1.0, 9.0, 9.0]))
    second = (np.array([0.0, 9.0, 9.0]), np.array([1.0, 9.0, 9.0]))
    assert statistics.swap_test(first, second) == 0.5  # of the means of ratios it would be 1


def test_only_the_same_cases_can_be_paired():
    with pytest.raises(ValueError, match="same cases in both arms: 2 and 1"):
        statistics.mcnemar([1, 0], [1])


@settings(max_examples=60, deadline=None)
@given(st.dictionaries(st.text("abcdef", min_size=1), st.floats(0, 1), max_size=8))
def test_holm_never_helps_and_keeps_the_order(p_values):
    corrected = statistics.holm(p_values)
    assert list(corrected) == list(p_values)
    assert all(p_values[k] <= corrected[k] + 1e-15 and corrected[k] <= 1 for k in p_values)
    for a, b in itertools.pairwise(sorted(p_values, key=p_values.get)):
        assert corrected[a] <= corrected[b]


def test_holm_of_a_textbook_example():
    assert statistics.holm({"a": 0.01, "b": 0.04, "c": 0.03}) == pytest.approx({"a": 0.03, "b": 0.06, "c": 0.06})
    assert math.isclose(statistics.holm({"a": 0.2})["a"], 0.2)
