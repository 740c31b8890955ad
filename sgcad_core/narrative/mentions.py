"""Every road that a report mentions, in order: noun phrase, compass axis, who drives on it, lanes stated.

A mention is the noun phrase around a road word ("the intersecting two-lane, two-way road") with what stands
behind it up to the next mention. Which mentions are one and the same road is decided elsewhere.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from sgcad_core.narrative.clauses import Told
from sgcad_core.narrative.compass import COMPASS, compass_of
from sgcad_core.narrative.lanes import BOUND, DIR, LaneFacts, lane_facts
from sgcad_core.narrative.road_phrases import noun_phrases
from sgcad_core.specs import Compass

Relation = Literal["same", "other", "main", "both"]
How = Literal["on", "from", "onto"]
Kind = Literal["road", "freeway", "ramp", "driveway", "crossroads"]


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


_PAIR = re.compile(rf"\b({DIR})[ -]*(?:/|-|\band\b|\bto\b|\bor\b|&|,)[ -]*({DIR})\b", re.I)
_RELATIONS: tuple[tuple[Relation, str], ...] = (
    ("both", r"^(?:both|all|each|either|these)\b|"
             r"\btwo (?!-|lane|way)(?:[\w/-]+,? ){0,6}(?:roads|roadways|streets|highways|avenues)$"),
    ("same", r"\b(?:same|aforementioned)\b"),
    ("other", r"\b(?:intersecting|crossing|cross|side|secondary|minor|other|another|second|adjoining|terminating|"
              r"perpendicular|connecting)\b"),
    ("main", r"\b(?:main|primary|major|through|first)\b"),
)  # fmt: skip
_RELATION = tuple((name, re.compile(pattern, re.I)) for name, pattern in _RELATIONS)
_RUNS = re.compile(
    r"^[\w ,()-]{0,60}?\b(?:r[au]n(?:s|ning)?|go(?:es|ing)|went|oriented|travels?|traveling|extend(?:s|ed|ing)|lie|"
    r"lies|is|was|"
    r"that is|aligned)(?: (?:in )?(?:an?|the|generally|primarily|in))* (?=(?:north|south|east|"
    r"west))", re.I)  # fmt: skip
_ON = re.compile(
    r"\b(?:travel\w*|driving|drove|stopped|head(?:ed|ing)|proceeding|proceeded|going|moving|facing|parked|disabled|"
    r"backing|slowing|"
    r"decelerating|merging|waiting|was|were|been|negotiating|lane|lanes|(?:north|south|east|west)\w*bound|north|"
    r"south|east|west)\b"
    r"(?P<rest>[^.;]*?)\b(?:on|of|in|along|down|upon|up|over)(?: (?:the|a|an|this|same|that|its|his|her|their|"
    r"their))*\s*$", re.I)  # fmt: skip
_LEFT_IT = re.compile(
    r"\b(?:approach\w*|onto|into|toward\w*|from|exit\w*|turn\w*|cross\w*|enter\w*|merg\w+|intersect\w*|junction|"
                      r"struck|off|before|edge|side of|shoulder|middle)\b", re.I)  # fmt: skip
_FROM = re.compile(
    r"\b(?:from|exit(?:ed|ing)|leav(?:e|ing)|left|out of|departing)(?: (?:of|off|the|a|an|its|this|that))*\s*$", re.I
)
_ONTO = re.compile(r"\b(?:onto|into|enter(?:ed|ing)?|join(?:ed|ing)?|to)(?: (?:the|a|an|this|that|same))*\s*$", re.I)
_RELATIVE = re.compile(
    r"^[\w ,]{0,12}?(?:(?:from|on|along|off) which |that |which |where )?(?:(?:the )?driver of )?(V\d+) (?:was|had|"
    r"is|were|originally|"
    r"came|exited|traveled|approached)\b", re.I)  # fmt: skip
_VEHICLE = re.compile(r"\bV\d+\b")
_BOTH_VEHICLES = re.compile(r"\bboth (?:vehicles|drivers)\b", re.I)


def road_mentions(told: Iterable[Told], ids: tuple[str, ...]) -> tuple[RoadMention, ...]:
    """Mentions in order of the text. `ids`: all vehicles, for "both vehicles"."""
    return tuple(mention for sentence in told for mention in _sentence(sentence, ids))


def _sentence(told: Told, ids: tuple[str, ...]) -> Iterator[RoadMention]:
    text = told.text
    spans = list(noun_phrases(text))
    if not spans:
        facts = lane_facts(text)
        if not facts.empty:
            yield from _by_axis(_bare(told, facts))
        return
    for index, (start, head_start, end) in enumerate(spans):
        stop = spans[index + 1][0] if index + 1 < len(spans) else len(text)
        lead = text[spans[index - 1][2] if index else 0 : start]
        yield _mention(told, (lead, text[start:end], text[end:stop]), text[head_start:end], (index == 0, ids))


def _by_axis(mention: RoadMention) -> Iterator[RoadMention]:
    """A mention without a road word, once for each axis whose lanes it tells."""
    ways = {axis_of(c) for c in COMPASS if c in mention.lanes.toward}
    if len(ways) < 2:
        yield mention
        return
    for axis in sorted(ways):
        toward = {way: n for way, n in mention.lanes.toward.items() if axis_of(_compass(way)) == axis}
        turns = {way: t for way, t in mention.lanes.turns.items() if way in _NO_WAY or axis_of(_compass(way)) == axis}
        lanes = LaneFacts(toward=toward, turns=turns)
        yield RoadMention(mention.text, "road", axis, None, None, True, (), None, lanes, mention.sentence)


_NO_WAY = ("any", "each")
"""What `LaneFacts.turns` says in place of a direction."""


def _compass(word: str) -> Compass:
    return next(c for c in COMPASS if c == word)


def _bare(told: Told, facts: LaneFacts) -> RoadMention:
    axis = _axis_of_lanes(facts) or axis_in(told.text)
    who = tuple(dict.fromkeys(_VEHICLE.findall(told.text)))[:1]
    return RoadMention(told.text, "road", axis, None, None, True, who, "on" if who else None, facts, told.number)


def _axis_of_lanes(facts: LaneFacts) -> Compass | None:
    ways = {axis_of(_compass(way)) for way in (*facts.toward, *facts.turns) if way not in _NO_WAY}
    return next(iter(ways)) if len(ways) == 1 else None


def _mention(told: Told, parts: tuple[str, str, str], head: str, place: tuple[bool, tuple[str, ...]]) -> RoadMention:
    lead, phrase, behind = parts
    first, ids = place
    said = (_lead_tail(lead) if first else "") + phrase + behind
    facts = lane_facts(said)
    vehicles, how = _drivers(lead, behind, ids)
    toward = _toward(phrase)
    axis = axis_in(phrase) or (axis_of(toward) if toward else None) or _running(behind) or _lane_direction(lead)
    if how == "on" and not axis:
        axis = _travel_axis(lead)
    return RoadMention(
        said, _kind(phrase, head), axis or _axis_of_lanes(facts), toward, _relation(phrase, lead),
        bool(re.match(r"(?:the|this|that|its|his|her|their|these|both|each|all)\b", phrase, re.I)),
        vehicles, how, facts, told.number,
    )  # fmt: skip


def _lead_tail(lead: str) -> str:
    """What stands before the first noun phrase, behind the last vehicle named there."""
    last = list(_VEHICLE.finditer(lead))
    return lead[last[-1].end() :] if last else lead


def _toward(phrase: str) -> Compass | None:
    """The one direction in a noun phrase ("the westbound road"); None where a pair or nothing is named."""
    if _PAIR.search(phrase):
        return None
    words = re.findall(rf"\b({BOUND}|north|south|east|west)\b(?! side)", phrase, re.I)
    return compass_of(words[-1]) if words else None


def _running(behind: str) -> Compass | None:
    """ "... ran north and south": the axis told right behind the noun."""
    runs = _RUNS.match(behind)
    return axis_in(behind[runs.end() : runs.end() + 40]) if runs else None


_LANE_OF = re.compile(
    rf"\b({BOUND})(?: (?:[\w-]+ ){{0,4}}| )(?:lanes?|side|direction|portion) (?:of|on) (?:\w+ )?$", re.I)  # fmt: skip


def _lane_direction(lead: str) -> Compass | None:
    """ "in the eastbound lane of a": the road's axis."""
    found = _LANE_OF.search(lead)
    way = compass_of(found[1]) if found else None
    return axis_of(way) if way else None


