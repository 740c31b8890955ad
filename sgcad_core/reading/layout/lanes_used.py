"""A layout with the lanes that its vehicles are told to be in, to change between and to turn from.

Where the told or usual counts leave no room, the road gets the lane, and a note says so. Knows no geometry and no
network.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from sgcad_core.kinds import CHANGES, JOINING, RAMP, actor_kind
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import NAMES, between, turned
from sgcad_core.records.specs import Compass, Leg, RoadLayout, Turn

CENTER = "center_turn"
"""The word for a two-way left-turn lane."""
MOST = 7
"""Lanes in one direction."""
_LEFT_USES: dict[Turn, Turn] = {"left_through": "through", "any": "through_right", "left_right": "right"}
_RIGHT_USES: dict[Turn, Turn] = {"through_right": "through", "any": "left_through", "left_right": "left"}
_AHEAD = (0, 45, 315)


@dataclass(frozen=True)
class _Need:
    """What one vehicle needs on the leg that it comes in on, and why."""

    way: Compass
    lanes: int = 1
    turn: Turn | None = None
    counted: bool = False
    """In a lane that is told by its place among those for that turn: there are as many as the story counts."""
    center: bool = False
    parted: bool = False
    """Only where no lane of the other direction lies beside it."""
    leftward: bool = False
    """To move to the left: on a road whose lanes are told, that may be over the middle of the road."""
    by_word: bool = False
    """By "the left lane" alone, which on a road of two lanes for two ways is that of the other direction."""
    why: str = ""


def with_told_lanes(facts: RoadFacts, layout: RoadLayout) -> RoadLayout:
    """The layout with the lanes that its vehicles need; not in roundabouts, whose lanes are told with the circle."""
    return _widened(facts, layout)[0]


def lanes_added(facts: RoadFacts, layout: RoadLayout) -> tuple[str, ...]:
    """Notes on lanes that a layout lacks and gets since a vehicle is told to use them."""
    return _widened(facts, layout)[1]


def least_lanes(v: VehicleFacts, crash: CrashFacts) -> int:
    """The least number of lanes in its direction where a vehicle is in its lane and has the lane that it changes to."""
    side = _change(v, crash)
    least = abs(v.lane) + (side * v.lane > 0) if v.lane else _own(v)
    return min(max(least, 1 + abs(side), 1 + _changing(v, crash)), MOST)


def _change(v: VehicleFacts, crash: CrashFacts) -> int:
    """1: it changes to the lane on its left, -1: on its right; 0 where it leaves its lane towards a parked vehicle."""
    side, other = CHANGES.get(v.maneuver, 0), crash.first_met(v.id)
    beside = other is not None and other.maneuver == "parked" and other.lane is None
    return 0 if side < 0 and beside else side


def _own(v: VehicleFacts) -> int:
    """The least number of lanes in its direction where a vehicle is in its lane."""
    return abs(v.lane) if v.lane else {"left": 2, "middle": 3}.get(v.lane_word or "", 1)


def _beyond_passed(v: VehicleFacts, crash: CrashFacts) -> int:
    """The lanes that there are where one passes another one on the left that is in a told lane: one more than that."""
    other = crash.first_met(v.id)
    if other is None or other.heading != v.heading or v.lane_word not in (None, "left_turn"):
        return 1
    if v.lane_word == "left_turn":
        return 3 if other.lane_word == "left" else max((other.lane or 1) + 1, 2)
    return other.lane + 1 if other.lane and other.lane > 0 else 1


def _meets_own_way(v: VehicleFacts, crash: CrashFacts) -> bool:
    """Whether a vehicle first touches one that drives its way: its lane change is into the lane of that one."""
    other = crash.first_met(v.id)
    return other is not None and other.heading == v.heading


def _changing(v: VehicleFacts, crash: CrashFacts) -> int:
    """How many of those that drive its way change lanes to different sides: two need three lanes."""
    return len({_change(o, crash) for o in crash.vehicles if o.heading == v.heading} - {0})


# ------------------------------------------------------------------ needs
def _needs(crash: CrashFacts) -> Iterator[_Need]:
    for v in crash.vehicles:
        if v.heading is None or v.origin in (*DRIVES, RAMP) or v.maneuver == "parked" or actor_kind(v.kind).keeps_right:
            continue
        word = v.lane_word if v.lane is None else None
        if side := _change(v, crash):
            hand = "left" if side > 0 else "right"
            leftward = hand == "left" and not _meets_own_way(v, crash)
            why = f"{v.id} changes lanes to the {hand}"
            yield _Need(v.heading, least_lanes(v, crash), leftward=leftward, why=why)
        if v.maneuver == "overtaking":
            yield _Need(v.heading, 2, parted=True, why=f"{v.id} overtakes")
            why = f"{v.id} overtakes in the lane beside"
            yield _Need(v.heading, _beyond_passed(v, crash), leftward=True, why=why)
        if word == CENTER:
            yield _Need(v.heading, center=True, why=f"{v.id} is in the center turn lane")
        elif v.lane_word in ("left_turn", "right_turn"):
            turn: Turn = "left" if v.lane_word == "left_turn" else "right"
            why = f"{v.id} is in the {turn}-turn lane"
            yield _Need(v.heading, abs(v.lane or 1), turn=turn, counted=v.lane is not None, why=why)
        elif v.lane or word in ("left", "middle"):
            lane = f"lane {abs(v.lane)} from the {'right' if v.lane > 0 else 'left'}" if v.lane else f"the {word} lane"
            yield _Need(v.heading, min(_own(v), MOST), by_word=word == "left", why=f"{v.id} is in {lane}")
        elif word == "right" and crash.unnumbered:  # numbered reports say so of the one lane of a two-lane road
            yield _Need(v.heading, 2, by_word=True, why=f"{v.id} is in the right lane")


# ------------------------------------------------------------------ the layout
def _widened(facts: RoadFacts, layout: RoadLayout) -> tuple[RoadLayout, tuple[str, ...]]:
    if layout.circle_lanes:
        return layout, ()
    legs, notes = {leg.bearing: leg for leg in layout.legs}, []
    for need in _needs(facts.crash):
        leg = legs.get(turned(need.way, 180))
        if leg is None or leg.kind in JOINING or not leg.lanes_in or (need.by_word and _one_each_way(facts, leg)):
            continue
        beside = leg.lanes_out and leg.median in ("none", "painted")
        if beside and (need.parted or (need.leftward and _counts(facts, leg))):
            continue
        changed = dict(_changed(need, leg, legs, facts))
        if any(changed[bearing] != legs[bearing] for bearing in changed):
            legs |= changed
            notes.append(_said(need, leg, changed[leg.bearing]))
    return layout.model_copy(update={"legs": tuple(legs.values())}), tuple(dict.fromkeys(notes))


def _counts(facts: RoadFacts, leg: Leg) -> bool:
    """Whether the story counts the lanes of a leg's road."""
    return any(lanes.total or lanes.each_way or lanes.toward for lanes in _told(facts, leg))


