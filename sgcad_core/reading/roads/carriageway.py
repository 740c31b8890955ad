"""How many lanes a road has in each direction, from whatever its text states of them.

`approach` are the lanes towards a junction with turn lanes, `through` those that lead away from one. Knows
no junction shape and no vehicle but the lanes that vehicles are told to be in.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import Compass

MOST = 7
"""Lanes in one direction; more is a misreading."""
_FEW, _TWO_EACH = 3, 4
"""A total that is too small for both halves of a divided road, and the least that is not."""


@dataclass(frozen=True)
class DirectionLanes:
    """One direction of travel."""

    approach: int
    through: int
    left_turn: int = 0
    right_turn: int = 0


@dataclass(frozen=True)
class Carriageway:
    """Both directions of a road; `stated`: the text gives a number (else it is a default)."""

    ways: Mapping[Compass, DirectionLanes]
    center_turn_lane: bool = False
    total: int | None = None
    stated: bool = False

    def way(self, toward: Compass) -> DirectionLanes:
        """The direction's lanes; none at all against a one-way road."""
        return self.ways.get(toward, DirectionLanes(0, 0))


def carriageway(
    facts: LaneFacts,
    axis: Compass,
    lead: Compass,
    used: Mapping[Compass, int],
    default: int = 1,
    *,
    numbered: bool = False,
    against: bool = False,
) -> Carriageway:
    """Lanes by direction of a road on `axis`.

    `lead`: the direction that vehicles travel in (of a one-way road, and the wider one of an odd number).
    `used`: travel direction -> the highest lane that a vehicle is told to be in. `default`: lanes each way
    where nothing is stated. `numbered`: a vehicle is in a lane with a number, as of one carriageway. `against`:
    vehicles are told to drive both ways, on a one-way road too: one of its lanes is then for the wrong way.
    """
    ends = (lead, turned(lead, 180))
    facts = _placed_turns(facts, ends)
    if facts.one_way:
        return _one_way(facts, facts.one_way_toward if facts.one_way_toward in ends else lead, used, against)
    if _of_one_carriageway(facts, max(used.values(), default=1), numbered):
        facts = replace(facts, total=None, each_way=facts.total)
    ways = _two_way(facts, ends, used, default)
    stated = bool(facts.total or facts.each_way or facts.toward)
    return Carriageway(ways, facts.center_turn_lane or _hidden_center(facts, ends), facts.total, stated)


def _placed_turns(facts: LaneFacts, ends: tuple[Compass, Compass]) -> LaneFacts:
    """Turn lanes told for each direction, and those told for none where lanes each way are even: the lead's."""
    turns = dict(facts.turns)
    if "each" in turns:
        turns |= {way: turns["each"] for way in ends if way not in turns}
    even = facts.each_way or (facts.total and facts.total % 2 == 0 and not facts.center_turn_lane and not facts.toward)
    if "any" in turns and even and not any(way in turns for way in ends):
        turns[ends[0]] = turns["any"]
    return replace(facts, turns=turns)


def _one_way(facts: LaneFacts, toward: Compass, used: Mapping[Compass, int], against: bool = False) -> Carriageway:
    count = facts.toward.get(toward) or facts.total or facts.each_way or 1
    count = max(count, 1 if facts.total else used.get(toward, 1))
    if not against:
        return Carriageway({toward: _way(facts, toward, count)}, total=count, stated=True)
    ways = {toward: _way(facts, toward, max(1, count - 1)), turned(toward, 180): DirectionLanes(1, 1)}
    return Carriageway(ways, total=max(2, count), stated=True)


def _way(facts: LaneFacts, toward: Compass, approach: int) -> DirectionLanes:
    turns = facts.turns.get(toward, ())
    left, right = turns.count("left"), turns.count("right")
    approach = min(max(approach, 1), MOST)
    return DirectionLanes(approach, max(1, approach - left - right), left, right)


def _turn_lanes(facts: LaneFacts, toward: Compass) -> int:
    return len(facts.turns.get(toward, ()))


