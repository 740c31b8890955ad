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
    assert text.startswith("c1 (template)")
    assert "vehicles.V1.start_lane = " in text
    assert "roads." in text.partition("Inferred:")[2]


def test_a_case_of_an_older_version_is_refused_with_a_remedy(tmp_path):
    (tmp_path / "result.json").write_text(json.dumps({"case": "c"}))
    with pytest.raises(BadInput, match="run the case again"):
        explain(tmp_path)
