"""`sgcad explain`: a reading in words."""

import json

import pytest

from flows.case.explain import explain
from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from sgcad_core.config import load
from sgcad_core.errors import BadInput
from sgcad_core.settings import ROOT

DEMO = ROOT / "docs" / "demo" / "rear-end-on-arterial"


def test_a_report_is_read_on_the_spot_sentence_by_sentence():
    text = explain(DEMO)
    first, _, later = text.partition("Assumed:")
    assert "\n    vehicles.V1.heading = " in first
    assert "confidence 0.9" in first
    assert "confidence 0.2" in later


def test_a_case_folder_also_tells_what_was_written(tmp_path):
    run_case(load(ROOT / "configs" / "template.yaml"), Case(DEMO, "c1"), tmp_path, "d1")
    text = explain(tmp_path / "template" / "c1")
    verdict = json.loads((tmp_path / "template" / "c1" / "result.json").read_text())["account"]["sentence"]
    assert text.splitlines()[:2] == ["c1 (template)", verdict]
    assert "vehicles.V1.start_lane = " in text
    assert "roads." in text.partition("Inferred:")[2]


def test_a_case_of_an_older_version_is_refused_with_a_remedy(tmp_path):
    (tmp_path / "result.json").write_text(json.dumps({"case": "c"}))
    with pytest.raises(BadInput, match="run the case again"):
        explain(tmp_path)


def test_conflicts_of_evidence_and_prior_are_listed_by_attempt(tmp_path):
    run_case(load(ROOT / "configs" / "template.yaml"), Case(DEMO, "c1"), tmp_path, "d1")
    folder = tmp_path / "template" / "c1"
    attempt = folder / "attempts" / "road-01"
    attempt.mkdir(parents=True, exist_ok=True)
    won = {"field": "legs[0].lanes_in", "evidence": "2", "prior": "1", "chosen": "2"}
    lost = {"field": "legs[1].control", "evidence": "stop", "prior": "none", "chosen": "none"}
    (attempt / "attempt.json").write_text(json.dumps({"generation": {"conflicts": [won, lost]}}))
    text = explain(folder)
    assert "Evidence against prior, road-01: 2 tokens; won: evidence 1, prior 1" in text
    assert "legs[0].lanes_in: evidence '2', prior '1' (evidence)" in text
    (attempt / "attempt.json").write_text("[")
    with pytest.raises(BadInput, match=r"attempt\.json"):
        explain(folder)
