"""The cost model: floors follow from the data sheet, and the table names what cannot keep up."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from research.benchmarks.services import scale
from research.benchmarks.services.queueing import DAY_S
from research.benchmarks.services.scale import Card, Costs, Model


def test_one_report_alone_waits_for_the_weights():
    model, card = Model(1e9, 2.0, prompt=0, calls=100, rows=2, stages=1), Card(1e12, 1e15)
    assert model.floor_s(card, 1) == pytest.approx(100 * 2e9 / 1e12)


def test_a_very_large_batch_is_bound_by_arithmetic():
    model, card = Model(1e9, 2.0, prompt=0, calls=100, rows=2, stages=1), Card(1e12, 1e15)
    assert model.floor_s(card, 100_000) == pytest.approx(100 * 2 * 2 * 1e9 / 1e15)


def test_a_prompt_costs_two_operations_a_parameter_and_token():
    model = Model(1e9, 2.0, prompt=500, calls=0, stages=2)
    assert model.floor_s(Card(1e12, 1e15), 8) == pytest.approx(2 * 500 * 2 * 1e9 / 1e15)


@given(st.integers(1, 64), st.floats(0.5, 2.0), st.integers(0, 4000))
def test_a_larger_batch_never_costs_a_report_more(batch, bytes_each, prompt):
    model = Model(72.7e9, bytes_each, prompt)
    assert model.floor_s(scale.H200, batch + 1) <= model.floor_s(scale.H200, batch) * (1 + 1e-12)


def test_a_part_with_too_little_is_named():
    costs = Costs(prefect=0.001, mlflow=2.0, storage=0.001, starter=0.001)
    assert "mlflow: cannot keep up" in scale.table(1.5 * DAY_S, costs, reports=2000)
    assert "mlflow: gives way first" in scale.table(0.1 * DAY_S, costs, reports=2000)


def test_cores_and_cards_are_counted_for_the_busiest_hour():
    stations = {one.name: one for one in scale.stations_for(1e6, Costs(chain=0.9, hand_in=0.1), model_s=3.0)}
    rate = scale.PEAK * 1e6 / DAY_S
    assert stations["cores"].servers > rate * 1.0
    assert stations["cards"].servers > rate * 3.0
    assert "cards" not in {one.name for one in scale.stations_for(1e6, Costs())}
