"""The product needs nothing of research/, and research/ says what it needs besides."""

import ast
import re
import sys
import tomllib

from tests.packaging.conftest import ROOT
from tests.sources import tree

PRODUCT = ("sgcad_core", "plugins", "flows", "deploy")
OWN = {"research", *PRODUCT}
PACKAGES = {"prefect_dask": "prefect-dask", "PIL": "pillow", "yaml": "pyyaml", "psycopg2": "psycopg2-binary"}
"""Packages that are installed under other names than they are imported by."""
OF_PREFECT = {"asyncpg", "websockets"}
"""Dependencies of Prefect."""
OWN_ENVIRONMENT = {
    "qc_baselib", "qc_opendrive", "qc_openscenario", "commonroad", "commonroad_dc", "metadrive", "antlr4", "srunner",
}  # fmt: skip
"""ASAM's checkers, for which `make qc` makes an environment of their own, and other tools' readers, which need one."""
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def imported(folder):
    """(file, first part of a module) of every import, those within functions included."""
    for file in sorted((ROOT / folder).rglob("*.py")):
        for node in ast.walk(tree(file)):
            if isinstance(node, ast.Import):
                yield from ((file, alias.name.split(".")[0]) for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                yield file, node.module.split(".")[0]


def names(requirements):
    return {re.match(r"[\w-]+", requirement)[0].lower() for requirement in requirements}


def test_no_module_of_the_product_imports_research():
    assert [file for folder in PRODUCT for file, name in imported(folder) if name == "research"] == []


def test_the_extra_names_what_research_imports_and_the_product_does_not_install():
    foreign = {name for _, name in imported("research")} - OWN - OWN_ENVIRONMENT - set(sys.stdlib_module_names)
    needed = {PACKAGES.get(name, name) for name in foreign - OF_PREFECT} - names(PROJECT["dependencies"])
    extras = PROJECT["optional-dependencies"]
    assert needed <= names(extras["research"]) | names(extras["hosts"])


def test_adapters_and_weights_in_gguf_files_can_be_used_with_the_extra_of_research():
    extras = PROJECT["optional-dependencies"]
    assert {*extras["smol"], *extras["adapters"]} <= set(extras["research"])
