"""The model says which roads there are; code draws and compiles them.

The crash evidence stands in the context, so that contrast amplifies it; the instructions and retrieved
passages stand in the query. Findings of the attempt before come back through the query's repair.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar, Literal

from pydantic import Field, field_validator

from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.case.records import Context, Finding, Hold, Passage, Query, RoadNetwork
from sgcad_core.errors import InvalidOutput
from sgcad_core.findings import FindingFactory
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.interfaces import Ask, RoadWriter
from sgcad_core.records.specs import Compass, RoadLayout, RoadSpec
from sgcad_core.roads.layout import COMPASS, road_spec

_finding = FindingFactory("layout")

USUAL_LEGS = 4
"""Junctions of more legs are rare enough to doubt the count first."""


class SpecRoad(RoadWriter):
    """Asks a model for a description of the roads, which code draws and compiles.

    form: road asks for a `RoadSpec` (any network), layout for a `RoadLayout` (one hub and its legs, for small models).
    """

    asks_model: ClassVar[bool] = True
    version: ClassVar[str] = "2"
    form: Literal["road", "layout"] = "road"
    prompt: str = Field("", pattern=r"^[\w-]*$")
    """configs/prompts/<prompt>.md; empty: the one named like the form."""
    places: bool = False
    """Whether the answer may tell roundabouts and their like; the embedded model has not learned their fields."""

    @field_validator("places", mode="before")
    @classmethod
    def _no_map(cls, told: object) -> object:
        """A map belongs to the writer that takes one."""
        if isinstance(told, str | Path) and str(told).lower() not in ("true", "false"):
            raise ValueError(
                f"this writer asks a model and takes no maps ({told}): leave --places out, or take the writer that "
                "draws with maps (road_writer: template, as in template.yaml and fused.yaml)"
            )
        return told

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Asks, reads, draws and compiles. Raises InvalidOutput with findings, Refused if the model declines."""
        query = Query(
            task=self._task(),
            passages=tuple(passages),
            answer_schema=answer_schema(RoadSpec if self.form == "road" else RoadLayout, places=self.places),
            attempt=attempt,
        )
        answer = ask(context, query).text
        if self.form == "road":
            spec = parse_answer(answer, RoadSpec)
            return compile_network(plain_xml(spec), spec)
        layout = _layout(answer)
        spec = road_spec(layout)
        return compile_network(plain_xml(spec), spec).model_copy(update={"layout": layout})

    @property
    def prompts(self) -> tuple[str, ...]:
        """The prompt, and the words on roundabouts and their like."""
        return (self.prompt or self.form, *([f"{self.form}_places"] if self.places else []))

    def _task(self) -> str:
        return "\n\n".join(load_prompt(name) for name in self.prompts)


def _layout(answer: str) -> RoadLayout:
    layout = parse_answer(answer, RoadLayout)
    if faults := list(_layout_faults(layout)):
        raise InvalidOutput("\n".join(f.line() for f in faults), faults)
    return layout


def _layout_faults(layout: RoadLayout) -> Iterator[Finding]:
    """What a layout's own fields contradict: legs of one bearing, legs without lanes, accesses of no leg."""
    for bearing, count in Counter(leg.bearing for leg in layout.legs).items():
        if count > 1:
            remedy = "merge them, or turn one by 45 degrees"
            yield _finding(f"{count} legs have one bearing", "legs", bearing, remedy, holds=_elsewhere(layout, bearing))
    for i, leg in enumerate(layout.legs):
        if not leg.lanes_in and not leg.lanes_out:
            yield _finding("the leg has no lanes", f"legs[{i}]", "0 and 0", "give one direction a lane")
        if leg.turns_in and len(leg.turns_in) != leg.lanes_in:
            what, value = "not one turn for each of lanes_in", f"{len(leg.turns_in)} turns, {leg.lanes_in} lanes"
            remedy = "count the lanes again: turn lanes are lanes; make both agree or leave the turns empty"
            yield _finding(what, f"legs[{i}].turns_in", value, remedy)
    bearings = [leg.bearing for leg in layout.legs]
    for i, access in enumerate(layout.accesses):
        if access.leg not in bearings:
            remedy = f"use one of {', '.join(bearings)}"
            yield _finding("there is no leg of this bearing", f"accesses[{i}].leg", access.leg, remedy)
        if not access.lanes_in and not access.lanes_out:
            yield _finding("the access has no lanes", f"accesses[{i}]", "0 and 0", "give one direction a lane")


def _elsewhere(layout: RoadLayout, bearing: Compass) -> tuple[Hold, ...]:
    """Legs that repeat a bearing lie where no other does; of more than four some are too many, not misplaced."""
    if len(layout.legs) > USUAL_LEGS:
        return ()
    free = tuple(way for way in COMPASS if way not in {leg.bearing for leg in layout.legs})
    places = [i for i, leg in enumerate(layout.legs) if leg.bearing == bearing]
    return tuple(Hold(items="legs", at=i, either=({"bearing": free},)) for i in places[1:] if free)
