"""No module keeps a table of kinds of its own: what is known of a kind stands in its record."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from sgcad_core.kinds import ACTORS, JUNCTIONS
from tests.sources import tree

ROOT = Path(__file__).parents[2]
FOLDERS = ("sgcad_core", "plugins", "flows", "deploy", "research")
HOME = ROOT / "sgcad_core" / "kinds"
MANY = 3
"""Kinds in one literal that make it a table."""
IDS = set(ACTORS), {record.kind for record in JUNCTIONS if record.rule or record.intersections}
ALLOWED = {
    "sgcad_core/formats/commonroad/write.py": "categories of OpenSCENARIO in CommonRoad's words: no kinds of ours",
    "sgcad_core/formats/dsl/write.py": "categories of OpenSCENARIO in the words of its DSL: no kinds of ours",
    "sgcad_core/reading/motion/motion_record.py": "where a vehicle comes from: a side road is no junction",
    "sgcad_core/reading/roads/road_mentions.py": "what words call a road: freeways and crossroads are no junctions",
    "research/generator/crash/crash.py": "odds of made reports: the embedded model learned these kinds alone",
    "research/generator/crash/vehicles.py": "odds of made reports, for the same reason",
    "research/generator/incidents.py": "odds of made incidents, for the same reason",
    "research/benchmarks/scenes/random_roads.py": "odds of random scenes: other kinds would draw other scenes",
    "research/rows/coded_rows.py": "what the codes of a data set mean: no further code will come",
}
"""File -> why it may name many kinds."""


def _texts(nodes: list[ast.expr | None]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        elif isinstance(node, (ast.Tuple, ast.List, ast.Set)):
            yield from _texts(list(node.elts))


def tables(module: ast.AST, ids: set[str]) -> list[int]:
    """Lines of literals that hold many kinds: dicts by key or by value, tuples, lists, sets, chains of comparisons."""
    found = []
    for node in ast.walk(module):
        parts: list[list[ast.expr | None]] = []
        if isinstance(node, (ast.Tuple, ast.List, ast.Set)):
            parts = [list(node.elts)]
        elif isinstance(node, ast.Dict):
            parts = [list(node.keys), list(node.values)]
        elif isinstance(node, ast.BoolOp):
            parts = [[c for v in node.values if isinstance(v, ast.Compare) for c in v.comparators]]
        if any(len(set(_texts(part)) & ids) >= MANY for part in parts):
            found.append(node.lineno)
    return found


def _trees() -> dict[str, ast.Module]:
    """The parsed modules by path."""
    files = [f for folder in FOLDERS for f in sorted((ROOT / folder).rglob("*.py")) if HOME not in f.parents]
    return {str(f.relative_to(ROOT)): tree(f) for f in files}


@pytest.mark.parametrize("ids", IDS, ids=["actors", "junctions"])
def test_no_other_module_has_a_table_of_kinds(ids: set[str]) -> None:
    found = [f"{name}:{line}" for name, read in _trees().items() if name not in ALLOWED for line in tables(read, ids)]
    assert found == [], "ask the record of the kind, or add a field to it (sgcad_core/kinds)"


def test_no_file_is_allowed_a_table_that_has_none() -> None:
    assert [name for name in ALLOWED if not any(tables(tree(ROOT / name), ids) for ids in IDS)] == []


@pytest.mark.parametrize("line", [
    '_MASS = {"car": 1.0, "bus": 2.0, "van": 3.0}', 'known = {"C": "car", "B": "bus", "T": "truck"}',
    'if kind in ("car", "bus", "tram"): pass', 'DRIVEN = frozenset({"car", "van", "bus"})',
    'if kind == "car" or kind == "van" or kind in ("bus",): pass', 'Kind = Literal["car", "suv", "van"]',
])  # fmt: skip
def test_a_table_is_seen(line: str) -> None:
    assert tables(ast.parse(line), set(ACTORS))
