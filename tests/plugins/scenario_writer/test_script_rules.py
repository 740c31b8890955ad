"""The rules for scripts have no blind spot in the grammar of the running Python."""

import ast
import re

import pytest

from plugins.scenario_writer.sandbox import script_rules
from plugins.scenario_writer.sandbox.script_rules import breaches, parsed

_OLD = {"Num", "Str", "Bytes", "NameConstant", "Ellipsis", "Index", "ExtSlice", "Suite", "AugLoad", "AugStore", "Param"}
"""Names that Python keeps for old programs; its parser makes none of them."""


def _leaves(node):
    below = node.__subclasses__()
    return {node.__name__} if not below else set().union(*map(_leaves, below))


def test_every_node_class_of_this_python_is_allowed_or_refused_by_name():
    allowed, refused = script_rules._ALLOWED_NODES, set(script_rules._REFUSED_NODES)
    assert not allowed & refused
    assert {name for name in _leaves(ast.AST) if hasattr(ast, name)} - _OLD <= allowed | refused


def test_a_node_that_nobody_has_looked_at_is_refused():
    class Novel(ast.stmt):
        pass

    tree = ast.Module([Novel()], [])
    assert [b.value for b in breaches(tree)] == ["Novel"]


@pytest.mark.parametrize(
    "pattern", ["str(format=f)", "object(gi_frame=f)", "str(__class__=f)", "[str(format=f)]", "str() | str(format=f)"]
)
def test_a_class_pattern_obeys_the_rules_of_attributes(pattern):
    found = breaches(parsed(f"match 'a':\n    case {pattern}:\n        f\n"))
    assert found, pattern


@pytest.mark.parametrize(
    "template", ["{.format}", "{0.format}", "{0[a].format!r:>{1}}", "{a.gi_frame}", "{0.real:{1.format}}"]
)
def test_a_template_reads_no_attribute_that_a_dot_may_not(template):
    assert breaches(parsed(f"print({template!r}.format(str, 3, a=4))\n")), template


def test_an_honest_template_is_allowed():
    assert not breaches(parsed("print('{0.real:.2f} of the format {1}'.format(3.0, 4))\n"))


def test_an_honest_class_pattern_is_allowed():
    assert not breaches(parsed("match 3:\n    case int(real=r):\n        print(r)\n"))


def test_every_way_to_write_a_name_is_looked_at():
    """No field of a node that may hold a name is a blind spot: each one is set to a forbidden name in turn."""
    looked_at = set()
    for kind, fields in _NAMING.items():
        for field in fields:
            node = getattr(ast, kind)(**dict.fromkeys(getattr(ast, kind)._fields))
            setattr(node, field, ["gi_frame"] if field in _LISTS else "gi_frame")
            node.lineno = 1
            assert any(b.value == "gi_frame" for b in breaches(ast.Module([node], []))), (kind, field)
            looked_at.add((kind, field))
    assert looked_at == {(kind, field) for kind, field in _fields_of_names() if kind in script_rules._ALLOWED_NODES}


_LISTS = {"names", "kwd_attrs"}
_NAMING = {
    "FunctionDef": ["name"], "ClassDef": ["name"], "Attribute": ["attr"], "Name": ["id"], "arg": ["arg"],
    "keyword": ["arg"], "Global": ["names"], "Nonlocal": ["names"], "ExceptHandler": ["name"], "MatchStar": ["name"],
    "MatchMapping": ["rest"], "MatchAs": ["name"], "MatchClass": ["kwd_attrs"],
}  # fmt: skip


def _fields_of_names():
    """Node class and field of every identifier in the grammar, as the docstrings of `ast` tell it."""
    for name in sorted(_leaves(ast.AST) - _OLD):
        told = re.sub(r"\s+", " ", getattr(getattr(ast, name, None), "__doc__", "") or "")
        for field in re.findall(r"identifier[*?]? (\w+)", told):
            if (name, field) not in {("alias", "name"), ("alias", "asname"), ("ImportFrom", "module")}:
                yield name, field
