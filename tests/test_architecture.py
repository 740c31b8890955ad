"""The architecture is a test: catalogue, imports, configs, sizes and the README's tree."""

import ast
import graphlib
import re
import subprocess
import sys
import tomllib
from collections import Counter
from importlib.metadata import entry_points
from pathlib import Path
from statistics import median, quantiles

import pytest

from flows.study import plan
from flows.study_file import spec
from sgcad_core import config, registry, settings
from sgcad_core.interfaces import Plugin
from tests.sources import tree

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted(p for d in ("sgcad_core", "plugins", "flows", "research") for p in (ROOT / d).rglob("*.py"))
STUDIES = sorted((ROOT / "configs" / "studies").glob("*.yaml"))
CONFIGS = sorted(set((ROOT / "configs").rglob("*.yaml")) - set(STUDIES))
MOST_MODULES = 15
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


@pytest.mark.parametrize("kind", registry.BASES)
def test_a_kind_has_one_word_in_all_places(kind):
    assert (ROOT / "plugins" / kind).is_dir()
    assert (ROOT / "tests" / "plugins" / kind).is_dir()
    assert f"sgcad.{kind}" in PROJECT["project"]["entry-points"]
    assert registry.BASES[kind].__name__ == "".join(w.capitalize() for w in kind.split("_"))


@pytest.mark.parametrize("kind", registry.BASES)
def test_every_plugin_class_in_a_folder_is_in_the_catalogue_and_back(kind):
    listed = set(PROJECT["project"]["entry-points"][f"sgcad.{kind}"].values())
    installed = {p.value for p in entry_points(group=f"sgcad.{kind}")}
    assert listed <= installed, "pyproject.toml has changed: pip install -e . again"
    found = set()
    for file in (ROOT / "plugins" / kind).glob("*.py"):
        module = f"plugins.{kind}.{file.stem}"
        if any(value.startswith(module + ":") for value in listed):
            loaded = sys.modules.get(module) or __import__(module, fromlist=["_"])
            found |= {
                f"{module}:{name}"
                for name, item in vars(loaded).items()
                if isinstance(item, type) and issubclass(item, Plugin) and item.__module__ == module
                and not getattr(item, "__abstractmethods__", None)
            }  # fmt: skip
    assert found == listed


@pytest.mark.parametrize("file", CONFIGS, ids=lambda f: str(f.relative_to(ROOT / "configs")))
def test_every_config_loads(file):
    assert config.load(file).name


@pytest.mark.parametrize("file", STUDIES, ids=lambda f: f.stem)
def test_every_study_loads_with_all_its_arms(file, tmp_path):
    study = spec.load_study(file)
    assert [c.name for c in plan.arms_of(study, tmp_path)] == [arm.name for arm in study.arms]


def test_the_default_config_exists():
    assert (settings.CONFIGS / settings.default_config()).is_file()


