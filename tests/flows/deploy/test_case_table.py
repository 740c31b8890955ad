"""The table of a run's cases, and the names of runs."""

from pathlib import Path
from types import SimpleNamespace

from flows.case.run_case import Ending
from flows.case_files import case_links
from flows.deploy.case_table import CaseTable, in_words, named
from flows.health import Running


def ended(folder, **result):
    """A job and its ending."""
    folder.mkdir(parents=True)
    job = SimpleNamespace(
        case=SimpleNamespace(id=folder.name), config=SimpleNamespace(name="kit"), folder=SimpleNamespace(path=folder)
    )
    return job, Ending({"reason": "", **result})


def test_a_row_has_status_verdict_and_links_to_pages_that_are_served(tmp_path, monkeypatch):
    import os

    import psutil

    monkeypatch.setenv("SGCAD_OUT", str(tmp_path))
    (tmp_path / "services").mkdir()
    born = psutil.Process().create_time()
    Running("mlflow", os.getpid(), born, "http://127.0.0.1:5000", "", "").write(tmp_path / "services")
    table = CaseTable()
    job, ending = ended(
        tmp_path / "nightly" / "kit" / "a", status="generated", account={"verdict": "lacking", "lacking": 1, "told": 4}
    )
    case_links.keep(job.folder.path, {"mlflow": "/#/experiments/1/runs/2"})
    table.add(job, ending)
    table.add(*ended(tmp_path / "kit" / "b|c", status="refused", reason="no road\nis told | at all"))
    first, second = table.rows
    assert first == "| a | kit | generated | lacking | [MLflow](http://127.0.0.1:5000/#/experiments/1/runs/2) |\n"
    assert second.startswith("| b\\|c | kit | refused | no road is told \\| at all | `")
    assert in_words(table.counts) == "1 generated, 1 refused"


def test_names_of_runs_say_config_and_subject():
    assert named("nightly", about=[Path("configs/template.yaml")], more="2026-11-27") == "nightly template 2026-11-27"
    assert named("study", about=["alpha"], more=named("over", about=["x/cases"])) == "study alpha over cases"
    assert named("evaluate", about=["a.yaml", "b.yaml", "c.yaml"]) == "evaluate a, b, ..."
