"""Rows of coded reports, and the weights and figures of a second opinion."""

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from research.benchmarks.texts import fuse_weights
from research.benchmarks.texts.fuse_weights import Case, fit, table
from research.rows.coded_incidents import Incident, is_blind
from research.rows.coded_rows import allowed, incidents_of_part, row
from research.rows.partial_labels import load
from research.training.weight_fit import calibration_error
from sgcad_core.reading.second_reader.combiner import model_right
from sgcad_core.reading.second_reader.seven_question_gist import RuleValues
from sgcad_core.records.second_reader import Heard

TEXT = (
    "The Orbit AV was stopped at a red light. The front bumper of an SUV made contact with the rear bumper of the "
    "Orbit AV."
)
TRUTH: dict[str, Any] = {
    "contact": True, "subject": {"manoeuvre": "stopped", "areas": ["back", "back_left"]},
    "other": {"kind": "vehicle", "manoeuvre": "straight", "areas": []},
    "road": {"intersection": None, "kind": "Street"},
}  # fmt: skip


def pool(file: Path, count: int = 60) -> Path:
    lines = [json.dumps({"id": f"kit-{n}", "text": TEXT, **TRUTH}) for n in range(count)]
    file.write_text("\n".join(lines))
    return file


def test_a_code_allows_a_set_and_silence_allows_nothing() -> None:
    found = allowed(TRUTH)
    assert found["subject_area"] == ("back", "left")
    assert found["other"] == ("straight", "slowing", "negotiating_curve")
    assert "other_area" not in found
    strange = TRUTH | {"other": {"kind": None, "manoeuvre": "wrong_way", "areas": []}, "road": {}}
    assert set(allowed(strange)) == {"touched", "subject", "subject_area"}


def test_what_the_text_tells_outright_narrows_a_set_and_never_contradicts_a_code() -> None:
    sets = row(Incident("kit-1", TEXT, TRUTH, "seen"))["allowed"]
    assert sets["subject_area"] == ("back",)
    coded = TRUTH | {"subject": {"manoeuvre": "backing", "areas": ["left"]}}
    assert row(Incident("kit-1", TEXT, coded, "seen"))["allowed"]["subject"] == ("backing",)


def test_parts_are_apart_and_neither_holds_a_blind_report(tmp_path: Path) -> None:
    file = pool(tmp_path / "pool.jsonl")
    train, kept = ({i.id for i in incidents_of_part(file, part)} for part in ("train", "validation"))
    assert train
    assert kept
    assert not train & kept
    assert not any(map(is_blind, train | kept))


def test_rows_are_what_training_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "rows.jsonl"
    monkeypatch.setattr("sys.argv", ["told_rows", str(pool(tmp_path / "pool.jsonl", 9)), "--out", str(out)])
    from research.rows.coded_rows import main

    main()
    assert {told.id for told in load(out)} == {i.id for i in incidents_of_part(tmp_path / "pool.jsonl", "train")}


def cases(*kinds: tuple[str, str, float, bool, int]) -> list[Case]:
    """Cases of one field: what the rules say, the model says, its p, whether the rules' is told; truth is stopped."""
    found = []
    for rule, model, p, told, count in kinds:
        say = RuleValues({"subject": rule}, frozenset({"subject"} if told else ()))
        case = Case("kit-1", {"subject": ("stopped",)}, say, {"subject": Heard(value=model, p=p)})
        found += [case] * count
    return found


def test_weights_follow_who_was_right() -> None:
    both = cases(("backing", "stopped", 0.9, False, 20), ("stopped", "backing", 0.9, True, 20))
    weights = fit(both, "subject")
    assert model_right(weights, 0.9, told=False) > 0.8
    assert model_right(weights, 0.9, told=True) < 0.2
    assert fit([], "subject").slope == 1.0, "nothing known: the model's own probability"


def test_the_table_has_rules_model_and_both() -> None:
    some = cases(("backing", "stopped", 0.9, False, 20), ("stopped", "backing", 0.2, False, 20))
    line = next(line for line in table(some[::2] + some[1::2]) if line.startswith("subject "))
    rules, model, fused, either = (float(word) for word in line.split()[2:6])
    assert (rules, model, either) == (0.5, 0.5, 1.0)
    assert fused > 0.9


def test_a_report_that_stays_refused_counts_as_wrong_for_both_and_trains_no_weight() -> None:
    some = [case._replace(refused=True) for case in cases(("backing", "stopped", 0.9, False, 20))]
    line = next(line for line in table(some) if line.startswith("subject "))
    assert [float(word) for word in line.split()[2:5]] == [0.0, 1.0, 0.0]
    assert fit(some, "subject") == fit([], "subject")


def test_the_error_of_a_calibrated_confidence_is_none() -> None:
    assert calibration_error([(0.75, True)] * 3 + [(0.75, False)]) == pytest.approx(0.0)
    assert calibration_error([(0.95, False)] * 4) == pytest.approx(0.95)


def test_a_run_asks_once_and_writes_weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answer = {
        "touched": True, "met": "suv", "subject": "stopped", "other": "straight", "subject_area": "back",
        "other_area": "front", "junction": False,
    }  # fmt: skip
    config = yaml.safe_load(Path("configs/gist.yaml").read_text())
    config |= {"backbone": {"name": "scripted", "answers": [{"narrative": "Orbit", "answer": answer}]}}
    (tmp_path / "kit.yaml").write_text(yaml.safe_dump(config))
    out, weights = tmp_path / "heard.jsonl", tmp_path / "weights.json"
    argv = ["opinions", str(pool(tmp_path / "pool.jsonl", 30)), "--config", str(tmp_path / "kit.yaml")]
    monkeypatch.setattr("sys.argv", [*argv, "--out", str(out), "--fit", str(weights)])
    fuse_weights.main()
    asked = out.read_text()
    assert len(asked.splitlines()) == len(list(incidents_of_part(tmp_path / "pool.jsonl", "validation")))
    assert set(json.loads(weights.read_text())) == set(answer)
    fuse_weights.main()
    assert out.read_text() == asked
