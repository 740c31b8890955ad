"""The look at MLflow's pages says what it lacks before it starts anything."""

import shutil
import sys

import pytest

from research.checks import mlflow_pages


@pytest.fixture
def run(monkeypatch):
    """The command line of the look at MLflow's pages."""

    def command(*arguments):
        monkeypatch.setattr(sys, "argv", ["mlflow_pages", *map(str, arguments)])
        return mlflow_pages.main()

    return command


def test_a_machine_without_chromium_is_told_so(run, monkeypatch, capsys):
    monkeypatch.setenv("PATH", "")
    assert run("runs/mlflow.db") == 3
    assert "no Chromium on this machine" in capsys.readouterr().err


def test_a_database_that_is_not_there_is_named(run, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(mlflow_pages, "browser_program", lambda: "chromium")
    assert run(tmp_path / "none.db") == 2
    assert "none.db: no such database; run `sgcad study`" in capsys.readouterr().err


@pytest.mark.skipif(not shutil.which("chromium"), reason="no Chromium on this machine: apt-get install chromium")
@pytest.mark.slow
def test_a_word_that_a_page_does_not_show_is_missing(run, tmp_path):
    page = tmp_path / "page.html"
    page.write_text("<button onclick='this.innerText=\"shut\"'>Close</button><input value='typed'><p>shown</p>")
    with mlflow_pages.browsing(mlflow_pages.browser_program()) as browser:
        assert browser.missing(page.as_uri(), ("shown", "typed", "shut"), 60.0) == []
        assert browser.missing(page.as_uri(), ("shown", "absent"), 1.0) == ["absent"]
        browser.shot(tmp_path / "shot.png")
    assert (tmp_path / "shot.png").read_bytes().startswith(b"\x89PNG")