def _one_each_way(facts: RoadFacts, leg: Leg) -> bool:
    """Whether a leg's road is told to have two lanes, and those for two ways."""
    return any(lanes.total == 2 and (lanes.one_way is False or lanes.divided is False) for lanes in _told(facts, leg))


def _told(facts: RoadFacts, leg: Leg) -> Iterator[LaneFacts]:
    """What is told of the lanes of the roads that a leg may be of."""
    return (road.lanes for road in facts.streets if road.axis in (None, axis_of(leg.bearing)))


def _changed(need: _Need, leg: Leg, legs: dict[Compass, Leg], facts: RoadFacts) -> Iterator[tuple[Compass, Leg]]:
    """The legs that a need changes, by bearing: its approach, and the leg that goes on from it."""
    ahead = next((legs[way] for way in legs if way != leg.bearing and between(need.way, way) in _AHEAD), None)
    plain = len(legs) == 2
    if need.center:
        yield from ((one.bearing, _with_center(one)) for one in legs.values() if _on_axis(one, need.way))
    elif plain and ahead is not None and _has_the_spare_lane(need, leg, facts):
        yield leg.bearing, leg.model_copy(update={"lanes_in": leg.lanes_in + 1, "lanes_out": leg.lanes_out - 1})
        yield (
            ahead.bearing,
            ahead.model_copy(update={"lanes_in": ahead.lanes_in - 1, "lanes_out": ahead.lanes_out + 1}),
        )
    elif need.turn and not plain:
        counts = _told(facts, leg) if need.counted else ()
        many = max([need.lanes, *(lanes.turns.get("any", ()).count(need.turn) for lanes in counts)])
        yield leg.bearing, _with_turn_lanes(leg, need.turn, _exits(need.way, legs), many)
    else:
        least = max(need.lanes, 2) if need.turn else need.lanes
        yield leg.bearing, _with_lanes(leg, least)
        told = ahead is not None and not plain and facts.lists(axis_of(ahead.bearing))
        if ahead is not None and ahead.kind not in JOINING and ahead.lanes_out and not told:
            out = max(ahead.lanes_out, min(least, _through(leg, least)))
            yield ahead.bearing, ahead.model_copy(update={"lanes_out": out})


