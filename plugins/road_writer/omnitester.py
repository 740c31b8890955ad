"""OmniTester's road half: an interpreter reasons about the scene and describes it, a net generator writes SUMO XML.

The generator gets the description and similar real junctions from an index, but not the report; faults of the schemas,
of netconvert and of SUMO come back through the refinement loop. Reads the index through the retriever only.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import ClassVar, Literal

from pydantic import Field, PrivateAttr

from plugins.road_writer._told_layout import Embedder, junction_index
from plugins.road_writer.plain_xml import PlainAnswer, plain_of_answer
from sgcad_core.asking.case_cache import CaseCache
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, Finding, Passage, Query, RoadNetwork
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.interfaces import Ask, Retriever, RoadWriter
from sgcad_core.records.specs import Spec


class RoadInterpretation(Spec):
    """The interpreter's answer; the reasoning is the first field, so that it is written first."""

    reasoning: str = Field(description="step by step: junction, legs, headings, lanes, control, shape")
    roads: str = Field(min_length=1, description="the whole scene in plain sentences for somebody who draws it")


class OmnitesterRoad(RoadWriter):
    """Asks a model twice: for a description of the scene, then for SUMO XML made from it and from real junctions.

    form is how the XML is answered (a JSON envelope or fenced blocks); embedder, model and base_url are the index's.
    """

    asks_model: ClassVar[bool] = True
    form: Literal["envelope", "fenced"] = "fenced"
    folder: Path | None = None
    """An index of real junctions (`sgcad index build EXTRACT --out FOLDER`); none: nothing is retrieved."""
    embedder: Embedder = "none"
    model: str = ""
    base_url: str = ""
    junctions: int = Field(2, ge=1, le=5)
    """Real junctions shown to the net generator."""
    _seen: CaseCache[RoadInterpretation] = PrivateAttr(default_factory=CaseCache)

    @property
    def stamp(self) -> str:
        """The index's fingerprint, "" without a folder. Raises ConfigError if the folder holds no index."""
        return self._retriever.stamp if self._retriever else ""

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompts of both questions, and the words on the form of the answer."""
        return ("omnitester_interpreter", "omnitester_net", f"plain_xml_{self.form}")

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Interprets (once a case), retrieves, generates and compiles. Raises InvalidOutput, Refused, ConfigError."""
        scene = self._seen.of(context, attempt, lambda: _interpret(context, ask, attempt))
        query = Query(
            task=load_prompt("omnitester_net", answer=load_prompt(f"plain_xml_{self.form}")),
            passages=(*passages, *self._junctions(scene.roads)),
            answer_schema=answer_schema(PlainAnswer) if self.form == "envelope" else None,
            attempt=attempt,
        )
        return compile_network(plain_of_answer(ask(Context(narrative=scene.roads), query).text))

    def _junctions(self, description: str) -> list[Passage]:
        if self._retriever is None:
            return []
        return [_with_xml(p) for p in self._retriever.retrieve(description, "road")]

    @cached_property
    def _retriever(self) -> Retriever | None:
        if self.folder is None:
            return None
        return junction_index(self.folder, self.embedder, self.model, self.base_url, self.junctions)


def _interpret(context: Context, ask: Ask, attempt: int) -> RoadInterpretation:
    schema = answer_schema(RoadInterpretation)
    query = Query(task=load_prompt("omnitester_interpreter"), answer_schema=schema, attempt=attempt)
    return parse_answer(ask(context, query).text, RoadInterpretation)


def _with_xml(passage: Passage) -> Passage:
    """A real junction as the generator sees it: its description and its plain XML."""
    plain = json.loads(passage.data)["plain"] if passage.data else {}
    shown = "\n".join(plain[part] for part in ("nodes", "edges") if plain.get(part))
    return passage.model_copy(update={"text": f"{passage.text}\n{shown}".strip()})