def test_imports_keep_their_order():
    done = subprocess.run([Path(sys.executable).parent / "lint-imports"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    ("package", "strangers"),
    [
        ("sgcad_core", {"prefect", "mlflow", "torch", "transformers", "lancedb", "libsumo"}),
        ("plugins", {"prefect"}),
        ("flows", {"torch", "transformers", "lancedb", "libsumo", "mlflow", "plugins"}),
    ],
)
def test_a_package_imports_no_stranger(package, strangers):
    for file in (ROOT / package).rglob("*.py"):
        for node in ast.walk(tree(file)):
            names = (
                [a.name for a in node.names] if isinstance(node, ast.Import)
                else [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            )  # fmt: skip
            assert not strangers & {n.split(".")[0] for n in names}, f"{file}:{node.lineno}"


@pytest.mark.parametrize("file", SOURCES, ids=lambda f: str(f.relative_to(ROOT)))
def test_a_file_is_short_and_says_what_it_is(file):
    assert len(file.read_text().splitlines()) <= 300
    assert ast.get_docstring(tree(file))


def test_docstrings_speak_of_things_not_of_whoever():
    """Docstrings of specs that a model reads are prompts, which keep their words."""
    pronoun = re.compile(r"\b(whoever|whom|nobody|somebody|anybody|everybody)\b|^Who\b", re.IGNORECASE)
    files = [file for file in SOURCES if file != ROOT / "sgcad_core" / "records" / "specs.py"]
    found = [
        f"{file.relative_to(ROOT)}: {getattr(node, 'name', 'module')}"
        for file in files
        for node in ast.walk(tree(file))
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        and pronoun.search(ast.get_docstring(node) or "")
    ]
    assert found == []


def test_functions_are_short():
    lengths = [
        n.end_lineno - n.lineno + 1 for file in SOURCES for n in ast.walk(tree(file)) if isinstance(n, ast.FunctionDef)
    ]
    assert median(lengths) <= 10
    assert quantiles(lengths, n=10)[-1] <= 30


def test_a_folder_holds_at_most_fifteen_modules():
    kinds = {ROOT / "plugins" / kind for kind in registry.BASES}
    counts = Counter(file.parent for file in SOURCES if file.name != "__init__.py")
    crowded = {str(f.relative_to(ROOT)): n for f, n in counts.items() if n > MOST_MODULES and f not in kinds}
    assert crowded == {}


def test_no_modules_import_each_other():
    modules = {".".join(f.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): f for f in SOURCES}
    imports = {name: _imported(file, modules) - {name} for name, file in modules.items()}
    with pytest.raises(graphlib.CycleError, match="cycle"):  # the check itself works
        graphlib.TopologicalSorter({"a": {"b"}, "b": {"a"}}).prepare()
    graphlib.TopologicalSorter(imports).prepare()


def _imported(file, modules):
    """Names of the project's modules that a file imports anywhere in it, also inside functions."""
    found = set()
    for node in ast.walk(tree(file)):
        if isinstance(node, ast.ImportFrom) and node.module:
            names = (f"{node.module}.{alias.name}" for alias in node.names)
            found |= {name if name in modules else node.module for name in names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return found & set(modules)


@pytest.mark.parametrize("package", ["sgcad_core", "flows", "research", "sgcad_core/reading"])
def test_the_page_on_the_architecture_names_every_folder(package):
    page = (ROOT / "docs" / "architecture.md").read_text()
    folders = {f.parent.name for f in (ROOT / package).glob("*/__init__.py")}
    assert {name for name in folders if f"`{name}/`" not in page and f"/{name}/`" not in page} == set()


def test_the_tree_in_the_readme_is_the_tree():
    readme = (ROOT / "README.md").read_text()
    block = re.search(r"```\n(pyproject\.toml.*?)```", readme, re.DOTALL)
    assert block, "README.md has no tree"
    named = set(re.findall(r"^(?! )([\w.]+)/?\s", block.group(1), re.MULTILINE))
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    top = {p.split("/")[0] for p in tracked.splitlines() if not p.startswith(".")}
    prose = {"README.md", "LICENSE", "CHANGELOG.md", "CONTRIBUTING.md"}
    assert named == top - prose


def test_ci_runs_the_tests_that_make_test_leaves_out():
    rules = dict(re.findall(r"^(test|test-slow): setup .*\n\t(.*)", (ROOT / "Makefile").read_text(), re.MULTILINE))
    assert rules["test"].replace('-m "not slow"', "-m slow") == rules["test-slow"]
    lines = (ROOT / ".ci" / "run").read_text().splitlines()
    assert {"make test", "make test-slow"} <= set(lines)
    assert "set -euo pipefail" in lines


def test_import_costs_nothing_heavy():
    heavy = ("torch", "prefect", "mlflow", "lancedb", "pypdf")
    modules = "sgcad_core.config, flows.cli, plugins.report_reader.auto"
    code = f"import sys, {modules}; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
