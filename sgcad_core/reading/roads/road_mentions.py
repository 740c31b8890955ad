"""Every road that a report mentions, in order: noun phrase, compass axis, vehicles on it, lanes stated.

A mention is the noun phrase around a road word ("the intersecting two-lane, two-way road") with what stands behind it
up to the next mention. `sgcad_core.reading.roads.road_merge` joins mentions of one road.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from sgcad_core.kinds import ALLEY, DRIVEWAY, RAMP
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.roads.lane_sources import with_sources
from sgcad_core.reading.roads.lanes import LaneFacts, lane_facts
from sgcad_core.reading.text.compass import COMPASS, compass_of
from sgcad_core.records.specs import Compass

Relation = Literal["same", "other", "main", "both"]
How = Literal["on", "from", "onto"]
Kind = Literal["road", "freeway", "ramp", "driveway", "alley", "crossroads"]


@dataclass(frozen=True)
class RoadMention:
    """One mention of one road (or of "both roads").

    `axis` is N, NE, E or SE (the axis N runs north and south); `toward` a single direction named with the
    road; `vehicles` are on it at first (how "on" or "from") or come to it ("onto").
    """

    text: str
    kind: Kind
    axis: Compass | None
    toward: Compass | None
    relation: Relation | None
    definite: bool
    vehicles: tuple[str, ...]
    how: How | None
    lanes: LaneFacts
    sentence: int


def axis_of(direction: Compass) -> Compass:
    """The axis a direction lies on: N, NE, E or SE."""
    return COMPASS[COMPASS.index(direction) % 4]


def axis_in(text: str) -> Compass | None:
    """The first axis that a pair names: "north/south", "east and west", "northbound/southbound"."""
    pair = _PAIR.search(text)
    if not pair:
        return None
    first, second = compass_of(pair[1]), compass_of(pair[2])
    return axis_of(first) if first and second and first != second and axis_of(first) == axis_of(second) else None


_PAIR = rule("mentions.pair")
_VEHICLE = rule("mentions.vehicle")


def road_mentions(statements: Iterable[Statement], ids: tuple[str, ...]) -> tuple[RoadMention, ...]:
    """Mentions in order of the text. `ids`: all vehicles, for "both vehicles"."""
    return tuple(mention for sentence in statements for mention in _sentence(sentence, ids))


def _sentence(statement: Statement, ids: tuple[str, ...]) -> Iterator[RoadMention]:
    text = statement.text
    spans = list(noun_phrases(text))
    if not spans:
        facts = with_sources(lane_facts(text), statement.number, text)
        if not facts.empty:
            yield from _by_axis(_bare(statement, facts))
        return
    for index, (start, head_start, end) in enumerate(spans):
        stop = spans[index + 1][0] if index + 1 < len(spans) else len(text)
        lead = text[spans[index - 1][2] if index else 0 : start]
        yield _mention(statement, (lead, text[start:end], text[end:stop]), text[head_start:end], (index == 0, ids))


def _by_axis(mention: RoadMention) -> Iterator[RoadMention]:
    """A mention without a road word, once for each axis of the lanes that it tells."""
    ways = {axis_of(c) for c in COMPASS if c in mention.lanes.toward}
    if len(ways) < 2:
        yield mention
        return
    for axis in sorted(ways):
        toward = {way: n for way, n in mention.lanes.toward.items() if axis_of(_compass(way)) == axis}
        turns = {way: t for way, t in mention.lanes.turns.items() if way in _NO_WAY or axis_of(_compass(way)) == axis}
        lanes = LaneFacts(toward=toward, turns=turns, where=mention.lanes.where)
        yield RoadMention(mention.text, "road", axis, None, None, True, (), None, lanes, mention.sentence)


_NO_WAY = ("any", "each")
"""What `LaneFacts.turns` says in place of a direction."""


def _compass(word: str) -> Compass:
    return next(c for c in COMPASS if c == word)


def _bare(statement: Statement, facts: LaneFacts) -> RoadMention:
    axis = _axis_of_lanes(facts) or axis_in(statement.text)
    who = tuple(dict.fromkeys(_VEHICLE.findall(statement.text)))[:1]
    return RoadMention(
        statement.text, "road", axis, None, None, True, who, "on" if who else None, facts, statement.number
    )


def _axis_of_lanes(facts: LaneFacts) -> Compass | None:
    ways = {axis_of(_compass(way)) for way in (*facts.toward, *facts.turns) if way not in _NO_WAY}
    return next(iter(ways)) if len(ways) == 1 else None


def _mention(
    statement: Statement, parts: tuple[str, str, str], head: str, place: tuple[bool, tuple[str, ...]]
) -> RoadMention:
    lead, phrase, behind = parts
    first, ids = place
    said = (_lead_tail(lead) if first else "") + phrase + behind
    facts = with_sources(lane_facts(said), statement.number, said)
    vehicles, how = _drivers(lead, behind, ids)
    toward = _toward(phrase)
    axis = axis_in(phrase) or (axis_of(toward) if toward else None) or _running(behind) or _lane_direction(lead)
    if how == "on" and not axis:
        axis = _travel_axis(lead)
    return RoadMention(
        said, _kind(phrase, head, lead), axis or _axis_of_lanes(facts), toward, _relation(phrase, lead),
        bool(rule("mentions.definite").match(phrase)),
        vehicles, how, facts, statement.number,
    )  # fmt: skip


def _lead_tail(lead: str) -> str:
    """What stands before the first noun phrase, behind the last vehicle named there."""
    last = list(_VEHICLE.finditer(lead))
    return lead[last[-1].end() :] if last else lead


def _toward(phrase: str) -> Compass | None:
    """The one direction in a noun phrase ("the westbound road"); None where a pair or nothing is named."""
    if _PAIR.search(phrase):
        return None
    words = rule("mentions.direction").findall(phrase)
    return compass_of(words[-1]) if words else None


def _running(behind: str) -> Compass | None:
    """ "... ran north and south": the axis told right behind the noun."""
    runs = rule("mentions.runs").match(behind)
    return axis_in(behind[runs.end() : runs.end() + 40]) if runs else None


def _lane_direction(lead: str) -> Compass | None:
    """ "in the eastbound lane of a": the road's axis."""
    found = rule("mentions.lane_of").search(lead)
    way = compass_of(found[1]) if found else None
    return axis_of(way) if way else None


