"""The look at MLflow's pages says what it lacks before it starts anything."""

import importlib.util
import shutil
import sys

import pytest

from sgcad_core.settings import ROOT


@pytest.fixture
def pages(monkeypatch):
    """deploy/pages.py as a module; `pages.run(...)` is its command line."""
    spec = importlib.util.spec_from_file_location("sgcad_deploy_pages", ROOT / "deploy" / "pages.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["pages.py", *map(str, arguments)])
        return module.main()

    module.run = run
    return module


def test_a_machine_without_chromium_is_told_so(pages, monkeypatch, capsys):
    monkeypatch.setenv("PATH", "")
    assert pages.run("runs/mlflow.db") == 3
    assert "no Chromium on this machine" in capsys.readouterr().err


def test_a_database_that_is_not_there_is_named(pages, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(pages, "browser_program", lambda: "chromium")
    assert pages.run(tmp_path / "none.db") == 2
    assert "none.db: no such database; run `sgcad study`" in capsys.readouterr().err


@pytest.mark.skipif(not shutil.which("chromium"), reason="no Chromium on this machine: apt-get install chromium")
@pytest.mark.slow
def test_a_word_that_a_page_does_not_show_is_missing(pages, tmp_path):
    page = tmp_path / "page.html"
    page.write_text("<button onclick='this.innerText=\"shut\"'>Close</button><input value='typed'><p>shown</p>")
    with pages.browsing(pages.browser_program()) as browser:
        assert browser.missing(page.as_uri(), ("shown", "typed", "shut"), 60.0) == []
        assert browser.missing(page.as_uri(), ("shown", "absent"), 1.0) == ["absent"]
        browser.shot(tmp_path / "shot.png")
    assert (tmp_path / "shot.png").read_bytes().startswith(b"\x89PNG")
