"""Where each of a road's lane facts was read: kept beside the facts while mentions of one road are put together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.roads.lanes import LaneFacts

_RULES = {
    "total": "lanes.total", "each_way": "lanes.each", "toward": "lanes.item", "turns": "lanes.item",
    "one_way_toward": "lanes.flow", "center_turn_lane": "lanes.center_turn", "own": "lanes.own",
}  # fmt: skip
"""Fields of `LaneFacts` and the rules that read them; what a field of direction says of N is "toward N"."""


def stated_values(facts: LaneFacts) -> dict[str, Any]:
    """What is stated, a value a field, and of the fields by direction a value a direction."""
    plain = {
        "total": facts.total, "each_way": facts.each_way, "one_way": facts.one_way, "own": facts.own,
        "one_way_toward": facts.one_way_toward, "center_turn_lane": facts.center_turn_lane or None,
        "median": facts.median, "divided": facts.divided,
    }  # fmt: skip
    ways: dict[str, Any] = {f"toward {way}": count for way, count in facts.toward.items()}
    ways |= {f"turns {way}": sides for way, sides in facts.turns.items()}
    return {name: value for name, value in plain.items() if value is not None} | ways


def with_sources(facts: LaneFacts, number: int, said: str) -> LaneFacts:
    """The facts with their place: a sentence and the words of it that were read."""
    return replace(facts, where={name: _cue(name, value, number, said) for name, value in stated_values(facts).items()})


def with_sources_of_both(merged: LaneFacts, first: LaneFacts, more: LaneFacts) -> LaneFacts:
    """`merged` with the places of whichever statement each of its facts is from; of both, the first."""
    kept, told = stated_values(merged), stated_values(first)
    where = {n: c for n, c in {**more.where, **first.where}.items() if n in kept}
    late = {n: c for n, c in more.where.items() if n in kept and told.get(n) != kept[n]}
    return replace(merged, where=where | late)


def derived_sources(facts: LaneFacts, name: str, basis: str) -> Mapping[str, Source]:
    """The places with that of a fact that follows from another one."""
    source = facts.where.get(basis)
    return {**facts.where, **({name: source} if source else {})}


def with_center_lane_placed(roads: Sequence[LaneFacts]) -> list[LaneFacts]:
    """The lanes of all roads, where a center turn lane that was read of a road of two lanes at most is one of the only
    other road of an odd number of three or more: the first has no room for it."""
    found = list(roads)
    narrow = [n for n, one in enumerate(found) if one.center_turn_lane and one.total in (1, 2)]
    wide = [n for n, one in enumerate(found) if (one.total or 0) >= 3 and (one.total or 0) % 2]
    if len(narrow) == len(wide) == 1:
        (one,), (other,), name = narrow, wide, "center_turn_lane"
        where = dict(found[one].where)
        source = {name: where.pop(name)} if name in where else {}
        found[other] = replace(found[other], center_turn_lane=True, where={**found[other].where, **source})
        found[one] = replace(found[one], center_turn_lane=False, where=where)
    return found


def _cue(name: str, value: object, number: int, said: str) -> Source:
    for by in _rules_of(name.split()[0], value):
        if match := rule(by).search(said):
            return Source(number, match[0].strip(" ,;."), by)
    return Source(number, "", "lanes.item")  # told by several counts together


def _rules_of(name: str, value: object) -> tuple[str, ...]:
    if name == "one_way":
        return ("lanes.one_way",) if value else ("lanes.two_way",)
    if name == "divided":
        return ("median.divided", *_medians()) if value else ("median.undivided",)
    return _medians() if name == "median" else (_RULES[name],)


def _medians() -> tuple[str, ...]:
    return tuple(kind.id for kind in of_role("median_kind"))
