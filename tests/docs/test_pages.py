"""The documentation: every link leads somewhere, the site builds, the page of figures stays a page."""

import ast
import importlib
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]
SOURCES = ("research", "sgcad_core", "plugins", "flows", "deploy", "tests")
WRITTEN = [
    *(page for page in PAGES if page.name != "CHANGELOG.md" and "history" not in page.parts),
    ROOT / "Makefile", ROOT / "CONTRIBUTING.md", ROOT / "plugins" / "backbone" / "mini" / "weights" / "README.md",
    *(file for folder in SOURCES for file in sorted((ROOT / folder).rglob("*.py"))),
]  # fmt: skip
OURS = ("sgcad_core", "plugins", "flows", "research")
COMMAND = re.compile(r"python -m\s+(?:\\\s+)?(research[\w.]*\w)")
RESEARCH = re.compile(r"(?<![\w/.])research/[\w/.]*\w|(?<![\w/.])research(?:\.\w+)+")
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


@pytest.mark.parametrize("script", sorted((ROOT / "docs").glob("*.py")), ids=lambda script: script.name)
def test_a_script_of_the_documentation_imports_names_that_are_there(script):
    """The hook of the site needs packages that the tests do not have: only its imports are tested here."""
    for node in ast.walk(ast.parse(script.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in OURS:
            module = importlib.import_module(node.module)
            assert [name.name for name in node.names if not hasattr(module, name.name)] == [], node.module


def _module(name):
    file = ROOT.joinpath(*name.split("."))
    return next((f for f in (file.with_suffix(".py"), file / "__main__.py") if f.is_file()), None)


def _is_there(name):
    if "/" in name:
        return (ROOT / name).exists()
    if ROOT.joinpath(*name.split(".")).is_dir() or _module(name):
        return True
    module, _, attribute = name.rpartition(".")
    file = _module(module) or ROOT.joinpath(*module.split("."), "__init__.py")
    return file.is_file() and re.search(rf"\b{attribute}\b", file.read_text()) is not None


def test_a_command_of_research_that_is_named_is_there():
    named = {(str(file.relative_to(ROOT)), name) for file in WRITTEN for name in COMMAND.findall(file.read_text())}
    assert len(named) > 40
    gone = [
        (file, name)
        for file, name in sorted(named)
        if not (module := _module(name)) or '__name__ == "__main__"' not in module.read_text()
    ]
    assert gone == []


def test_a_module_or_folder_of_research_that_is_named_is_there():
    named = {(str(file.relative_to(ROOT)), name) for file in WRITTEN for name in RESEARCH.findall(file.read_text())}
    assert [(file, name) for file, name in sorted(named) if not _is_there(name)] == []


@pytest.mark.slow
@pytest.mark.skipif(not importlib.util.find_spec("mkdocs"), reason="mkdocs is not installed: pip install -e '.[docs]'")
def test_the_site_builds_without_a_warning(tmp_path):
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", tmp_path]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    assert "evidence_gate" in (tmp_path / "reference" / "plugins.html").read_text()
    assert "sgcad study" in (tmp_path / "reference" / "command-line.html").read_text()
