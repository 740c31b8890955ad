"""The nightly benchmark: what counts as a drop, and that it is named with both values."""

import json

import pytest

from flows.batch import run_batch
from flows.batch.plan_batch import batch_of
from flows.case_files.find_cases import cases_in
from flows.deploy import nightly
from flows.deploy.nightly import Tolerance, drops, figures_of
from sgcad_core.errors import ConfigError

WAS = {"mini": {"generated": 0.9, "file_errors": 0.1, "attempts": 2.0, "seconds": 1.0, "refused": 0.1}}


def changed(**values):
    return {"mini": {**WAS["mini"], **values}}


def test_within_tolerance_nothing_drops():
    now = changed(generated=0.88, file_errors=0.12, attempts=2.1, seconds=1.5)
    assert list(drops(WAS, now, Tolerance())) == []


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ({"generated": 0.85}, "mini: generated was 0.9, is 0.85 (high is good)"),
        ({"file_errors": 0.15}, "mini: file_errors was 0.1, is 0.15 (low is good)"),
        ({"attempts": 2.3}, "mini: attempts was 2, is 2.3 (low is good)"),
        ({"seconds": 1.6}, "mini: seconds was 1, is 1.6 (low is good)"),
    ],
)
def test_a_drop_names_the_metric_and_both_values(value, told):
    assert list(drops(WAS, changed(**value), Tolerance())) == [told]


def test_better_and_neither_good_nor_bad_are_no_drops():
    assert list(drops(WAS, changed(generated=1.0, file_errors=0.0, refused=0.9), Tolerance())) == []


def test_a_figure_or_config_that_is_gone_is_a_drop():
    assert len(list(drops(WAS, {}, Tolerance()))) == 4


def test_a_wider_tolerance_is_heeded():
    assert list(drops(WAS, changed(generated=0.8), Tolerance(share=0.1))) == []


@pytest.fixture
def measured(reports, config_file, tmp_path):
    """A finished batch; what the flow does around it is under test."""
    folder = reports(a="", b="REFUSE", c="RAISE")
    batch = batch_of(cases_in([folder]), [config_file()], tmp_path / "out", jobs=1)
    run_batch.evaluate_alone(batch, lambda *_: None)
    return batch


def test_a_run_is_measured_accepted_and_held_against_what_was_accepted(measured):
    figures = figures_of(measured, None)
    assert figures["kit"]["generated"] == pytest.approx(1 / 3, abs=1e-6)
    assert figures["kit"]["as_declared"] == 1.0
    assert figures["kit"]["failed"] == pytest.approx(1 / 3, abs=1e-6)
    latest, out = nightly._about(measured, figures), measured.out
    assert nightly._judged(out, latest, Tolerance()).is_completed()
    (out / "accepted.json").write_text("{")
    with pytest.raises(ConfigError, match=r"accepted\.json: cannot be read"):
        nightly._judged(out, latest, Tolerance())
    (out / "accepted.json").write_text(json.dumps(latest))
    assert nightly._judged(out, latest, Tolerance()).is_completed()
    worse = latest | {"figures": {"kit": {**figures["kit"], "generated": 0.1}}}
    failed = nightly._judged(out, worse, Tolerance())
    assert failed.is_failed()
    assert "kit: generated was 0.3333, is 0.1 (high is good)" in failed.message
    other = nightly._judged(out, latest | {"dataset_digest": "other"}, Tolerance())
    assert other.is_failed()
    assert "measured on other cases" in other.message


def test_trackers_without_a_database_of_their_own_log_to_that_of_all_results(reports, config_file, tmp_path):
    own = {"name": "mlflow", "database": str(tmp_path / "own.db")}
    configs = [config_file("a", tracker="mlflow"), config_file("b", tracker=own), config_file("c")]
    batch = batch_of(cases_in([reports(r="")]), configs, tmp_path / "runs" / "nightly")
    found = nightly._in_one_database(batch, tmp_path / "runs" / "mlflow.db")
    assert [getattr(c.tracker, "database", None) for c in found.configs] == [
        tmp_path / "runs" / "mlflow.db", tmp_path / "own.db", None,
    ]  # fmt: skip
    assert [c.name for c in found.configs] == ["a", "b", "c"]