def _has_the_spare_lane(need: _Need, leg: Leg, facts: RoadFacts) -> bool:
    """Whether the lane that a need lacks is the spare one of an odd total, which the other direction was given."""
    odd = any(lanes.total == leg.lanes_in + leg.lanes_out for lanes in _told(facts, leg))
    short = not need.turn and need.lanes == leg.lanes_in + 1 == leg.lanes_out
    others = (v for v in facts.crash.vehicles if v.heading == leg.bearing)
    return odd and short and leg.median == "none" and all(_own(v) < leg.lanes_out for v in others)


def _said(need: _Need, before: Leg, after: Leg) -> str:
    name = NAMES[need.way]
    if need.center:
        return f"the road gets a center turn lane: {need.why}"
    if need.turn and after.turns_in != before.turns_in:
        return f"the approach of traffic that heads {name} gets a {need.turn}-turn lane: {need.why}"
    return f"the road gets {after.lanes_in} lanes that head {name} in place of {before.lanes_in}: {need.why}"


def _on_axis(leg: Leg, way: Compass) -> bool:
    return axis_of(leg.bearing) == axis_of(way) and leg.kind not in JOINING


def _with_center(leg: Leg) -> Leg:
    """A two-way leg without a raised median gets the lane; the turn lane at its end is then that one."""
    if not (leg.lanes_in and leg.lanes_out) or leg.median not in ("none", "painted"):
        return leg
    return leg.model_copy(update={"center_turn_lane": True, "median": "none"})


def _with_lanes(leg: Leg, least: int) -> Leg:
    """At least so many lanes come in; those added go straight on."""
    if leg.lanes_in >= least:
        return leg
    update: dict[str, Any] = {"lanes_in": least}
    if leg.turns_in:
        uses = list(leg.turns_in)
        at = next((i for i, use in reversed(list(enumerate(uses))) if "through" in use), 0)
        update["turns_in"] = (*uses[:at], *("through",) * (least - leg.lanes_in), *uses[at:])
    return leg.model_copy(update=update)


def _through(leg: Leg, least: int) -> int:
    """Lanes of a leg that go straight on, once it has at least so many."""
    turning = sum(use in ("left", "right") for use in leg.turns_in)
    return max(max(leg.lanes_in, least) - turning, 1)


def _exits(way: Compass, legs: Iterable[Compass]) -> set[str]:
    """The hands by which traffic that heads some way can leave: left, through, right."""
    angles = {between(way, bearing) for bearing in legs if between(way, bearing) != 180}
    return {"through" if a in _AHEAD else "right" if a < 180 else "left" for a in angles}


def _with_turn_lanes(leg: Leg, turn: Turn, exits: set[str], many: int) -> Leg:
    """So many lanes for this turn alone; none where there are as many, or a center turn lane, or no such way out."""
    more = many - leg.turns_in.count(turn)
    if more <= 0 or turn not in exits or (turn == "left" and leg.center_turn_lane):
        return leg
    if "through" not in exits:
        lanes = max(leg.lanes_in, len(exits), many)
        left = lanes // 2 if "left" in exits and "right" in exits else lanes * ("left" in exits)
        return leg.model_copy(update={"lanes_in": lanes, "turns_in": ("right",) * (lanes - left) + ("left",) * left})
    uses = list(leg.turns_in) or _usual(leg.lanes_in, exits)
    shared = _LEFT_USES if turn == "left" else _RIGHT_USES
    end = -1 if turn == "left" else 0
    uses[end] = shared.get(uses[end], uses[end])
    uses = [*uses, *[turn] * more] if turn == "left" else [*[turn] * more, *uses]
    return leg.model_copy(update={"lanes_in": min(leg.lanes_in + more, MOST), "turns_in": tuple(uses[:MOST])})


def _usual(lanes: int, exits: set[str]) -> list[Turn]:
    """The use of lanes that nothing is told of, from the right curb."""
    uses: list[Turn] = ["through"] * lanes
    left, right = "left" in exits, "right" in exits
    if lanes == 1:
        return ["any" if left and right else "left_through" if left else "through_right" if right else "through"]
    uses[0] = "through_right" if right else "through"
    uses[-1] = "left_through" if left else "through"
    return uses
