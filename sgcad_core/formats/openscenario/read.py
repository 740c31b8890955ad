"""OpenSCENARIO elements with parameters filled in and faults that name element and line.

Knows attributes and expressions; no meaning of any element.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.xml import Element, parse_xml
from sgcad_core.records import Finding

SOURCE = "openscenario"
MAX_CHARACTERS = 20_000_000
MAX_NUMBER = 1e9
_NAME = re.compile(r"\$(\w+)")
_OPERATORS: dict[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Mod: operator.mod, ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "round": round, "floor": math.floor, "ceil": math.ceil, "sqrt": math.sqrt, "pow": math.pow,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Node:
    """An element and the parameters in force there."""

    element: Element
    scope: Mapping[str, str]

    @property
    def tag(self) -> str:
        """The element's name."""
        return str(self.element.tag)

    def fault(self, what: str, value: str = "", remedy: str = "") -> InvalidOutput:
        """An error to raise, naming this element, its name attribute and its line."""
        name = self.element.get("name")
        where = f"<{self.tag}{f' name={name!r}' if name else ''}> in line {self.element.sourceline}"
        finding = Finding(source=SOURCE, what=what, where=where, value=value[:200], remedy=remedy)
        return InvalidOutput(finding.line(), [finding])

    def unsupported(self, what: str = "") -> InvalidOutput:
        """The error for what the player does not do."""
        return self.fault(what or "the player does not support this element", remedy="use timed world polylines")

    def text(self, name: str, default: str | None = None) -> str:
        """An attribute with parameters filled in. Raises InvalidOutput where it is missing without default."""
        raw = self.element.get(name)
        if raw is None:
            if default is None:
                raise self.fault(f"attribute {name!r} is missing")
            return default
        return self._resolve(raw) if "$" in raw else str(raw)

    def number(self, name: str, default: float | None = None) -> float:
        """A finite number. Raises InvalidOutput otherwise."""
        if default is not None and self.element.get(name) is None:
            return default
        text = self.text(name)
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.fault(f"attribute {name!r} is no finite number", text)
        if abs(value) > MAX_NUMBER:
            raise self.fault(f"attribute {name!r} must lie within +-{MAX_NUMBER:g}", text)
        return value

    def positive(self, name: str) -> float:
        """A finite number above zero."""
        if (value := self.number(name)) <= 0:
            raise self.fault(f"attribute {name!r} must be above 0", f"{value:g}")
        return value

    def flag(self, name: str, default: bool | None = None) -> bool:
        """An xsd:boolean."""
        words = ("true", "false", "1", "0")
        return self.choice(name, words, None if default is None else str(default).lower()) in ("true", "1")

    def choice(self, name: str, known: tuple[str, ...], default: str | None = None) -> str:
        """One of the known words."""
        if (word := self.text(name, default)) not in known:
            raise self.fault(f"attribute {name!r} must be one of {', '.join(known)}", word)
        return word

    def children(self, *tags: str) -> list[Node]:
        """Child elements in order, of the given names if any are given."""
        found = (e for e in self.element if isinstance(e.tag, str))
        return [Node(e, self.scope) for e in found if not tags or e.tag in tags]

    def find(self, tag: str) -> Node | None:
        """The first child of that name."""
        return next(iter(self.children(tag)), None)

    def need(self, *path: str) -> Node:
        """The element down a path of names. Raises InvalidOutput naming what is missing."""
        here = self
        for tag in path:
            child = here.find(tag)
            if child is None:
                raise here.fault(f"needs a <{tag}>", ", ".join(f"<{c.tag}>" for c in here.children()) or "nothing")
            here = child
        return here

    def only(self) -> Node:
        """The child of an element that is a choice of one."""
        children = self.children()
        if len(children) != 1:
            raise self.fault("needs exactly one child element", str(len(children)))
        return children[0]

    def scoped(self) -> Node:
        """The same element with its own parameter declarations in force."""
        declared = self.find("ParameterDeclarations")
        if declared is None:
            return self
        scope = dict(self.scope)
        for entry in declared.children("ParameterDeclaration"):
            scope[entry.text("name")] = Node(entry.element, scope).text("value")
        return Node(self.element, scope)

    def _resolve(self, raw: str) -> str:
        if raw.startswith("${") and raw.endswith("}"):
            return self._evaluate(raw[2:-1])
        return _NAME.sub(self._parameter, raw)

    def _parameter(self, match: re.Match[str]) -> str:
        if (name := match.group(1)) not in self.scope:
            known = ", ".join(sorted(self.scope)) or "none"
            raise self.fault("unknown parameter", f"${name}", f"declare it; declared: {known}")
        return self.scope[name]

    def _evaluate(self, expression: str) -> str:
        filled = _NAME.sub(self._parameter, expression)
        try:
            if len(filled) > 200:
                raise ValueError("longer than 200 characters")
            return repr(float(_value(ast.parse(filled.strip(), mode="eval").body)))
        except (ValueError, SyntaxError, ArithmeticError, TypeError, RecursionError) as fault:
            raise self.fault("expression cannot be evaluated", filled, str(fault)) from fault


def _value(node: Any) -> float:
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return node.value
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        return _OPERATORS[type(node.op)](_value(node.left), _value(node.right))
    if isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
        return _OPERATORS[type(node.op)](_value(node.operand))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _FUNCTIONS:
        return _FUNCTIONS[node.func.id](*map(_value, node.args))
    raise ValueError(f"{type(node).__name__} is not allowed")


def read_root(xosc: str) -> Node:
    """The root of an OpenSCENARIO file with its parameters. Raises InvalidOutput where it is none."""
    if len(xosc) > MAX_CHARACTERS:
        raise InvalidOutput(f"xosc: {len(xosc)} characters, at most {MAX_CHARACTERS}: write fewer vertices")
    root = Node(parse_xml(xosc, "xosc"), {})
    if root.tag != "OpenSCENARIO":
        raise root.fault("no OpenSCENARIO file", remedy="the root element is <OpenSCENARIO>")
    return root.scoped()
