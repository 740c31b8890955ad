"""OpenSCENARIO elements with parameters filled in and faults that name file, element and line.

Knows attributes and expressions; no meaning of any element. What parameters make of an attribute is bounded in
length before it is built, so that values that double themselves take no memory.
"""

from __future__ import annotations

import math
import re
from collections import ChainMap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from typing import cast

from sgcad_core.case.records import Finding, Severity
from sgcad_core.errors import InvalidOutput, Unsupported
from sgcad_core.formats.openscenario.reading.budget import TooMuch
from sgcad_core.formats.openscenario.reading.expressions import evaluated
from sgcad_core.formats.openscenario.reading.file_context import SOURCE, FileContext
from sgcad_core.formats.xml import Element

MAX_CHARACTERS = 20_000_000
MAX_VALUE_CHARACTERS = 10_000
"""Longest attribute once its parameters are filled in."""
MAX_PARAMETERS = 5_000
MAX_NUMBER = 1e9
_NAME = re.compile(r"\$(\w+)")


@dataclass(frozen=True, eq=False)
class XmlNode:
    """An element and the parameters in force there."""

    element: Element
    scope: Mapping[str, str]
    book: FileContext = field(default_factory=FileContext)
    declared: bool = False
    """Whether its own parameter declarations are in force already."""

    @property
    def tag(self) -> str:
        """The element's name."""
        return str(self.element.tag)

    def at(self, element: Element) -> XmlNode:
        """Another element of the same file with the same parameters."""
        return XmlNode(element, self.scope, self.book)

    # -------------------------------------------------------------- faults
    def _found(self, what: str, value: str, remedy: str, severity: Severity = "repair") -> Finding:
        name = self.element.get("name")
        file = f" of {self.book.file}" if self.book.file else ""
        where = f"<{self.tag}{f' name={name[:60]!r}' if name else ''}> in line {self.element.sourceline}{file}"
        return Finding(source=SOURCE, severity=severity, what=what, where=where, value=value[:200], remedy=remedy)

    def doubt(self, what: str, value: str = "", remedy: str = "") -> None:
        """Raises a fault in an own file, adds a note in a third-party one: for what other players accept."""
        if self.book.strict:
            raise self.fault(what, value, remedy)
        self.note(what, value, remedy)

    def fault(self, what: str, value: str = "", remedy: str = "") -> InvalidOutput:
        """An error to raise, naming this element, its name attribute, its line and its file."""
        return InvalidOutput.of(self._found(what, value, remedy))

    def unsupported(self, what: str = "", remedy: str = "use timed world polylines") -> Unsupported:
        """The error for what the player does not do."""
        finding = self._found(what or "the player does not support this element", "", remedy)
        return Unsupported(finding.line(), [finding], self.tag)

    def note(self, what: str, value: str = "", remedy: str = "") -> None:
        """Keep a note beside the result: what is played otherwise than the file may mean it. Each place once."""
        self.book.notes.add(self._found(what, value, remedy, "note"))

    def spend(self, what: str, count: float = 1) -> None:
        """Take what something of this element costs from its file's budget. Raises InvalidOutput if it is too much."""
        try:
            self.book.budget.spend(what, count)
        except TooMuch as fault:
            raise self.fault(str(fault), remedy="make it smaller, or cut the file in parts") from fault

    # -------------------------------------------------------------- attributes
    @property
    def name(self) -> str:
        """Its name attribute; empty without one."""
        return self.label("name")

    def label(self, name: str) -> str:
        """An attribute that only names something: as it stands where it is no expression that can be evaluated."""
        try:
            return self.text(name, "")
        except InvalidOutput:
            return str(self.element.get(name))

    def naming(self, name: str) -> str:
        """An attribute that names a parameter, without the `$` that only belongs where one is used."""
        raw = str(self.element.get(name) or "")
        if not raw.startswith("$"):
            return self.text(name)
        self.doubt(f"attribute {name!r} begins with $", raw, "the name is taken without it")
        return raw.lstrip("$")

    def has(self, name: str) -> bool:
        """Whether the attribute is there."""
        return self.element.get(name) is not None

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

    def whole(self, name: str, default: int | None = None) -> int:
        """A whole number, as lane ids are. Raises InvalidOutput otherwise."""
        if default is not None and not self.has(name):
            return default
        text = self.text(name)
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (abs(value) <= MAX_NUMBER and value.is_integer()):
            raise self.fault(f"attribute {name!r} is no whole number", text)
        return int(value)

    def positive(self, name: str) -> float:
        """A finite number above zero."""
        if (value := self.number(name)) <= 0:
            raise self.fault(f"attribute {name!r} must be above 0", f"{value:g}")
        return value

    def limit(self, name: str) -> float:
        """An upper limit that may be missing or larger than anything: infinite then."""
        text = self.text(name, "inf")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if math.isnan(value) or value < 0:
            raise self.fault(f"attribute {name!r} is no limit", text, "write a number from 0 on, or leave it out")
        return value if value < MAX_NUMBER else math.inf

    def flag(self, name: str, default: bool | None = None) -> bool:
        """An xsd:boolean."""
        words = ("true", "false", "1", "0")
        return self.choice(name, words, None if default is None else str(default).lower()) in ("true", "1")

    def choice(self, name: str, known: Iterable[str], default: str | None = None) -> str:
        """One of the known words."""
        if (word := self.text(name, default)) not in (words := tuple(known)):
            raise self.fault(f"attribute {name!r} must be one of {', '.join(words)}", word)
        return word

    # -------------------------------------------------------------- elements
    def children(self, *tags: str) -> list[XmlNode]:
        """Child elements in order, of the given names if any are given."""
        return list(self._children(*tags))

    def _children(self, *tags: str) -> Iterator[XmlNode]:
        found = (e for e in self.element if isinstance(e.tag, str))
        return (self.at(e) for e in found if not tags or e.tag in tags)

    def find(self, *tags: str) -> XmlNode | None:
        """The first child of one of these names."""
        return next(self._children(*tags), None)

    def need(self, *path: str) -> XmlNode:
        """The element down a path of names. Raises InvalidOutput naming what is missing."""
        here = self
        for tag in path:
            child = here.find(tag)
            if child is None:
                has = ", ".join(f"<{c.tag}>" for c in islice(here._children(), 20))
                raise here.fault(f"needs a <{tag}>", has or "nothing")
            here = child
        return here

    def only(self) -> XmlNode:
        """The child of an element that is a choice of one."""
        children = self.children()
        if len(children) != 1:
            raise self.fault("needs exactly one child element", str(len(children)))
        return children[0]

    def either(self, *tags: str) -> XmlNode:
        """The child of one of these names, a <CatalogReference> to one followed. Raises InvalidOutput without."""
        child = self.find(*tags, "CatalogReference")
        if child is None:
            named = " or ".join(f"<{tag}>" for tag in tags)
            raise self.fault(f"needs a {named}, inline or by <CatalogReference>")
        return child.followed(*tags)

    def followed(self, *tags: str) -> XmlNode:
        """Itself with its parameters in force, or the catalog entry that it refers to, which must be one of `tags`."""
        if self.tag != "CatalogReference":
            return self.scoped()
        if self.book.catalogs is None:
            remedy = "play the file from its folder (`sgcad play FILE`), or write the entry inline"
            raise self.unsupported("catalogs are read beside a file only", remedy)
        entry: XmlNode = self.book.catalogs.entry(self)
        if entry.tag not in tags:
            raise self.fault(f"the catalog entry must be a {' or '.join(tags)}", f"<{entry.tag}>")
        return entry

    # -------------------------------------------------------------- parameters
    def scoped(self, given: Mapping[str, str] | None = None) -> XmlNode:
        """The same element with its own parameter declarations in force; `given` values replace declared ones."""
        declared = self.find("ParameterDeclarations")
        if self.declared or (declared is None and not given):
            return self
        given, own = given or {}, dict[str, str]()
        scope = ChainMap(own, cast("dict[str, str]", self.scope))  # not copied: thousands of elements may declare some
        for entry in declared.children("ParameterDeclaration") if declared else ():
            name = entry.naming("name")
            own[name] = given[name] if name in given else XmlNode(entry.element, scope, self.book).text("value", "")
            if len(own) > MAX_PARAMETERS:
                raise entry.fault(f"more than {MAX_PARAMETERS} parameters", remedy="declare fewer")
        return XmlNode(self.element, scope, self.book, declared=True)

    def _resolve(self, raw: str) -> str:
        filled = self._filled(raw)
        if not (filled.startswith("${") and filled.endswith("}")):
            return filled
        try:
            return evaluated(filled[2:-1])
        except ValueError as fault:
            raise self.fault("expression cannot be evaluated", filled, str(fault)) from fault

    def _filled(self, raw: str) -> str:
        """Parameters by their values. The length is bounded before anything is built."""
        length = len(raw) + sum(len(self._parameter(m)) - len(m.group()) for m in _NAME.finditer(raw))
        if length > MAX_VALUE_CHARACTERS:
            what = f"longer than {MAX_VALUE_CHARACTERS} characters once its parameters are filled in"
            raise self.fault(what, f"{length} characters from {raw[:60]}", "let parameters not double each other")
        return _NAME.sub(self._parameter, raw)

    def _parameter(self, match: re.Match[str]) -> str:
        if (name := match.group(1)) not in self.scope:
            known = ", ".join(sorted(self.scope)) or "none"
            raise self.fault("unknown parameter", f"${name}", f"declare it; declared: {known[:500]}")
        return self.scope[name]


def read_root(xosc: str, given: Mapping[str, str] | None = None, book: FileContext | None = None) -> XmlNode:
    """The root of an OpenSCENARIO file with its parameters; `given` replaces declared values.

    Raises InvalidOutput where it is none.
    """
    if len(xosc) > MAX_CHARACTERS:
        raise InvalidOutput(f"xosc: {len(xosc)} characters, at most {MAX_CHARACTERS}: write fewer vertices")
    book = book or FileContext()
    root = XmlNode(book.read(xosc, "xosc"), {}, book)
    if root.tag != "OpenSCENARIO":
        raise root.fault("no OpenSCENARIO file", remedy="the root element is <OpenSCENARIO>")
    return root.scoped(given)
