"""Rules for what the narrative tells, the model for a junction that only the drawing shows.

A narrative of a crash on the open road rarely mentions that a side road joins in view; the drawing shows it. Where
the rules find no junction told and the report has a drawing, the model is asked for the layout; legs beside the
main road become the junction, everything told stays as told. Whoever tells the junction is never asked about it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar, Literal

from pydantic import Field

from plugins.road_writer.template import Template
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.errors import InvalidOutput, Refused
from sgcad_core.interfaces import Ask, RoadWriter
from sgcad_core.kinds import DRIVEWAY, FOUR_LEG, JunctionKind
from sgcad_core.narrative.junction import JunctionFacts
from sgcad_core.narrative.lanes import LaneFacts
from sgcad_core.narrative.mentions import axis_of
from sgcad_core.narrative.roads import RoadFact, RoadFacts
from sgcad_core.records import Context, Finding, Passage, Query, RoadNetwork
from sgcad_core.roads.layout import COMPASS
from sgcad_core.specs import Compass, Leg, RoadLayout


class Fused(RoadWriter):
    """A template, and how the model is asked beside it."""

    asks_model: ClassVar[bool] = True
    version: ClassVar[str] = "2"

    template: Template = Template()
    """Its parameters stand for what neither source tells."""
    prompt: str = Field("layout", pattern=r"^[\w-]+$")
    """configs/prompts/<prompt>.md, which asks for a `RoadLayout`."""
    evidence: Literal["diagram", "report"] = "diagram"
    """What the model sees: the drawing alone, or the narrative too."""

    def write(
        self, context: Context, passages: Sequence[Passage], findings: Sequence[Finding], ask: Ask, attempt: int
    ) -> RoadNetwork:
        """Write the network; `log` says what the drawing added. Raises Refused on a text without a crash."""
        facts = context.reading.roads
        told = facts.junction.kind != "none" or facts.junction.stated
        if told or not context.diagrams:
            return self.template.network_of(context.narrative, facts)
        shown, note = self._shown(context, facts, ask, attempt)
        network = self.template.network_of(context.narrative, shown)
        log = f"drawing: {note}\n{network.log}".strip()
        return network.model_copy(update={"layout": None, "log": log})  # the model answered another one

    def _shown(self, context: Context, facts: RoadFacts, ask: Ask, attempt: int) -> tuple[RoadFacts, str]:
        """The facts with what the drawing adds, and what that is."""
        seen = Context(narrative="", diagrams=context.diagrams) if self.evidence == "diagram" else context
        query = Query(task=load_prompt(self.prompt), answer_schema=answer_schema(RoadLayout), attempt=attempt)
        try:
            layout = parse_answer(ask(seen, query).text, RoadLayout)
        except (Refused, InvalidOutput) as fault:
            return facts, f"not readable ({fault})"
        shown = with_junction(facts, layout.legs)
        added = (
            "no junction beside the road that is told" if shown is facts else "a junction that the text does not tell"
        )
        return shown, f"{added} ({', '.join(leg.bearing for leg in layout.legs)})"


def with_junction(facts: RoadFacts, legs: Sequence[Leg]) -> RoadFacts:
    """Facts and the junction that a drawing shows: a leg on one side of the main road, or one on either side.

    Only the sides are believed, not the angle: the junction is drawn at a right angle. A drawing that does not show
    the main road at both ends, as the narrative tells it, is not believed at all.
    """
    main = next((road.axis for road in facts.streets if road.axis), None)
    if main is None or not {main, _turned(main, 4)} <= {leg.bearing for leg in legs}:
        return facts
    sides = {_side(main, leg.bearing): leg for leg in legs if axis_of(leg.bearing) != main}
    if not sides:
        return facts
    stem, side = next(iter(sides.items()))
    kind: JunctionKind = FOUR_LEG if len(sides) == 2 else DRIVEWAY if side.kind == DRIVEWAY else "t"
    cross = RoadFact(axis_of(stem), "road", LaneFacts(total=side.lanes_in + side.lanes_out), (), cross=True)
    junction = JunctionFacts(kind, None if kind == FOUR_LEG else stem)
    return replace(facts, roads=(*facts.roads, cross), junction=junction)


def _turned(bearing: Compass, eighths: int) -> Compass:
    return COMPASS[(COMPASS.index(bearing) + eighths) % 8]


def _side(main: Compass, bearing: Compass) -> Compass:
    """The right angle to the main road on whose side a bearing lies."""
    return _turned(main, 2 if (COMPASS.index(bearing) - COMPASS.index(main)) % 8 < 4 else 6)
