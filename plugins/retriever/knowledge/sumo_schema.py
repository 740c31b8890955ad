"""SUMO's plain-XML elements and attributes as chunks, read from the installed schemas and sumo_xml_words.yaml.

One chunk for each element (attributes with types and allowed values, child elements, an example), and one for each
attribute that sumo_xml_words.yaml explains. Knows no database.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import yaml
from lxml import etree

from plugins.retriever.knowledge.chunk import Chunk, Task
from sgcad_core import settings
from sgcad_core.errors import MissingTool

XSD = "{http://www.w3.org/2001/XMLSchema}"
FILES: dict[str, tuple[Task, ...]] = {
    "nodes": ("road",), "edges": ("road",), "connections": ("road",), "types": ("road",), "tllogic": ("road",),
    "routes": ("scenario",), "additional": ("scenario",),
}  # fmt: skip
_BASE = {
    "xsd:string": "text", "xsd:int": "integer", "xsd:integer": "integer", "xsd:nonNegativeInteger": "integer >= 0",
    "xsd:positiveInteger": "integer >= 1", "floatType": "number", "positiveFloatType": "number > 0",
    "nonNegativeFloatType": "number >= 0", "boolType": "true or false", "idType": "name without blanks",
    "shapeType": "points x,y x,y", "xsd:float": "number", "timeType": "time in s",
}  # fmt: skip

_PLAIN = {"id", "x", "y", "z", "from", "to"}
"""Attributes that need no chunk of their own: the element's chunk explains them."""


@cache
def _words() -> dict[str, dict[str, Any]]:
    """The meanings: "elements" by "file/element", "attributes" by name or "file/element@name"."""
    words: dict[str, dict[str, Any]] = yaml.safe_load(
        Path(__file__).with_name("sumo_xml_words.yaml").read_text(encoding="utf-8")
    )
    return words


@dataclass(frozen=True)
class Attribute:
    """An attribute as the schema declares it."""

    name: str
    type: str
    required: bool

    def line(self, about: str) -> str:
        """The attribute as one line of a prompt; `about` is its meaning, "" if unknown."""
        said = f": {about}" if about else ""
        return f"  {self.name} ({self.type}{', required' if self.required else ''}){said}"


@dataclass
class Schema:
    """One schema file with every file that it includes."""

    types: dict[str, etree._Element] = field(default_factory=dict)
    root: etree._Element | None = None

    def read(self, file: Path, top: bool = True) -> None:
        """Adds a file and its includes. Raises MissingTool if the SUMO installation lacks the file."""
        try:
            tree = etree.parse(file).getroot()
        except OSError as fault:
            raise MissingTool(f"{file}: cannot be read; `pip install --force-reinstall eclipse-sumo`") from fault
        for include in tree.iterfind(f"{XSD}include"):
            self.read(file.parent / include.get("schemaLocation", ""), top=False)
        for named in (*tree.iterfind(f"{XSD}complexType"), *tree.iterfind(f"{XSD}simpleType")):
            self.types[named.get("name", "")] = named
        if top:
            self.root = tree.find(f"{XSD}element")

    def elements(self) -> Iterator[tuple[str, list[Attribute], list[str]]]:
        """Yields (name, attributes, names of child elements) of the root and every element below it, each once."""
        seen: set[str] = set()
        queue = [self.root] if self.root is not None else []
        while queue:
            element = queue.pop(0)
            name = element.get("name", "")
            if not name or name in seen:
                continue
            seen.add(name)
            parts = self._parts(element)
            children = [c for part in parts for c in part.iter(f"{XSD}element")]
            queue += children
            attributes = {a.get("name", ""): self._attribute(a) for part in parts for a in _own(part)}
            yield name, list(attributes.values()), [c.get("name", "") for c in children if c.get("name")]

    def _parts(self, element: etree._Element) -> list[etree._Element]:
        """The complex type of an element and those it extends, nearest last."""
        found = element.find(f"{XSD}complexType")
        own = found if found is not None else self.types.get(element.get("type", ""))
        parts: list[etree._Element] = []
        while own is not None and own not in parts:
            parts.insert(0, own)
            extension = own.find(f".//{XSD}extension")
            own = self.types.get(extension.get("base", "")) if extension is not None else None
        return parts

    def _attribute(self, element: etree._Element) -> Attribute:
        return Attribute(element.get("name", ""), self._type(element), element.get("use") == "required")

    def _type(self, element: etree._Element) -> str:
        name = element.get("type", "")
        if name in _BASE:
            return _BASE[name]
        simple = self.types.get(name, element)
        values = ", ".join(dict.fromkeys(e.get("value", "") for e in simple.iter(f"{XSD}enumeration")))
        if values:
            return f"a value, or {values}" if simple.find(f".//{XSD}union") is not None else f"one of {values}"
        return name.removeprefix("xsd:").removesuffix("Type") or "text"


