"""Weights by logistic regression: known ones are found, signs are kept."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.training.weight_fit import SIGNS, calibration_error, logistic, versus


def drawn(weights: list[float], count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows with a constant first, and marks that follow a logistic law of these weights."""
    rng = np.random.default_rng(seed)
    rows = np.column_stack([np.ones(count), rng.normal(size=(count, len(weights) - 1))])
    return rows, (rng.random(count) < 1 / (1 + np.exp(-rows @ weights))).astype(float)


def test_weights_of_many_rows_are_found_again() -> None:
    wanted = [-0.5, 0.8, -1.2, 0.4, 0.3, 0.6]
    assert logistic(*drawn(wanted, 20_000, 1)) == pytest.approx(wanted, abs=0.08)
    assert logistic(*drawn(wanted, 20_000, 1), SIGNS) == pytest.approx(wanted, abs=0.08)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(-2, 2), min_size=5, max_size=5), st.integers(0, 1000), st.lists(st.sampled_from((-1, 0, 1)),
    min_size=5, max_size=5),
)  # fmt: skip
def test_no_weight_has_a_sign_that_it_may_not_have(weights: list[float], seed: int, signs: list[int]) -> None:
    found = logistic(*drawn(weights, 60, seed), signs)
    assert all(sign * weight >= 0 for sign, weight in zip(signs, found, strict=True))


def test_a_column_of_the_wrong_sign_leaves_the_others_as_if_it_were_not_there() -> None:
    rows, marks = drawn([0.2, 1.0, 0.9, 0.5, 0.4, 0.6], 500, 3)
    found = logistic(rows, marks, SIGNS)
    assert found[2] == 0
    assert found[[0, 1, 3, 4, 5]] == pytest.approx(logistic(rows[:, [0, 1, 3, 4, 5]], marks), abs=1e-6)


def test_where_no_weight_may_have_its_sign_there_is_none() -> None:
    rows, marks = drawn([1.0] * 5, 500, 0)
    rows[:, 1:] = np.abs(rows[:, 1:])
    assert logistic(rows, np.ones(len(marks)), [-1] * 5).tolist() == [0] * 5


def test_without_rows_the_probability_is_believed() -> None:
    assert logistic(np.zeros((0, 6)), np.zeros(0), SIGNS).tolist() == [0, 1, 0, 0, 0, 0]


def test_calibration_error_and_pairs() -> None:
    assert calibration_error([(0.75, True), (0.75, False)]) == pytest.approx(0.25)
    assert versus([(False, True), (True, False), (True, True)]).startswith("+1 -1, 1.000")