def _two_way(
    facts: LaneFacts, ends: tuple[Compass, Compass], used: Mapping[Compass, int], default: int
) -> dict[Compass, DirectionLanes]:
    told = {way: facts.toward[way] for way in ends if way in facts.toward and not _only_turns(facts, way)}
    if not told and not facts.each_way and facts.total:
        return _split(facts, ends, used)
    if facts.each_way and len(told) < 2:
        told = {way: told.get(way, facts.each_way + _turn_lanes(facts, way)) for way in ends}
    elif len(told) == 1:
        told = _other_side(facts, ends, told)
    elif not told:
        base = max(default, *(used.get(way, 1) - _turn_lanes(facts, way) for way in ends))
        told = {way: base + _turn_lanes(facts, way) for way in ends}
    ways = {way: _way(facts, way, count) for way, count in told.items()}
    if _spare(facts, told) == 1 and "left" in facts.turns.get("any", ()):
        first = ways[ends[0]]
        ways[ends[0]] = DirectionLanes(
            min(first.approach + 1, MOST), first.through, first.left_turn + 1, first.right_turn
        )
    return ways


def _spare(facts: LaneFacts, told: Mapping[Compass, int]) -> int:
    """Lanes of the total that no direction claims."""
    return (facts.total or 0) - sum(told.values()) - facts.center_turn_lane


def _only_turns(facts: LaneFacts, way: Compass) -> bool:
    """Lanes counted for this direction are but its turn lanes, beside lanes told otherwise."""
    return facts.toward[way] == _turn_lanes(facts, way) and bool(facts.each_way or len(facts.toward) < 2)


def _hidden_center(facts: LaneFacts, ends: tuple[Compass, Compass]) -> bool:
    """Whether the lanes of both directions leave one lane of an odd total over."""
    if not facts.total or facts.turns or facts.divided:
        return False
    each = [facts.toward.get(way) or facts.each_way or 0 for way in ends]
    return all(each) and facts.total - sum(each) == 1


def _other_side(facts: LaneFacts, ends: tuple[Compass, Compass], told: dict[Compass, int]) -> dict[Compass, int]:
    ((way, count),) = told.items()
    other = ends[1] if way == ends[0] else ends[0]
    rest = (facts.total or 0) - count - facts.center_turn_lane
    if rest < 1 or facts.divided:
        rest = max(1, count - _turn_lanes(facts, way)) + _turn_lanes(facts, other)
    return {way: count, other: rest}


def _split(
    facts: LaneFacts, ends: tuple[Compass, Compass], used: Mapping[Compass, int]
) -> dict[Compass, DirectionLanes]:
    """A total over both directions. Of an odd one the spare lane is a turn lane of each approach. A direction in which
    a vehicle is in a lane beyond the half of an undivided road has more of them than the other one."""
    total = min(facts.total or 2, 2 * MOST)
    half = max(1, total // 2)
    wide = next((way for way in ends if used.get(way, 1) > half + total % 2), None)
    if wide and not facts.divided and not facts.turns:
        other = ends[1] if wide == ends[0] else ends[0]
        if used.get(other, 1) <= total - used[wide]:
            return {wide: _way(facts, wide, used[wide]), other: _way(facts, other, total - used[wide])}
    if total % 2 and total > 1 and not facts.center_turn_lane:
        spare = [way for way in ends if _turn_lanes(facts, way)] or list(ends)
        return {way: DirectionLanes(half + 1, half, 1) if way in spare else DirectionLanes(half, half) for way in ends}
    return {way: _way(facts, way, half + _turn_lanes(facts, way)) for way in ends}


def _of_one_carriageway(facts: LaneFacts, used: int, numbered: bool) -> bool:
    """Whether a total is that of one half of a divided road.

    Fitted to 14,280 coded reports. Of a road without a word on its divide: where a vehicle is in a lane that half of
    them would not have, and of a highway (seven of eight), but of four lanes without a numbered one. Of a divided one:
    of two or three lanes, of an odd total, and in a lane beyond the half always; an even total with a numbered lane or
    of a highway, unless the road is told to be two-way (then four of five are those of both halves). Without a numbered
    lane a "four-lane divided highway" has two lanes each way, as people say it; of 18 coded ones 10 meant four. Seven
    lanes are those of both halves (31 of 48).
    """
    total = facts.total or 0
    told = facts.each_way or facts.toward or facts.turns or facts.center_turn_lane
    least = _FEW if facts.divided is None else 2
    if facts.divided is False or told or not least <= total <= MOST:
        return False
    beyond = used > (total + 1) // 2
    if facts.divided is None:
        return facts.one_way is None and (beyond or (facts.highway and (numbered or total != _TWO_EACH)))
    if total == MOST and not beyond:
        return False
    of_half = total <= _FEW or total % 2 == 1 or beyond
    return of_half or (facts.one_way is not False and (numbered or (facts.highway and total != _TWO_EACH)))
