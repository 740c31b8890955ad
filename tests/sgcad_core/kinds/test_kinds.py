"""The closed kinds: one record each, and every place that takes them agrees with it."""

import ast
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import get_args

import pytest

from research.generator.crash.crash import sample_crash
from research.model import answer_grammar
from research.rows import evidence_labels
from sgcad_core import kinds
from sgcad_core.reading.language import rule, values
from sgcad_core.records import specs
from sgcad_core.records.answer_schema import trained_schema
from tests.sources import tree


def test_literals_and_records_are_the_same() -> None:
    assert len(kinds.JUNCTIONS) == len(get_args(kinds.JunctionKind))
    assert {record.kind for record in kinds.JUNCTIONS} == set(get_args(kinds.JunctionKind))
    assert get_args(kinds.RoadKind) == kinds.ROADS == evidence_labels.ROADS
    assert get_args(kinds.Maneuver) == kinds.MANEUVERS == answer_grammar.MANEUVERS
    assert specs.Maneuver is kinds.Maneuver
    assert specs.RoadKind is kinds.RoadKind


@pytest.mark.parametrize(
    ("spec", "digest"),
    [
        (specs.RoadLayout, "59e49856b88e0257"),
        (specs.BehaviorSpec, "9a96298a9a308d6e"),
        (specs.RoadSpec, "b999140401be4731"),
    ],
)
def test_the_schemas_that_the_weights_were_trained_on_stand(spec: type[specs.Spec], digest: str) -> None:
    schema = json.dumps(trained_schema(spec))
    assert hashlib.sha256(schema.encode()).hexdigest()[:16] == digest, "weights must be trained anew"


def test_made_reports_have_the_layouts_of_the_records_with_as_many_legs() -> None:
    legs = {record.layout: record.legs for record in kinds.JUNCTIONS if record.layout}
    seen = set()
    for seed in range(600):
        crash = sample_crash(Random(seed))
        seen.add(crash.layout)
        assert len(crash.legs) == legs[crash.layout], crash.layout
    assert seen == set(legs)


def test_kinds_that_a_text_names_have_wordings() -> None:
    for record in kinds.JUNCTIONS:
        if record.rule:
            assert rule(record.rule).search(f"The crash occurred at {record.called}."), record.kind


def test_every_word_for_a_place_that_cannot_be_drawn_means_a_record_and_every_record_has_a_word() -> None:
    assert set(values("unsupported_place").values()) == {record.kind for record in kinds.UNSUPPORTED}


def test_a_kind_that_there_is_not_is_an_error() -> None:
    with pytest.raises(KeyError, match="cloverleaf"):
        kinds.junction_kind("cloverleaf")  # type: ignore[arg-type]
    with pytest.raises(KeyError, match="t"):
        kinds.unsupported_kind("t")


ROOT = Path(__file__).parents[3]
MADE = "research/generator", "research/model", "research/renderer", "research/rows"
"""Folders of the made reports and what learns from them."""
SPELLED = {kinds.FOUR_LEG, kinds.ROUNDABOUT, kinds.DRIVEWAY, kinds.RAMP}
"""Names of kinds that mean nothing else in the code ("t" and "road" do)."""
OF_FORMATS = {
    "sgcad_core/formats/sumo/net_xml.py", "sgcad_core/formats/sumo/plain_xml.py",
    "sgcad_core/formats/opendrive/write.py", "sgcad_core/formats/osm/street_map.py",
}  # fmt: skip
"""Where `roundabout` is a word of the file format."""


def _literals(module: ast.AST) -> Iterator[ast.Constant]:
    """Texts of the code: no docstrings, no messages, no types."""
    aside: set[int] = set()
    for node in ast.walk(module):
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id == "Literal":
            aside |= {id(inner) for inner in ast.walk(node.slice)}
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            aside.add(id(node.value))
        if isinstance(node, ast.JoinedStr):
            aside |= {id(inner) for inner in ast.walk(node)}
    yield from (n for n in ast.walk(module) if isinstance(n, ast.Constant) and id(n) not in aside)


def _spelled(file: Path) -> list[str]:
    known = SPELLED - ({kinds.ROUNDABOUT} if str(file.relative_to(ROOT)) in OF_FORMATS else set())
    found = [n for n in _literals(tree(file)) if n.value in known]
    return [f"{file.relative_to(ROOT)}:{n.lineno}: {n.value!r}" for n in found]


def test_no_module_outside_the_registry_spells_a_kind() -> None:
    folders = "sgcad_core", "plugins", *MADE, "flows"
    files = [f for folder in folders for f in sorted((ROOT / folder).rglob("*.py"))]
    found = [line for f in files if f.parent != ROOT / "sgcad_core" / "kinds" for line in _spelled(f)]
    assert found == [], "take the name from sgcad_core.kinds"


def test_a_kind_that_is_spelled_is_seen() -> None:
    module = ast.parse('"""ramp"""\nKind = Literal["ramp"]\nif road.kind in ("ramp", "driveway"):\n    pass\n')
    assert [n.lineno for n in _literals(module) if n.value in SPELLED] == [3, 3]


LAYOUTS = {record.layout for record in kinds.JUNCTIONS if record.layout} | {kinds.ROAD}
"""Names that mean something else too, so that they are looked for where a kind or a layout is asked for."""


def _asked(module: ast.AST) -> list[int]:
    """Lines that compare a layout or a kind of road with a text, or make one of such a text."""
    found = []
    for node in ast.walk(module):
        if not isinstance(node, (ast.Compare, ast.Dict, ast.keyword, ast.AnnAssign)):
            continue
        names = {getattr(n, "attr", getattr(n, "id", None)) for n in ast.walk(node)} | {getattr(node, "arg", None)}
        texts = {n.value for n in ast.walk(node) if isinstance(n, ast.Constant) and isinstance(n.value, str)}
        keyed = isinstance(node, ast.Dict) and len(LAYOUTS & texts) > 1
        if LAYOUTS & texts and (keyed or ({"layout", "kind"} & names and not isinstance(node, ast.Dict))):
            found.append(node.lineno)
    return found


def test_the_generator_spells_no_layout_and_no_kind_of_road() -> None:
    files = [f for folder in MADE for f in sorted((ROOT / folder).rglob("*.py"))]
    found = [f"{f.relative_to(ROOT)}:{n}" for f in files for n in _asked(tree(f))]
    assert found == [], "take the name from sgcad_core.kinds"


@pytest.mark.parametrize("line", [
    'crash.layout == "plain"', 'layout in ("four", "t")', 'odds = {"plain": 1.0, "four": 2.0}', 'leg.kind != "road"',
    'replace(crash, layout="plain")', 'kind: str = "road"',
])  # fmt: skip
def test_a_layout_that_is_spelled_is_seen(line: str) -> None:
    assert _asked(ast.parse(line)) == [1]
