"""The lane of each vehicle, 1 = at the right curb: as told, else what its maneuver and partner ask for."""

from __future__ import annotations

from collections.abc import Iterator

from sgcad_core.kinds import CHANGES
from sgcad_core.reading.behavior.exit_assignment import Placed
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.layout.lanes_used import CENTER
from sgcad_core.reading.layout.road_ways import Way
from sgcad_core.records.specs import Turn

_LEFT: tuple[Turn, ...] = ("left", "left_through", "left_right", "any")
_RIGHT: tuple[Turn, ...] = ("right", "through_right", "left_right", "any")
_THROUGH: tuple[Turn, ...] = ("through", "left_through", "through_right", "any")


def lane_of(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> int | None:
    """The lane in which it starts; None leaves the choice to the planner. One more than the road has in its direction
    is its two-way left-turn lane."""
    way = placed[v.id].way
    if _takes_center_lane(v, way):
        return way.lanes + 1
    if way.lanes == 1:
        return 1
    if (beside := _beside_partner(v, placed, facts)) is not None:
        return beside
    told = _stated_lane(v, way.lanes, way.turns)
    if told is not None:
        return told
    partner = _leader(v, placed, facts)
    if partner is not None and not _waits_to_turn(v):
        shared = _stated_lane(partner, way.lanes, way.turns)
        return shared if shared is not None else _by_turn(partner, way.lanes, way.turns)
    return _by_turn(v, way.lanes, way.turns)


def _takes_center_lane(v: VehicleFacts, way: Way) -> bool:
    """Whether it is told to be in the two-way left-turn lane of its road, or in the left-turn lane where that is it."""
    if not way.road.center_turn_lane or v.lane is not None or not (way.road.lanes_forward and way.road.lanes_backward):
        return False
    return v.lane_word == CENTER or (v.lane_word == "left_turn" and "left" not in way.turns)


# ------------------------------------------------------------------ lane changes
def _beside_partner(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> int | None:
    """The lane of one that changes into the lane of another one, or of that other one; None of all others."""
    other = _met(v, placed, facts)
    count, turns = placed[v.id].way.lanes, placed[v.id].way.turns
    if other is not None and "overtaking" in (v.maneuver, other.maneuver):
        return _behind_each_other(v, other, (count, turns))
    if (
        other is not None
        and (side := CHANGES.get(v.maneuver, CHANGES.get(other.maneuver, 0)))
        and _runs_into(v if v.maneuver in CHANGES else other, facts)
    ):
        return _out_of_lane_behind(v, other, (count, turns), side)
    side = CHANGES.get(v.maneuver, 0)
    if side:
        other_side = CHANGES.get(other.maneuver, 0) if other else 0
        return _before_change(v, None if other_side else other, (count, turns), side)
    if other is None or not (side := CHANGES.get(other.maneuver, 0)) or v.lane or v.lane_word:
        return None
    return _before_change(other, None, (count, turns), side) + side


def _behind_each_other(v: VehicleFacts, other: VehicleFacts, road: tuple[int, tuple[Turn, ...]]) -> int:
    """The lane of one that overtakes and of the one overtaken, with a lane to the left of it: as told of either."""
    count, turns = road
    own, others = _stated_lane(v, count, turns), _stated_lane(other, count, turns)
    if v.maneuver != "overtaking":
        return own or others or count - 1
    return min((others or own if v.lane_word == "left_turn" else own or others) or count - 1, count - 1)


def _out_of_lane_behind(
    v: VehicleFacts, other: VehicleFacts, road: tuple[int, tuple[Turn, ...]], side: int
) -> int | None:
    """The lane of one that changes lanes behind the one that it runs into, and of that one: each as told, else one lane
    of both, out of which the change leads."""
    count, turns = road
    changing, ahead = (v, other) if v.maneuver in CHANGES else (other, v)
    told = _stated_lane(ahead, count, turns)
    start = _before_change(changing, ahead, road, side)
    if v is changing:
        return start
    return told if told is not None else start


def _runs_into(v: VehicleFacts, facts: CrashFacts) -> bool:
    """Whether its first contact is of its own front with the back of the other one; one whose back is struck has cut in
    before that one, which drives in the lane into which the change leads."""
    first = facts.first_contact(v.id)
    if first is None:
        return False
    own, others = first.striker_area, first.struck_area
    return (own, others) == (("front", "back") if first.striker == v.id else ("back", "front"))


def _before_change(v: VehicleFacts, other: VehicleFacts | None, road: tuple[int, tuple[Turn, ...]], side: int) -> int:
    """The lane from which a vehicle changes to a side: as told, else beside the told lane of the one that it meets; a
    told lane that has none on that side is the one into which it changes."""
    count, turns = road
    told = _stated_lane(v, count, turns)
    target = _stated_lane(other, count, turns) if other and told is None else None
    if told is None and target is not None:
        told = target - side
    if told is None:
        told = 1 if side > 0 else _last(turns, _THROUGH) or count
    return min(max(told, 1 + (side < 0)), count - (side > 0))


def _met(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> VehicleFacts | None:
    """The one that it meets first, if that drives on the same way."""
    other = facts.first_met(v.id)
    return other if other and other.id in placed and placed[other.id].way == placed[v.id].way else None


# ------------------------------------------------------------------ as told
def _stated_lane(v: VehicleFacts, count: int, turns: tuple[Turn, ...]) -> int | None:
    """As told; "the right lane" without a right turn is the rightmost through lane, likewise on the left."""
    if v.lane:
        return min(v.lane, count) if v.lane > 0 else max(1, count + 1 + v.lane)
    straight = "turn" not in v.maneuver and v.meant is None
    if straight and v.lane_word == "right":
        return _first(turns, _THROUGH) or 1
    if straight and v.lane_word == "left":
        return _last(turns, _THROUGH) or count
    middle = (count + 1) // 2
    left = {"left": count, "left_turn": count, CENTER: count}
    return {**left, "right": 1, "right_turn": 1, "middle": middle}.get(v.lane_word or "")


def _leader(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> VehicleFacts | None:
    """One that it runs into (or that runs into it) from behind, on the same way: they share a lane. Of a row the first
    one whose lane is told, else its neighbor."""
    row, next_ones = [v], list(_in_row(v, placed, facts))
    for other in next_ones:
        if other not in row:
            row.append(other)
            next_ones += _in_row(other, placed, facts)
    others = row[1:]
    return next((other for other in others if other.lane or other.lane_word), next(iter(others), None))


def _in_row(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> Iterator[VehicleFacts]:
    """Those that touch it with a back, on the same way, in the order of the contacts."""
    for c in facts.contacts:
        if v.id in (c.striker, c.struck) and "back" in (c.striker_area, c.struck_area):
            other = facts.vehicle(c.struck if c.striker == v.id else c.striker)
            if other and other.id in placed and placed[other.id].way == placed[v.id].way:
                yield other


def _by_turn(v: VehicleFacts, count: int, turns: tuple[Turn, ...]) -> int | None:
    if _waits_to_turn(v):
        return (_last(turns, _LEFT) or count) if v.meant == "turn_left" else (_first(turns, _RIGHT) or 1)
    if v.maneuver in ("turn_left", "u_turn"):
        return _last(turns, _LEFT) or count
    if v.maneuver in ("turn_right", "parked"):
        return _first(turns, _RIGHT) or 1 if v.maneuver == "turn_right" else 1
    return None if all(t in _THROUGH for t in turns) else _first(turns, _THROUGH)


def _waits_to_turn(v: VehicleFacts) -> bool:
    return v.maneuver in ("stopped", "slowing") and v.meant is not None


def _first(turns: tuple[Turn, ...], wanted: tuple[Turn, ...]) -> int | None:
    return next((i for i, t in enumerate(turns, 1) if t in wanted), None)


def _last(turns: tuple[Turn, ...], wanted: tuple[Turn, ...]) -> int | None:
    return next((i for i, t in reversed(list(enumerate(turns, 1))) if t in wanted), None)
