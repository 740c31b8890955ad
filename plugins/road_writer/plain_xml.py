"""The model writes SUMO's plain XML itself (nodes, edges, connections); netconvert compiles it.

The paper's own method. Nothing is repaired here: faults of the answer, of SUMO's schemas and of netconvert go back as
findings. The XML is taken from a JSON envelope or from blocks in a free answer, whichever the model gives.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from sgcad_core.asking.fenced_blocks import xml_document
from sgcad_core.asking.prompts import MAX_ANSWER, answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, Finding, Passage, PlainXml, Query, RoadNetwork
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.xml import parse_xml, to_text
from sgcad_core.interfaces import Ask, RoadWriter
from sgcad_core.records.specs import Spec

_PARTS = ("nodes", "edges", "connections")
_ENVELOPED = re.compile(r'\{\s*"(nodes|edges|connections)"\s*:')
_INSTANCE = "{http://www.w3.org/2001/XMLSchema-instance}"


class PlainAnswer(Spec):
    """The envelope: three documents as texts."""

    nodes: str = Field(description="the whole XML document with root <nodes>")
    edges: str = Field(description="the whole XML document with root <edges>")
    connections: str = Field("", description="the whole XML document with root <connections>, or empty")


class PlainXmlRoad(RoadWriter):
    """Asks a model for SUMO XML: form envelope for one JSON object, which a grammar can enforce, or fenced blocks."""

    asks_model: ClassVar[bool] = True
    form: Literal["envelope", "fenced"] = "envelope"
    prompt: str = Field("plain_xml", pattern=r"^[\w-]+$")
    """configs/prompts/<prompt>.md; its slot {answer} says how to answer."""

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompt and the words on the form of the answer."""
        return (self.prompt, f"{self.prompt}_{self.form}")

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Asks, reads and compiles. Raises InvalidOutput (a document is missing), Refused (the model declines)."""
        enveloped = self.form == "envelope"
        query = Query(
            task=load_prompt(self.prompt, answer=load_prompt(f"{self.prompt}_{self.form}")),
            passages=tuple(passages),
            answer_schema=answer_schema(PlainAnswer) if enveloped else None,
            attempt=attempt,
        )
        return compile_network(plain_of_answer(ask(context, query).text))


def plain_of_answer(answer: str) -> PlainXml:
    """The three documents of an answer, in whichever form it came. Raises InvalidOutput, Refused."""
    found = {part: xml_document(answer, part) for part in _PARTS}
    if len(answer) > MAX_ANSWER or _ENVELOPED.search(answer) or not (found["nodes"] or found["edges"]):
        envelope = parse_answer(answer, PlainAnswer)
        found = {part: getattr(envelope, part).strip() for part in _PARTS}
    if missing := [part for part in ("nodes", "edges") if not found[part]]:
        faults = [_missing(part) for part in missing]
        raise InvalidOutput("\n".join(f.line() for f in faults), faults)
    return PlainXml(**{part: _without_hints(text) for part, text in found.items()})


def _missing(part: str) -> Finding:
    remedy = f"give a whole document <{part}>...</{part}>"
    return Finding(source="answer", what=f"the answer has no <{part}> document", where=part, remedy=remedy)


def _without_hints(text: str) -> str:
    """The text without schema locations, which would point a parser elsewhere; invalid XML stays for the validators."""
    try:
        root = parse_xml(text, "plain_xml") if text else None
    except InvalidOutput:
        return text
    if root is None or not [key for key in root.attrib if key.startswith(_INSTANCE)]:
        return text
    for key in [key for key in root.attrib if key.startswith(_INSTANCE)]:
        del root.attrib[key]
    return to_text(root)
