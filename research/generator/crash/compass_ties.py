"""Which facts a narrative ties to the compass: a road counts as told only where a reader could say which legs it is.

"A T-intersection of a four-lane street and a two-lane street" tells lanes, yet neither which legs there are nor which
of them has how many lanes; that takes a direction of travel beside a road, or the word of an axis.
"""

from __future__ import annotations

from collections.abc import Iterable, Set

from research.generator.crash.world import TURN_OF, Actor, Crash, Leg
from research.generator.grammar import HINT
from sgcad_core.kinds import FOUR, INTERSECTIONS, PLAIN, ROAD, T

ROAD_HINT = f"{HINT}road"
"""With an axis: a sentence speaks of the road of that axis, without saying how it lies."""
AXIS = f"{HINT}axis"
"""With an axis: a sentence says how the road of that axis lies."""
STEM = f"{HINT}stem"
"""A sentence says where the leg lies that ends at the junction."""

FLOW = f"{HINT}flow"
"""With an axis: a sentence says which way the one-way road of that axis leads."""

FROM_LEFT = f"{HINT}left"
"""With an actor: a sentence names its lane from the left or by use ("the left lane", "the through lane"), which tells
its number, counted from the right, only beside the lanes of that approach."""

VAGUE = f"{HINT}vague"
"""With a fact: the sentence tells only a part of it. One who met a stop sign leaves open who else has one; "divided"
leaves open by what."""

BY_AXIS = ("lanes", "ways", "turns", "median", "limit")
"""Facts of one road; "ways" is whether it is one-way, of however many lanes."""


def uncertain_facts(crash: Crash, sentences: Iterable[frozenset[str]]) -> set[str]:
    """Facts that sentences tell in part or of no known leg; "legs" where it stays open which legs there are.

    Then nothing about the legs beside the main road is known either, nor which legs a control stands at, unless all
    legs have the same.
    """
    sentences = list(sentences)
    told = {fact for facts in sentences for fact in facts}
    whole = {fact for facts in sentences for fact in facts if f"{VAGUE}.{fact}" not in facts}
    tied = _tied(crash, sentences, told)
    roads = [(fact, facts) for facts in sentences for fact in facts if fact.partition(".")[0] in BY_AXIS]
    out = {fact for fact, _ in roads} - {fact for fact, facts in roads if _placed(crash, fact, facts, tied, sentences)}
    if not _legs(crash, told, tied):
        stems = {leg.bearing % 4 for leg in crash.stems}
        alike = len({leg.control for leg in crash.legs if leg.lanes_in}) == 1
        out |= {"legs"} | (set() if alike else {"control"})
        out |= told & {f"{key}.{axis}" for key in BY_AXIS for axis in stems}
    return out | (told - whole) | _uncounted(crash, sentences, told - out)


def _uncounted(crash: Crash, sentences: Iterable[frozenset[str]], known: Set[str]) -> set[str]:
    """Lanes named from the left by every sentence that names them, on an approach whose lanes are not `known`."""
    out = set()
    for actor in crash.actors:
        lane = f"lane.{actor.id}"
        named = [f"{FROM_LEFT}.{actor.id}" in facts for facts in sentences if lane in facts]
        if named and all(named) and not lanes_beside(crash, actor) <= known:
            out.add(lane)
    return out


def lanes_beside(crash: Crash, actor: Actor) -> set[str]:
    """Facts without which a lane that is named from the left cannot be numbered from the right."""
    leg = crash.leg(actor.leg)
    return {f"{key}.{actor.leg % 4}" for key in ("lanes", *(("turns",) if leg and leg.turns_in else ()))}


def _tied(crash: Crash, sentences: list[frozenset[str]], told: set[str]) -> bool:
    """Whether some sentence lays some road on the compass; the other road then crosses it."""
    if any(fact.startswith(AXIS) for fact in told):
        return True
    headed = [{f"{ROAD_HINT}.{actor.leg % 4}", f"heading.{actor.id}"} for actor in crash.actors]
    if crash.layout in INTERSECTIONS:
        return any(pair <= facts for facts in sentences for pair in headed)
    return bool(_headed(crash.actors, told))


def _placed(crash: Crash, fact: str, facts: frozenset[str], tied: bool, sentences: list[frozenset[str]]) -> bool:
    """Whether a fact of a road belongs to known legs: told beside a direction, of a road that is named, or of both."""
    key, _, axis = fact.partition(".")
    if key in ("lanes", "ways") and not _directed(crash, int(axis), {fact for some in sentences for fact in some}):
        return False
    if any(other.startswith((AXIS, "heading.")) for other in facts):
        return True
    same = len({_value(key, leg) for leg in crash.legs}) == 1
    if key == "limit":  # may stay open, so that a limit of either road has to be laid on one of them
        told = {fact for some in sentences for fact in some}
        same = same and all(f"limit.{leg.bearing % 4}" in told for leg in crash.legs)
    if same or crash.layout not in INTERSECTIONS:
        return tied
    return tied and any(fact in some and f"{ROAD_HINT}.{axis}" in some for some in sentences)


def _directed(crash: Crash, axis: int, told: set[str]) -> bool:
    """Whether the direction of a one-way road is known: it is told, or an actor drives on it."""
    if all(leg.two_way for leg in crash.legs if leg.bearing % 4 == axis and leg.kind == ROAD):
        return True
    used = {leg % 4 for leg in driven(crash.actors, told)}
    return axis in used or f"{FLOW}.{axis}" in told


def _value(key: str, leg: Leg) -> tuple[object, ...]:
    return {
        "lanes": (leg.lanes_in, leg.lanes_out),
        "ways": (leg.lanes_in > 0, leg.lanes_out > 0),
        "turns": tuple(leg.turns_in),
        "median": (leg.median,),
        "limit": (leg.limit,),
    }[key]


def _legs(crash: Crash, told: set[str], tied: bool) -> bool:
    """Whether the text tells which legs there are."""
    if crash.layout in (PLAIN, FOUR):
        return tied or bool(_headed(crash.actors, told))
    found = driven(crash.actors, told)
    found |= {leg for own in crash.legs if f"turns.{own.bearing % 4}" in told for leg in led_to(own)}
    stem = {leg.bearing for leg in crash.stems}
    if stem <= found and crash.layout != T:
        return tied
    return STEM in told or {leg.bearing for leg in crash.legs} <= found


def _headed(actors: Iterable[Actor], told: Set[str]) -> list[Actor]:
    """Those whose heading is told."""
    return [actor for actor in actors if f"heading.{actor.id}" in told]


def driven(actors: Iterable[Actor], told: Set[str]) -> set[int]:
    """Bearings of the legs that are used by those of `actors` whose heading is told."""
    headed = _headed(actors, told)
    outs = {actor.exit_of(told) for actor in headed if f"man.{actor.id}" in told}
    return {actor.leg for actor in headed} | {out for out in outs if out is not None}


def led_to(leg: Leg) -> list[int]:
    """Legs that the lanes of one lead to."""
    return [(leg.bearing + TURN_OF[way]) % 8 for use in leg.turns_in for way in use.split("_") if way in TURN_OF]
