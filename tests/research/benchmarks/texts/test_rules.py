"""The benchmark of the rules compares like with like."""

import sys

import pytest

from research.benchmarks.texts import rules


def test_a_report_answers_in_the_form_of_its_truth() -> None:
    report = rules.report_of(7, held_out=False)
    road, behavior = rules.answer_of(report)
    assert {leg["bearing"] for leg in road["legs"]}
    assert {actor["id"] for actor in behavior["actors"]} <= {actor["id"] for actor in report.behavior["actors"]}


def test_speeds_off_by_one_count_as_told_and_others_do_not() -> None:
    assert rules._near(36, 35) == 35
    assert rules._near(37, 35) == 37
    assert rules._near(None, 35) is None


def test_a_shared_lane_is_a_through_lane() -> None:
    assert rules._through(["right", "through_right", "left_through", "left"]) == ["right", "through", "through", "left"]


def test_failures_on_held_out_phrases_cannot_be_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["rules", "--held-out", "--show", "lanes"])
    with pytest.raises(SystemExit, match="2"):
        rules.main()