def _own(part: etree._Element) -> Iterator[etree._Element]:
    """Attributes of the type itself, without those of elements declared inside it."""
    for attribute in part.iter(f"{XSD}attribute"):
        if next(attribute.iterancestors(f"{XSD}complexType")) is part:
            yield attribute


def xml_chunks() -> Iterator[Chunk]:
    """Chunks of the plain-XML inputs, of routes and of additional objects."""
    source = f"SUMO {_sumo_version()}"
    for file, tasks in FILES.items():
        schema = Schema()
        schema.read(settings.sumo_home() / "data" / "xsd" / f"{file}_file.xsd")
        for name, attributes, children in schema.elements():
            if file in ("routes", "additional") and f"{file}/{name}" not in _words()["elements"]:
                continue  # detectors, containers, transport plans: no crash needs them
            yield _element(file, name, attributes, children, tasks, source)
            for attribute in attributes:
                if attribute.name not in _PLAIN and (about := _about(file, name, attribute.name)):
                    yield _attribute(file, name, attribute, about, tasks, source)


def _about(file: str, element: str, attribute: str) -> str:
    words = _words()["attributes"]
    return str(words.get(f"{file}/{element}@{attribute}", words.get(attribute, "")))


def _element(
    file: str, name: str, attributes: list[Attribute], children: list[str], tasks: tuple[Task, ...], source: str
) -> Chunk:
    words = _words()["elements"].get(f"{file}/{name}", {})
    required = sorted(attributes, key=lambda a: not a.required)
    lines = [f"<{name}> in the {file} file: {words.get('about', '')}".rstrip(": ")]
    lines += ["attributes:", *(a.line(_about(file, name, a.name)) for a in required)] if attributes else []
    lines += [f"contains: {', '.join(f'<{c}>' for c in dict.fromkeys(children))}"] if children else []
    lines += [f"example: {words['example']}"] if "example" in words else []
    return Chunk(
        id=f"xml/{file}/{name}", kind="xml", tasks=tasks, title=f"SUMO element <{name}> in the {file} file",
        text="\n".join(lines), keywords=words.get("keywords", ""), source=source,
    )  # fmt: skip


def _attribute(
    file: str, element: str, attribute: Attribute, about: str, tasks: tuple[Task, ...], source: str
) -> Chunk:
    text = f"attribute {attribute.name} of <{element}> in the {file} file\n{attribute.line(about)}"
    return Chunk(
        id=f"xml/{file}/{element}@{attribute.name}", kind="xml", tasks=tasks,
        title=f"SUMO attribute {attribute.name} of <{element}>", text=text, source=source,
    )  # fmt: skip


def examples() -> Mapping[str, str]:
    """Examples by "file/element", to be checked against the schemas."""
    return {name: words["example"] for name, words in _words()["elements"].items() if "example" in words}


def _sumo_version() -> str:
    try:
        return version("eclipse-sumo")
    except PackageNotFoundError:
        return "of SUMO_HOME"
