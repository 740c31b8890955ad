"""The documentation: every link leads somewhere, the site builds, the page of figures stays a page."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]
LINK = re.compile(r"\]\((?!https?://|#|mailto:)([^)#\s]+)(?:#[^)]*)?\)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_link_leads_to_a_file(page):
    generated = {"reference/command-line.md", "reference/plugins.md", "reference/interfaces.md"}
    gone = [link for link in LINK.findall(page.read_text()) if not (page.parent / link).exists()]
    assert [link for link in gone if link not in generated] == []


def test_the_navigation_names_pages_that_are_there_and_misses_none():
    def files(part):
        for entry in part if isinstance(part, list) else part.values():
            yield from [entry] if isinstance(entry, str) else files(entry)

    named = set(files(yaml.safe_load((ROOT / "mkdocs.yml").read_text())["nav"]))
    there = {str(page.relative_to(ROOT / "docs")) for page in PAGES[2:]}
    there = {name for name in there if not name.startswith("demo/")}
    assert named - there == {"reference/command-line.md", "reference/plugins.md", "reference/interfaces.md"}
    assert there - named == set()


def test_the_figures_fit_on_a_page_and_each_has_its_command_and_date():
    text = (ROOT / "docs" / "results.md").read_text()
    assert len(text.splitlines()) <= 80
    for section in text.split("\n## ")[1:]:
        assert re.search(r"`(?:sgcad|python -m|make) ", section), section.splitlines()[0]
        assert re.search(r"\d{1,2} (?:November|December) 20\d\d", section)


@pytest.mark.slow
@pytest.mark.skipif(not importlib.util.find_spec("mkdocs"), reason="mkdocs is not installed: pip install -e '.[docs]'")
def test_the_site_builds_without_a_warning(tmp_path):
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", tmp_path]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    assert "evidence_gate" in (tmp_path / "reference" / "plugins.html").read_text()
    assert "sgcad study" in (tmp_path / "reference" / "command-line.html").read_text()