def _travel_axis(lead: str) -> Compass | None:
    """The last direction of travel before the noun phrase."""
    words = re.findall(rf"\b({BOUND}|north|south|east|west|(?:north|south|east|west)\w*erly)\b", lead, re.I)
    way = compass_of(words[-1]) if words else None
    return axis_of(way) if way else None


_MEETS = re.compile(
    r"\b(?:intersect(?:s|ed)?|cross(?:es|ed)|meets?|joins?)(?: with)?(?: the| an?)?\s*$|"
    r"\b(?:intersection|connection|junction)\b[^.;]{0,30}\bwith\s*$", re.I)  # fmt: skip


def _relation(phrase: str, lead: str) -> Relation | None:
    """As the phrase says, else "other" behind "intersects", "intersection with"."""
    found = next((name for name, pattern in _RELATION if pattern.search(phrase)), None)
    return found or ("other" if _MEETS.search(lead) and not _VEHICLE.search(lead[-40:]) else None)


def _drivers(lead: str, behind: str, ids: tuple[str, ...]) -> tuple[tuple[str, ...], How | None]:
    """Who drives on the road mentioned, told by the verb before or the relative clause behind."""
    relative = _RELATIVE.match(behind)
    if relative and re.match(r"\s*(?:from|on|along|off|that|which|where|V)", behind):
        return (relative[1],), "on"
    vehicles = [m for m in _VEHICLE.finditer(lead) if m[0] in ids]
    everyone = list(_BOTH_VEHICLES.finditer(lead))
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
        if not re.fullmatch(r",? (?:and )?", lead[first.end() : second.start()]):
            break
        who.append(first[0])
    return tuple(who)


def _how(tail: str) -> How | None:
    if _FROM.search(tail):
        return "from"
    if _ONTO.search(tail):
        return "onto"
    on = _ON.search(tail)
    return "on" if on and not _LEFT_IT.search(tail) else None


def _kind(phrase: str, head: str) -> Kind:
    word = head.lower()
    if "ramp" in word:
        return "ramp"
    if re.search(r"driveway|alley", word) or re.search(r"\bprivate (?:drive|access)", phrase, re.I):
        return "driveway"
    if re.search(r"freeway|interstate|expressway|turnpike|limited[ -]access", phrase, re.I):
        return "freeway"
    return "crossroads" if "intersection" in word else "road"
