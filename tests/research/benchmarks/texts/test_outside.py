"""Reports of other writers: their truth, and figures of rules, model and both."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from research.benchmarks.texts import outside, outside_cases
from research.benchmarks.texts.outside import confidence, crossed, fit, right, rules_alone, table, untold
from research.benchmarks.texts.outside_cases import Case, cases, evidence_of, truth_of, with_drawing
from research.generator.writer_texts import Written, load, report_of, shipped
from research.training.weight_fit import versus
from sgcad_core.reading.second_reader.answered_values import model_claims
from sgcad_core.reading.second_reader.field_claims import Claim, kind_of
from sgcad_core.records.second_reader import DRAWN, WHOLE, Answered, Opinion, Weights
from sgcad_core.records.specs import BehaviorSpec, RoadLayout

TEXTS = load(outside.FOLDER)[::12]


def answer(one: Written) -> Answered:
    """What a perfect model says."""
    report = report_of(one, 0)
    p = {"road.legs[]": 1.0}
    return Answered(layout=RoadLayout(**report.road), behavior=BehaviorSpec(**(report.behavior or {})), p=p)


PERFECT = {one.id: answer(one) for one in TEXTS}


def rows(lines: list[str]) -> Mapping[str, list[float]]:
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return {cell[0]: [float(x) for x in cell[1:6]] for cell in cells if cell[0] != "field"}


def test_measured_narratives_are_others_than_those_that_train() -> None:
    measured = [one.id for some in outside.texts_of(outside.FOLDER).values() for one in some]
    assert len(set(measured)) == len(measured)
    assert not set(measured) & {one.id for one in shipped()}


@pytest.mark.slow
def test_reports_that_leave_out_much_leave_out_sides_lanes_and_maneuvers() -> None:
    found = load(outside.FOLDER / "sparse")
    lacking = {fact: sum(fact not in one.told for one in found) for fact in ("areas.0", "contact.0", "man.V1")}
    assert min(lacking.values()) > len(found) / 4
    sides = [case for case in cases([one for one in found if "areas.0" not in one.told], {}) if not case.blind]
    assert not any(case.claims[0]["areas"].told for case in sides if "areas" in case.claims[0])


def test_with_its_drawing_a_report_tells_what_the_drawing_shows_too() -> None:
    for one in TEXTS:
        alone, both = truth_of(one), truth_of(with_drawing(one))
        assert alone.keys() <= both.keys()
        assert {"legs", *(f"heading.{a.id}" for a in one.crash.actors if a.vehicle)} <= both.keys()
        assert not {"light", "weather"} & (both.keys() - alone.keys())
    assert any(truth_of(one).keys() < truth_of(with_drawing(one)).keys() for one in TEXTS)


def test_a_drawing_follows_from_the_report_and_stays_in_its_half() -> None:
    one = with_drawing(TEXTS[0])
    drawn, again = evidence_of(one).diagrams, evidence_of(one).diagrams
    assert len(drawn) == 1
    assert drawn == again
    assert not evidence_of(TEXTS[0]).diagrams
    of_alone, of_drawn = cases([TEXTS[0], one], {})
    assert of_alone.blind == of_drawn.blind


@pytest.mark.slow
def test_weights_of_a_report_are_fitted_without_it_and_its_drawing(monkeypatch) -> None:
    some = cases([*TEXTS, *map(with_drawing, TEXTS)], {})
    monkeypatch.setattr(outside, "both_fits", lambda some: {n: (n, {c.id for c in some}) for n in (WHOLE, DRAWN)})
    for id, (name, fitted_on) in crossed(some).items():  # type: ignore[misc]
        assert name == (DRAWN if id.endswith("+drawing") else WHOLE)
        assert not fitted_on & {id, id.removesuffix("+drawing"), id + "+drawing"}
        assert fitted_on


def test_what_is_not_told_and_given_up_is_counted() -> None:
    told = next(case for case in cases(TEXTS, PERFECT) if any(same_field(case)))
    key = next(key for key, differ in zip(told.claims[1], same_field(told), strict=True) if differ)
    less = replace(told, truth={k: v for k, v in told.truth.items() if k != key})
    for differ, taken in ((9.0, 1), (-9.0, 0)):
        weights = {less.id: {kind_of(key): Weights(differ=differ, slope=0.0)}}
        line = untold([less], weights)
        assert line.endswith(f"taken: {taken}")


def same_field(case: Case) -> list[bool]:
    """Of every field of the model: whether it is told and the rules have another value."""
    rules, model = case.claims
    return [
        key in case.truth and key in rules and not right(key, rules[key].value, claim.value)
        for key, claim in model.items()
    ]


def test_truth_holds_only_what_the_text_tells() -> None:
    for one in TEXTS:
        truth = truth_of(one)
        assert {"contact", "areas"} <= truth.keys()
        headed = {key.partition(".")[2] for key in truth if kind_of(key) == "heading"}
        assert {f"heading.{name}" for name in headed} <= one.told
        assert "weather" not in truth or "weather" in one.told


def test_a_perfect_model_is_right_everywhere_and_both_take_it_where_they_learn_to() -> None:
    found = cases(TEXTS, PERFECT)
    weights = fit(found)
    figures = rows(list(table(found, {case.id: weights for case in found})))
    n, rules, model, fused, either = figures["all"]
    assert model == either == 1.0
    assert rules < fused
    assert n == sum(len(case.truth) for case in found)
    assert set(crossed(found)) == {case.id for case in found}


def test_without_answers_both_are_the_rules() -> None:
    found = cases(TEXTS, {})
    _, rules, model, fused, _ = rows(list(table(found, {case.id: {} for case in found})))["all"]
    assert (model, fused) == (0.0, rules)
    assert fit(found) == {}


@pytest.mark.slow
def test_errors_are_shown_of_the_half_that_may_be_looked_at_alone() -> None:
    shown = "\n".join(rules_alone(TEXTS, "lanes"))
    blind = [case.id for case in cases(TEXTS, {}) if case.blind]
    assert shown
    assert blind
    assert not any(id in shown for id in blind)


@pytest.mark.parametrize(("key", "got", "want", "same"), [("speed.V1", 31, 30, True), ("limit.N", 31, 30, False),
                                                          ("lane.V1", None, 1, False)])  # fmt: skip
def test_a_speed_is_right_to_one_mph(key: str, got: object, want: object, same: bool) -> None:
    assert right(key, got, want) is same


def test_the_test_of_a_split_is_exact() -> None:
    assert versus([(False, True)] * 6).endswith("0.031")
    assert versus([(True, False), (False, True)]) == "+1 -1, 1.000"
    assert versus([]) == "+0 -0, 1.000"


def test_confidence_is_of_what_is_taken() -> None:
    weights = {"kind": Weights(differ=-2.0, slope=0.0, agree=0.97)}
    opinion = Opinion(weights=weights)
    assert confidence("kind.V1", Claim("car"), Claim("car"), opinion) == 0.97
    assert confidence("kind.V1", Claim("car"), Claim("bus"), opinion) == pytest.approx(0.881, abs=1e-3)
    assert confidence("kind.V1", None, Claim("bus"), opinion) is None
    assert confidence("lane.V1", Claim(1), Claim(2), opinion) is None


def test_a_run_asks_once_keeps_answers_and_writes_weights(tmp_path: Path, monkeypatch, capsys) -> None:
    folder = tmp_path / "texts"
    folder.mkdir()
    lines = (outside.FOLDER / "police.jsonl").read_text().splitlines()[:8]
    (folder / "some.jsonl").write_text("\n".join(lines))
    some = {one.text: one for one in load(folder)}
    asked: list[str] = []

    def whole(report, ask):
        asked.append(report.case)
        return report.model_copy(update={"opinion": Opinion(answered=answer(some[report.narrative]))})

    monkeypatch.setattr(outside_cases, "with_model_opinion", whole)
    monkeypatch.setattr(outside_cases, "ask_of", lambda config: None)
    kept, weights = tmp_path / "answers.jsonl", tmp_path / "weights"
    weights.mkdir()
    argv = ["outside", "--folder", str(folder), "--answers", str(kept), "--fit", str(weights)]
    monkeypatch.setattr("sys.argv", argv)
    outside.main()
    assert sorted(asked) == sorted(one.id for one in some.values())
    assert {json.loads(line)["id"] for line in kept.read_text().splitlines()} == set(asked)
    assert "blind half" in capsys.readouterr().out
    assert set(json.loads((weights / "whole.json").read_text())) <= set(outside.KINDS)
    assert not (weights / "whole_drawn.json").exists()
    outside.main()
    assert len(asked) == len(some), "kept answers are not asked for again"
    monkeypatch.setattr("sys.argv", [*argv, "--drawings"])
    outside.main()
    assert len(asked) == 2 * len(some)
    assert "blind half, with drawings" in capsys.readouterr().out
    assert set(json.loads((weights / "whole_drawn.json").read_text())) <= set(outside.KINDS)


def test_weights_go_into_a_folder(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr("sys.argv", ["outside", "--fit", str(tmp_path / "absent")])
    with pytest.raises(SystemExit):
        outside.main()
    assert "absent: no such folder; give the one for the weights" in capsys.readouterr().err


def test_a_case_is_blind_by_its_id() -> None:
    halves = [Case(one.id, {}, None, None).blind for one in load(outside.FOLDER)]  # type: ignore[arg-type]
    assert 0.4 < sum(halves) / len(halves) < 0.6
    assert model_claims(PERFECT[TEXTS[0].id])
