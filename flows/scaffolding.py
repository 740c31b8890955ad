"""`sgcad plugins new KIND NAME`: a package with one plugin that works, its test, and a config that names it.

The templates are texts in flows/scaffold, one per kind: the module, its test and the lines of a config, separated by
`---`.
"""

from __future__ import annotations

import re
import string
from importlib.metadata import version
from pathlib import Path

import yaml

from sgcad_core import config_extends
from sgcad_core.entry_points import KINDS, catalogue
from sgcad_core.errors import ConfigError
from sgcad_core.near_names import did_you_mean

TEMPLATES = Path(__file__).parent / "scaffold"
IMPORTS = {
    "decoder": ("import pytest",),
    "validator": (
        "import pytest",
        "from sgcad_core.case.records import CrashReport, Evidence, RoadNetwork",
        "from sgcad_core.records.specs import RoadSpec",
    ),
    "report_reader": ("import pytest", "from sgcad_core.errors import BadInput"),
    "backbone": ("from sgcad_core.case.records import Context, Query",),
    "road_writer": (
        "from sgcad_core.formats.sumo.net_xml import parse_net",
        "from sgcad_core.case.records import Context",
    ),
    "scenario_writer": (
        "from sgcad_core.execution.playback import execution_of, played",
        "from sgcad_core.formats.sumo.netconvert import compile_network",
        "from sgcad_core.formats.sumo.plain_xml import plain_xml",
        "from sgcad_core.case.records import Context",
        "from sgcad_core.records.specs import Node, Road, RoadSpec",
    ),
    "driver": ("import pytest", "from sgcad_core.case.driver_io import Seat"),
    "simulator": (
        "from sgcad_core.execution.scenario import compile_scenario",
        "from sgcad_core.formats.sumo.netconvert import compile_network",
        "from sgcad_core.formats.sumo.plain_xml import plain_xml",
        "from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Node, Road, RoadSpec",
    ),
}
"""Imports of a kind's test beside the plugin itself."""
BASES = {"decoder": "mini.yaml"}
"""The config that a kind's example extends; the plugin takes its kind's place."""
BASE = "template.yaml"
"""The same for every other kind."""


def new(kind: str, name: str, into: Path) -> list[Path]:
    """Write the package `<into>/sgcad-<name>`; its files. Raises ConfigError for a wrong kind, name or folder."""
    if kind not in KINDS:
        raise ConfigError(f"unknown kind {kind!r}.{did_you_mean(kind, KINDS)} Kinds: {', '.join(KINDS)}")
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise ConfigError(f"name {name!r}: use lower-case letters, digits and _, a letter first, such as my_{kind}")
    if name in catalogue(kind):
        raise ConfigError(f"{kind} {name!r} is installed already ({catalogue(kind)[name].value}): choose another name")
    folder = into / f"sgcad-{_dist(name)}"
    if folder.exists():
        raise ConfigError(f"{folder} exists already: nothing was written; choose another name or --into")
    files = _files(kind, name)
    for path, content in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(content, encoding="utf-8")
    return [folder / path for path in files]


def _files(kind: str, name: str) -> dict[str, str]:
    class_name = "".join(part.capitalize() for part in name.split("_"))
    module = f"sgcad_{name}"
    given = {"name": name, "Class": class_name, "module": module, "kind": kind}
    text = string.Template((TEMPLATES / f"{kind}.txt").read_text(encoding="utf-8")).substitute(given)
    plugin, test, lines = text.split("\n---\n")  # a driver stands in no config: `sgcad drive --driver NAME`
    return {
        "pyproject.toml": _project(given),
        f"src/{module}.py": plugin + "\n",
        f"tests/test_{name}.py": _test(kind, given, test),
        f"{name}.yaml": _example(kind, yaml.safe_load(lines)),
        "README.md": _readme(given),
    }


def _project(given: dict[str, str]) -> str:
    return string.Template("""\
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "sgcad-$dist"
version = "0.1.0"
description = "A $kind for SG-CADVLM"
requires-python = ">=3.11"
dependencies = ["sg-cadvlm>=$own"]

[project.entry-points."sgcad.$kind"]
$name = "$module:$Class"

[tool.setuptools]
package-dir = {"" = "src"}
py-modules = ["$module"]
""").substitute(given, dist=_dist(given["name"]), own=version("sg-cadvlm"))


def _test(kind: str, given: dict[str, str], test: str) -> str:
    lines = (
        *IMPORTS.get(kind, ()),
        "from sgcad_core.registry import plugin_class",
        f"from {given['module']} import $Class",
    )
    told = string.Template("\n".join(sorted(lines, key=_order))).substitute(given)
    found = f"""

def test_it_is_found_by_its_name():
    assert plugin_class("{kind}", "{given["name"]}") is {given["Class"]}
"""
    return f'"""What the plugin promises."""\n\n{told}\n\n\n{test.strip()}\n{found}'


def _order(line: str) -> tuple[bool, str]:
    return line.startswith("from"), line


def _example(kind: str, lines: dict[str, object] | None) -> str:
    """A config that extends a bundled one, with the plugin in its place."""
    return yaml.safe_dump({config_extends.KEY: BASES.get(kind, BASE), **(lines or {})}, sort_keys=False)


def _dist(name: str) -> str:
    """A plugin's name as indexes write it in that of its package."""
    return name.replace("_", "-")


def _readme(given: dict[str, str]) -> str:
    return string.Template("""\
# sgcad-$dist

A $kind for SG-CADVLM: `src/$module.py`.

    pip install -e .
    python -m pytest tests
    sgcad check $name.yaml
    sgcad run report.txt --config $name.yaml
""").substitute(given, dist=_dist(given["name"])) + (
        f"    sgcad drive runs --driver {given['name']}\n" if given["kind"] == "driver" else ""
    )