def _travel_axis(lead: str) -> Compass | None:
    """The last direction of travel before the noun phrase."""
    words = rule("mentions.travel_direction").findall(lead)
    way = compass_of(words[-1]) if words else None
    return axis_of(way) if way else None


def _relation(phrase: str, lead: str) -> Relation | None:
    """As the phrase says, else "other" behind "intersects", "intersection with"."""
    found = next((told.yields["relation"] for told in of_role("relation") if told.search(phrase)), None)
    return found or ("other" if rule("mentions.meets").search(lead) and not _VEHICLE.search(lead[-40:]) else None)


def _drivers(lead: str, behind: str, ids: tuple[str, ...]) -> tuple[tuple[str, ...], How | None]:
    """Vehicles on the road mentioned, told by the verb before or the relative clause behind."""
    relative = rule("mentions.relative").match(behind)
    if relative and rule("mentions.relative_begins").match(behind):
        return (relative[1],), "on"
    vehicles = [m for m in _VEHICLE.finditer(lead) if m[0] in ids]
    everyone = list(rule("mentions.both_vehicles").finditer(lead))
    last = max((m.end() for m in vehicles + everyone), default=-1)
    if last < 0:
        return (), None
    who = ids if everyone and everyone[-1].end() == last else _joined(lead, vehicles)
    tail = lead[last:]
    how = _how(tail)
    return (who, how) if how else ((), None)


def _joined(lead: str, vehicles: list[re.Match[str]]) -> tuple[str, ...]:
    """The last vehicle named, with those joined to it by "and"."""
    who = [vehicles[-1][0]]
    for first, second in zip(reversed(vehicles[:-1]), reversed(vehicles[1:]), strict=True):
        if not rule("mentions.joined").fullmatch(lead[first.end() : second.start()]):
            break
        who.append(first[0])
    return tuple(who)


def _how(tail: str) -> How | None:
    if rule("mentions.from").search(tail):
        return "from"
    if rule("mentions.onto").search(tail):
        return "onto"
    on = rule("mentions.on").search(tail := rule("mentions.junction_on_the_way").sub("", tail))
    return "on" if on and not rule("mentions.left_it").search(tail) else None


def _kind(phrase: str, head: str, lead: str) -> Kind:
    word = head.lower()
    if RAMP in word:
        return RAMP
    if rule("mentions.alley").search(word):
        return ALLEY
    if rule("mentions.driveway").search(word) or rule("mentions.private").search(phrase):
        return DRIVEWAY
    if rule("mentions.freeway").search(phrase) and not rule("mentions.aside").search(lead):
        return "freeway"
    return "crossroads" if "intersection" in word else "road"


_STOP = frozenset({
    "a", "an", "the", "this", "that", "these", "another", "each", "both", "all", "of", "on", "in", "at", "into",
    "onto", "from", "to", "along", "near", "by", "for", "was", "is", "were", "are", "had", "has", "with", "where",
    "which", "when", "toward", "towards", "between", "approaching", "entered", "entering", "entire", "down", "up",
    "upon", "across", "over", "through", "past", "it", "its", "his", "her", "their", "as", "before", "after", "off",
    "around", "than", "driver", "s", "crossed", "exited", "exiting", "two-vehicle", "while", "but", "there",
})  # fmt: skip
_DETERMINERS = ("a", "an", "the", "this", "that", "another", "each", "both", "all", "these")


def noun_phrases(text: str) -> Iterator[tuple[int, int, int]]:
    """(start, start of the road word, end) of each road's noun phrase; of "freeway entrance ramp" the last word."""
    held: tuple[int, int, int] | None = None
    for head in rule("road_phrases.head").finditer(text):
        start = _phrase_start(text, head.start())
        if "intersection" in head[0].lower() and "-lane" not in text[start : head.start()]:
            continue
        if held and _in_brackets(text[held[2] : head.start()]):
            continue
        if held and start >= held[2]:
            yield held
        held = (min(start, held[0]) if held and start < held[2] else start, head.start(), head.end())
    if held:
        yield held


def _in_brackets(between: str) -> bool:
    return between.count("(") > between.count(")")


def _phrase_start(text: str, at: int) -> int:
    """Back over the modifiers to the determiner, or to the word that cannot stand in a noun phrase."""
    start = at
    for word in reversed(list(rule("road_phrases.word").finditer(text[:at]))[-16:]):
        token = word[0].strip(",()\"'").lower()
        if word[0][-1] in ".;:)" or rule("road_phrases.vehicle").fullmatch(token):
            break
        if token in _STOP and not _within_pair(text, word.start(), token):
            return word.start() if token in _DETERMINERS else start
        start = word.start()
    return start


def _within_pair(text: str, at: int, token: str) -> bool:
    """The "to" of "east to west"."""
    before = rule("road_phrases.direction_before").search(text[:at])
    return token in ("to", "/") and bool(before and rule("road_phrases.direction_behind").match(text[at:]))
