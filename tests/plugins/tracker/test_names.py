"""docs/mlflow.md lists the names of the figures: what is really logged bears no other, and each of them is logged."""

import json
import re

import pytest

from plugins.tracker.figures import attempt_figures, case_figures, means
from plugins.tracker.headline import headline
from plugins.tracker.mlflow import _steps
from sgcad_core.settings import ROOT


def listed():
    text = (ROOT / "docs" / "mlflow.md").read_text(encoding="utf-8")
    rows = text.split("<!-- names:")[1].split("<!-- end of names -->")[0].splitlines()
    cells = [row.split("|")[1] for row in rows if row.startswith("|")]
    return [name for cell in cells for name in re.findall(r"`([^`]+)`", cell)]


def pattern(name):
    return re.sub(r"<\w+>", r"\\S+", re.escape(name).replace(r"\<", "<").replace(r"\>", ">"))


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    """Figures of a real case: a demo report through the real chain, with a grounded answer added."""
    from flows.case.run_case import run_case
    from flows.case_files.find_cases import Case
    from sgcad_core.config import load

    out, report = tmp_path_factory.mktemp("out"), ROOT / "docs" / "demo" / "rear-end-on-arterial"
    ending = run_case(load("template.yaml", ("tracker=none", "drive.drivers=aeb")), Case(report, "c1"), out, "digest")
    folder = out / "template" / "c1"
    result = ending.result | {"grounding": {"road.$.legs": 0.5}}
    assert json.loads((folder / "result.json").read_text())["status"] == "generated"
    assert list(attempt_figures(folder))
    asked = folder / "attempts" / "road-01" / "attempt.json"
    generation = {"prompt_tokens": 1, "answer_tokens": 1, "model_calls": 1}
    asked.write_text(json.dumps(json.loads(asked.read_text()) | {"generation": generation}))
    figures = case_figures(folder, result)
    return {name for step in _steps(folder, result).values() for name in step} | set(
        headline(means([figures])) | means([figures])
    )


def test_every_figure_that_is_logged_is_listed(logged):
    known = [re.compile(pattern(name)) for name in listed()]
    assert not {name for name in logged if not any(k.fullmatch(name) for k in known)}


def test_every_listed_figure_is_logged(logged):
    assert len(listed()) > 15
    assert not [name for name in listed() if not any(re.fullmatch(pattern(name), found) for found in logged)]
