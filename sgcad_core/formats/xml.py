"""Safe XML: strings to lxml trees and back. Knows no format.

Entities and document types are refused, nothing is fetched, huge trees are off: what a model or a user
writes may hold an external entity or a billion laughs.
"""

from __future__ import annotations

import threading
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

from lxml import etree

from sgcad_core.case.records import Finding
from sgcad_core.errors import InvalidOutput, MissingTool

_SCHEMA_LOCK = threading.Lock()
Element = Any
"""An lxml element; lxml's stubs do not name attributes read by the formats."""


def parse_xml(text: str, what: str) -> Element:
    """Root element of an XML string. Raises InvalidOutput naming `what`, the place and the fault."""
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise _invalid(what, "document types and entities are not allowed", "", "leave the <!DOCTYPE> out")
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=False, encoding="utf-8")
    try:
        return etree.fromstring(text.encode("utf-8", "replace"), parser)
    except etree.XMLSyntaxError as fault:
        line, column = fault.position
        where = f"line {line}, column {column}"
        raise _invalid(what, f"no well-formed XML: {fault.msg}", where, "mend the XML") from fault


def to_text(root: Element) -> str:
    """An element as a document string with declaration, UTF-8, indented."""
    etree.indent(root, space="    ")
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8").decode("utf-8")


@cache
def xml_schema(file: Path) -> etree.XMLSchema:
    """A compiled schema file."""
    return etree.XMLSchema(etree.parse(str(file), etree.XMLParser(no_network=True)))


@cache
def asam_schema(name: str) -> etree.XMLSchema:
    """A schema of ASAM's that the package scenariogeneration brings. Raises MissingTool without that package."""
    try:
        return xml_schema(Path(str(distribution("scenariogeneration").locate_file(f"schemas/{name}.xsd"))))
    except PackageNotFoundError as fault:
        message = (
            "the schemas of OpenDRIVE and OpenSCENARIO come with scenariogeneration: `pip install scenariogeneration`"
        )
        raise MissingTool(message) from fault


def schema_errors(schema: etree.XMLSchema, root: Element, most: int = 20) -> list[tuple[int, str]]:
    """(line, message) of the first faults that a compiled schema finds; empty where it finds none."""
    with _SCHEMA_LOCK:  # a schema object keeps its log: two threads would read each other's
        if schema.validate(root):
            return []
        log: Any = schema.error_log
        return [(error.line, error.message) for error in log][:most]


def _invalid(what: str, fault: str, where: str, remedy: str) -> InvalidOutput:
    return InvalidOutput.of(Finding(source=what, what=fault, where=where, remedy=remedy))
