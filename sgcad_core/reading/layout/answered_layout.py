"""What a model answered of a road, laid over the road that follows from the text. Knows no probability: what of the
answer is taken is decided elsewhere (`sgcad_core.reading.second_reader.fuse_whole`)."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from sgcad_core.kinds import DRIVEWAY, FOUR_LEG, RAMP, JunctionKind, T
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import Leg, RoadLayout

if TYPE_CHECKING:
    from sgcad_core.reading.crash_facts import CrashFacts
    from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts


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


def short_of_told(facts: RoadFacts, ours: RoadLayout, answered: RoadLayout) -> frozenset[str]:
    """Axes of streets that the answer draws with less than the text tells: fewer lanes than are counted of an undivided
    street, or without turn lanes that are named.

    More lanes are no contradiction: turn lanes at the junction may stand beside those that are named.
    """
    short = set()
    for road in facts.streets:
        if road.axis is None:
            continue
        told = _counted(road)
        named = {use for uses in road.lanes.turns.values() for use in uses} & _turning(ours, road.axis)
        if _most(answered, road.axis) < told <= _most(ours, road.axis) or named - _turning(answered, road.axis):
            short.add(road.axis)
    return frozenset(short)


def _turning(layout: RoadLayout, axis: str) -> set[str]:
    """For which turns alone there is a lane on an axis."""
    return {
        use for leg in layout.legs if axis_of(leg.bearing) == axis for use in leg.turns_in if use in ("left", "right")
    }


def _counted(road: RoadFact) -> int:
    """Lanes of both directions as the text counts them; 0 where it does not, or where one carriageway may be meant."""
    lanes = road.lanes
    if lanes.one_way or lanes.one_way_toward or lanes.divided:
        return 0
    return lanes.total or 2 * (lanes.each_way or 0)


def _most(layout: RoadLayout, axis: str) -> int:
    """Lanes of the widest leg on an axis, its center turn lane among them."""
    here = [leg for leg in layout.legs if axis_of(leg.bearing) == axis]
    return max((leg.lanes_in + leg.lanes_out + leg.center_turn_lane for leg in here), default=0)


def carries(layout: RoadLayout, crash: CrashFacts) -> bool:
    """Whether every moving vehicle can come in as it heads, and go out where it turns to."""
    ways_in = {leg.bearing for leg in layout.legs if leg.lanes_in}
    ways_out = {leg.bearing for leg in layout.legs if leg.lanes_out}
    comes = {turned(v.heading, 180) for v in crash.vehicles if v.heading and v.maneuver != "backing"}
    goes = {v.exit_heading for v in crash.vehicles if v.exit_heading}
    both = ways_in | ways_out  # a vehicle on the wrong side comes in where others go out
    return comes <= both and goes <= both


def legs_added(ours: RoadLayout, layout: RoadLayout) -> frozenset[str]:
    """Lanes and turns of the roads that the text does not have: they come with the answer's legs."""
    own = {axis_of(leg.bearing) for leg in ours.legs}
    axes = {axis_of(leg.bearing) for leg in layout.legs} - own
    return frozenset(f"{name}.{axis}" for axis in axes for name in ("lanes", "turns"))


def junction_of(facts: RoadFacts, layout: RoadLayout) -> Any:
    """The junction of a layout's legs."""
    kinds = Counter(leg.kind for leg in layout.legs)
    joining = next((leg for leg in layout.legs if leg.kind in (DRIVEWAY, RAMP)), None)
    count = len(layout.legs)
    kind: JunctionKind = "none" if count < 3 else FOUR_LEG if count > 3 else T
    if joining is not None and count == 3 and kinds[joining.kind] == 1:
        kind = cast("JunctionKind", joining.kind)
    axes = Counter(axis_of(leg.bearing) for leg in layout.legs)
    alone = next((leg.bearing for leg in layout.legs if axes[axis_of(leg.bearing)] == 1), None)
    return replace(facts.junction, kind=kind, stem=alone if count == 3 else None, stated=False, stem_stated=False)


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
