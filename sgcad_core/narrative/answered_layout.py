"""What a model answered of a road, laid over the road that follows from the text. Knows no probability: what of the
answer is taken is decided elsewhere (`sgcad_core.narrative.whole_fusion`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sgcad_core.narrative.mentions import axis_of
from sgcad_core.specs import Leg, RoadLayout

if TYPE_CHECKING:
    from sgcad_core.narrative.roads import RoadFacts


def answered_layout(facts: RoadFacts, layout: RoadLayout) -> RoadLayout:
    """The layout with the fields that are taken from the answered one."""
    if facts.answered is None or not facts.taken:
        return layout
    ours = {leg.bearing: leg for leg in layout.legs}
    theirs = {leg.bearing: leg for leg in facts.answered.legs}
    if "legs" in facts.taken:
        legs = [_as_told(ours.get(bearing), leg, facts.taken) for bearing, leg in theirs.items()]
    else:
        legs = [_with(leg, theirs.get(bearing), facts.taken) for bearing, leg in ours.items()]
    return layout.model_copy(update={"legs": tuple(legs)})


def _as_told(ours: Leg | None, theirs: Leg, taken: frozenset[str]) -> Leg:
    """A leg of the answer; of one that follows from the text too, what is not taken stays as the text has it."""
    if ours is None:
        return theirs
    kind = {"kind": theirs.kind}
    return _with(ours, theirs, taken).model_copy(update=kind)


def _with(ours: Leg, theirs: Leg | None, taken: frozenset[str]) -> Leg:
    """A leg with what is taken of the answered one."""
    if theirs is None:
        return ours
    axis, update = axis_of(ours.bearing), dict[str, Any]()
    if f"lanes.{axis}" in taken:
        update |= {"lanes_in": theirs.lanes_in, "lanes_out": theirs.lanes_out, "turns_in": theirs.turns_in}
        update |= {"center_turn_lane": theirs.center_turn_lane}
    if f"turns.{axis}" in taken and len(theirs.turns_in) == update.get("lanes_in", ours.lanes_in):
        update["turns_in"] = theirs.turns_in
    if f"curve.{axis}" in taken:
        update["curve"] = theirs.curve
    return ours.model_copy(update=update)
