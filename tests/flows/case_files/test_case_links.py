"""A case's links: kept in its folder, read back only where they are links, joined with what is served now."""

import json
import os
from types import SimpleNamespace

import pytest

from flows import health
from flows.batch import prefect_case_end
from flows.case_files import case_links
from flows.case_files.case_links import Served
from flows.desk.links import Links
from flows.health import Running

MLFLOW = "/#/experiments/1/runs/abc"


@pytest.fixture
def folder(tmp_path):
    """A case's folder in a results folder."""
    made = tmp_path / "runs" / "kit" / "c1"
    made.mkdir(parents=True)
    return made


def service(name, address, pid=None):
    """A service that runs: this very process."""
    import psutil

    pid = pid or os.getpid()
    born = psutil.Process(pid).create_time() if psutil.pid_exists(pid) else 0.0
    return Running(name, pid, born, address, "", "")


def test_links_are_added_and_what_is_none_is_not_read(folder):
    case_links.keep(folder, {"prefect": "http://127.0.0.1:4200/runs/flow-run/1"})
    case_links.keep(folder, {"mlflow": MLFLOW})
    assert case_links.kept(folder) == {"prefect": "http://127.0.0.1:4200/runs/flow-run/1", "mlflow": MLFLOW}
    bad = {"prefect": "javascript:alert(1)", "mlflow": "//elsewhere.org/x", "prefect_case": 5, "desk": "http://x"}
    (folder / case_links.FILE).write_text(json.dumps(bad))
    assert case_links.kept(folder) == {}
    (folder / case_links.FILE).write_text("{")
    assert case_links.kept(folder) == {}


def test_a_folder_that_was_removed_has_no_links(folder):
    folder.rmdir()
    case_links.keep(folder, {"mlflow": MLFLOW})
    assert not folder.exists()


@pytest.mark.parametrize(("link", "where", "found"), [
    (MLFLOW, "http://127.0.0.1:5000", f"http://127.0.0.1:5000{MLFLOW}"),
    (MLFLOW, "", ""),
    ("http://a:1/runs/1", "", "http://a:1/runs/1"),
    ("http://a:1/runs/1", "https://b", "https://b/runs/1"),
])  # fmt: skip
def test_a_link_is_told_where_its_page_is_served(link, where, found):
    assert case_links.resolved(link, where) == found


def test_services_that_run_are_found_and_those_that_ended_are_not(folder):
    out = folder.parent.parent
    services = health.services_folder(out)
    services.mkdir()
    service("server", "http://127.0.0.1:4200").write(services)
    service("mlflow", "http://127.0.0.1:5000", pid=2**22 + 1).write(services)
    (services / "worker.json").write_text("{")
    assert case_links.served(out) == Served()
    (services / "worker.json").unlink()
    assert case_links.served(out) == Served(prefect="http://127.0.0.1:4200")


def test_an_open_desk_is_found_from_the_results_below_it_and_forgotten_when_it_closes(folder):
    out = folder.parent.parent
    with case_links.noted_desk(out.parent, "http://127.0.0.1:8321"):
        found = case_links.served(out)
        assert found.case_page(folder) == "http://127.0.0.1:8321/case/runs/kit/c1"
        assert found.case_page(out.parent.parent) == ""
    assert case_links.served(out).case_page(folder) == ""
    assert not (out.parent / case_links.DESK).exists()


def test_the_desk_shows_the_links_that_it_can_reach(folder):
    root = folder.parent.parent
    case_links.keep(folder, {"prefect": "/runs/flow-run/1", "prefect_case": "/runs/task-run/2", "mlflow": MLFLOW})
    assert Links(root).of("kit/c1", "kit", "c1") == []
    assert Links(root, "http://m", "http://p").of("kit/c1", "kit", "c1") == [
        ("Prefect", "http://p/runs/task-run/2"), ("Prefect graph", "http://p/runs/flow-run/1"),
        ("MLflow", f"http://m{MLFLOW}"),
    ]  # fmt: skip


# ------------------------------------------------------------------ the artifact
RESULT = {
    "status": "generated", "reason": "", "near_crash": None,
    "collision": {"declared": None, "observed": None, "realised": False},
    "account": {"verdict": "lacking", "told": 3, "has": 2, "lacking": 1, "assumed": 4, "items": [
        {"kind": "lacks", "text": "a <b>stop</b> sign", "reason": "", "start": 0}]},
}  # fmt: skip


def test_an_artifact_tells_the_verdict_the_counts_and_what_lacks_without_markup(folder):
    case_links.keep(folder, {"mlflow": MLFLOW})
    text = prefect_case_end.markdown(folder, RESULT, Served(mlflow="http://m"))
    assert text.startswith("# c1: generated, 1 of 3 told lacking\n")
    assert "| 3 | 2 | 1 | 4 |" in text
    assert r"Lacking: a \<b\>stop\</b\> sign." in text
    assert f"[MLflow run](http://m{MLFLOW})" in text
    assert "](data:image" not in text


def test_an_artifact_of_a_refused_case_tells_why(folder):
    text = prefect_case_end.markdown(
        folder, RESULT | {"status": "refused", "reason": "no contact", "account": None}, Served()
    )
    assert "# c1: refused" in text
    assert "no contact" in text


@pytest.mark.parametrize(("name", "key"), [("kit/Case 1_a", "kit-case-1-a"), ("Ü/", "case"), ("x" * 300, "x" * 200)])
def test_a_key_is_one_that_prefect_takes(name, key):
    assert prefect_case_end.artifact_key(name) == key


def test_a_case_that_is_logged_by_a_later_batch_links_to_its_run(folder, monkeypatch):
    """Its own batch ended before; a case that nobody logs now keeps what it has."""
    from flows.batch import prefect_case_end
    from flows.batch.tracking import track_cases

    monkeypatch.setattr(track_cases, "track_safely", lambda job, ending: "")
    pages = {"c1": MLFLOW}
    tracker = SimpleNamespace(page=lambda config, case: pages.pop(case, ""))
    job = SimpleNamespace(
        folder=SimpleNamespace(path=folder), config=SimpleNamespace(name="kit", tracker=tracker),
        case=SimpleNamespace(id="c1"),
    )  # fmt: skip
    for _ in range(2):
        assert prefect_case_end.CaseReporter(False, None).former(job, SimpleNamespace(reused=True)) == ""
        assert case_links.kept(folder) == {"mlflow": MLFLOW}


def test_a_full_disk_leaves_no_piece_of_the_links(tmp_path, monkeypatch):
    def full(self, text, **_):
        self.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(type(tmp_path), "write_text", full)
    case_links.keep(tmp_path, {"mlflow": "/#/experiments/1/runs/1"})
    assert list(tmp_path.iterdir()) == []
