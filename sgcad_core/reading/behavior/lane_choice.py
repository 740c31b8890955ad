"""The lane of each vehicle, 1 = at the right curb: as told, else what its maneuver and partner ask for."""

from __future__ import annotations

from sgcad_core.reading.behavior.exit_assignment import Placed
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.records.specs import Turn

_LEFT: tuple[Turn, ...] = ("left", "left_through", "left_right", "any")
_RIGHT: tuple[Turn, ...] = ("right", "through_right", "left_right", "any")
_THROUGH: tuple[Turn, ...] = ("through", "left_through", "through_right", "any")


def lane_of(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> int | None:
    """The lane in which it starts; None leaves the choice to the planner."""
    way = placed[v.id].way
    count = way.lanes
    if count == 1:
        return 1
    told = _stated_lane(v, count, way.turns)
    if told is not None:
        return told
    partner = _leader(v, placed, facts)
    if partner is not None and not _waits_to_turn(v):
        shared = _stated_lane(partner, count, way.turns)
        return shared if shared is not None else _by_turn(partner, count, way.turns)
    return _by_turn(v, count, way.turns)


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
    return {"left": count, "left_turn": count, "right": 1, "right_turn": 1, "middle": middle}.get(v.lane_word or "")


def _leader(v: VehicleFacts, placed: dict[str, Placed], facts: CrashFacts) -> VehicleFacts | None:
    """The one it runs into (or that runs into it) from behind, on the same way: they share a lane."""
    for c in facts.contacts:
        if v.id in (c.striker, c.struck) and "back" in (c.striker_area, c.struck_area):
            other = facts.vehicle(c.struck if c.striker == v.id else c.striker)
            if other and other.id in placed and placed[other.id].way == placed[v.id].way:
                return other
    return None


def _by_turn(v: VehicleFacts, count: int, turns: tuple[Turn, ...]) -> int | None:
    if _waits_to_turn(v):
        return (_last(turns, _LEFT) or count) if v.meant == "turn_left" else (_first(turns, _RIGHT) or 1)
    if v.maneuver in ("turn_left", "u_turn", "lane_change_right"):
        return _last(turns, _LEFT) or count
    if v.maneuver in ("turn_right", "lane_change_left", "parked"):
        return _first(turns, _RIGHT) or 1 if v.maneuver == "turn_right" else 1
    return None if all(t in _THROUGH for t in turns) else _first(turns, _THROUGH)


def _waits_to_turn(v: VehicleFacts) -> bool:
    return v.maneuver in ("stopped", "slowing") and v.meant is not None


def _first(turns: tuple[Turn, ...], wanted: tuple[Turn, ...]) -> int | None:
    return next((i for i, t in enumerate(turns, 1) if t in wanted), None)


def _last(turns: tuple[Turn, ...], wanted: tuple[Turn, ...]) -> int | None:
    return next((i for i, t in reversed(list(enumerate(turns, 1))) if t in wanted), None)
