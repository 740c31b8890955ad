"""Lanes in a piece of road description: totals, lanes a direction, turn lanes, one-way, median, center lane.

Reads normalized text (`sgcad_core.reading.text.normalise`): "four-lane", "northbound", "V1". Knows the words for
lanes only; which road the piece describes is the caller's business.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from sgcad_core.reading.language import of_role, rule, values
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.compass import WORDS
from sgcad_core.reading.text.normalise import number
from sgcad_core.records.specs import Compass, Median

Side = Literal["left", "right"]


def compass(word: str) -> Compass:
    """The compass point of "north", "northbound", "northerly" or "Northern"."""
    return WORDS[rule("lanes.heading_end").sub("", word.lower())]


@dataclass(frozen=True)
class LaneFacts:
    """What one piece of text states of one road's lanes; None and empty mean not stated.

    `total`: both directions, as the writer counts (with or without turn lanes). `each_way`: lanes in each
    direction. `toward`: travel direction -> lanes, turn lanes counted. `turns`: travel direction (or "any", or
    "each") -> turn lanes.
    """

    total: int | None = None
    each_way: int | None = None
    toward: dict[str, int] = field(default_factory=dict)
    turns: dict[str, tuple[Side, ...]] = field(default_factory=dict)
    one_way: bool | None = None
    one_way_toward: Compass | None = None
    center_turn_lane: bool = False
    median: Median | None = None
    divided: bool | None = None
    one_lane: bool = False
    """ "one lane of travel", of whichever direction: the whole of a one-way street, else one of several."""
    highway: bool = False
    """ "a five-lane highway": a total of three and more is told of a highway."""
    own: int | None = None
    """Lanes in the direction of the vehicle that the text speaks of: "in lane two of three lanes"."""
    leg_totals: dict[Compass, int] = field(default_factory=dict)
    """The totals by the leg on which the vehicle comes whose road they are told of: opposite approaches may differ."""
    where: Mapping[str, Source] = field(default_factory=dict, compare=False, repr=False)
    """Where each of them was read, by the names of `sgcad_core.reading.roads.lane_sources.stated_values`."""

    @property
    def empty(self) -> bool:
        """Whether nothing at all was found."""
        return replace(self, one_lane=False, highway=False) == LaneFacts()

    def on_leg(self, bearing: Compass) -> LaneFacts:
        """The lanes with the total of one leg, where another one is told of it."""
        total = self.leg_totals.get(bearing, self.total) if self.total and not self.one_way else self.total
        return replace(self, total=total)


# ------------------------------------------------------------------ whole-road words
_TOTAL = rule("lanes.total")
_EACH = rule("lanes.each")
_OWN = rule("lanes.own")

# ------------------------------------------------------------------ lane items


MOST_ONE_WAY = 8
"""Lanes in one direction; a greater number is a route's or a mile post's."""
_NUMBERED_TURN = rule("lanes.numbered_turn")


@dataclass(frozen=True)
class _Item:
    count: int
    toward: Compass | None
    turn: tuple[Side, ...]
    plain: bool
    inside: bool
    definite: bool
    place: int


def lane_facts(text: str) -> LaneFacts:
    """Lanes that a piece of normalized text states, read as one road's. Never fails; unknown is empty."""
    marked = rule("lanes.center_turn").sub(" CENTERLANE ", _NUMBERED_TURN.sub(r"the \1 \2 lane", spelled_out(text)))
    each = _EACH.search(marked)
    own = _OWN.search(marked)
    marked = _OWN.sub(" ", marked)
    counted = _TOTAL.sub("N-lane", _EACH.sub("EACH", marked))
    items = _counts(list(_items(counted)), _TOTAL.search(marked))
    known = _directions(counted, items)
    toward, turns = _sums(items, known)
    _numbered_turns(text, toward, turns)
    each_turn = rule("lanes.each_turn").search(counted)
    turns |= {"each": ("left" if each_turn[1].lower() == "left" else "right",)} if each_turn else {}
    one_way, two_way = bool(rule("lanes.one_way").search(text)), bool(rule("lanes.two_way").search(text))
    alone = one_way and not two_way
    total = _total(_EACH.sub("EACH", marked), counted, items, known, alone)
    divided, median = divided_and_median(text)
    return LaneFacts(
        total=total, each_way=number(next(filter(None, each.groups()))) if each else None, toward=toward, turns=turns,
        one_way=one_way if one_way != two_way else None,
        one_way_toward=_one_way_toward(text) if alone else None,
        center_turn_lane="CENTERLANE" in marked, median=median, divided=divided,
        one_lane=bool(rule("lanes.one_lane").search(text)), highway=bool(rule("lanes.of_highway").search(text)),
        own=number(own[1] or own[2]) if own else None,
    )  # fmt: skip


def _numbered_turns(text: str, toward: dict[str, int], turns: dict[str, tuple[Side, ...]]) -> None:
    """ "the third northbound lane, which was a left-turn lane": there are three at least, and that is one of them."""
    for m in _NUMBERED_TURN.finditer(text):
        way = compass(m[2])
        toward[way] = max(toward.get(way, 0), values("later_ordinal")[m[1].lower()])
        turns.setdefault(way, ("left" if m[3].lower() == "left" else "right",))


def _total(text: str, counted: str, items: list[_Item], known: list[Compass | None], one_way: bool) -> int | None:
    """ "four-lane", else the one number of lanes that no direction claims ("consists of four lanes")."""
    said = [n for n in map(number, _TOTAL.findall(text)) if n <= 2 * MOST_ONE_WAY]
    if said:
        return said[0]
    crossed = rule("lanes.crossed")
    loose = [
        item.count for item, way in zip(items, known, strict=True)
        if way is None and item.plain and (item.count > 1 or one_way) and not crossed.search(counted[: item.place])
    ]  # fmt: skip
    return loose[0] if len(loose) == 1 else None


def _one_way_toward(text: str) -> Compass | None:
    near = rule("lanes.flow").search(text)
    return compass(near[1] or near[2]) if near else None


def _items(text: str) -> Iterator[_Item]:
    """Lane counts in order: "two eastbound lanes", "a left turn lane", "one lane for northbound traffic"."""
    for match in rule("lanes.item").finditer(text):
        mods, count = (match["mods"] or "").lower(), match["count"] or match["turncount"] or match["barecount"]
        word = rule("common.bound").search(mods)
        behind = match["behind1"] or match["behind2"] or match["bare"] or (word[0] if word else None)
        turn = _turn(mods, match["turn"])
        sure = count.lower() not in ("a", "an", "the")
        if number(count) > MOST_ONE_WAY:
            continue
        if not sure and not turn:
            continue
        plain = not turn and not rule("lanes.no_plain_lane").search(mods)
        if count.lower() == "the" and not match["turn"] and not behind:
            continue
        within = bool(rule("lanes.within").search(text[: match.start()]))
        toward = compass(behind) if behind else None
        yield _Item(number(count), toward, turn, plain, within, count.lower() == "the", match.start())


def _counts(items: list[_Item], total: re.Match[str] | None) -> list[_Item]:
    """Without "the left-turn lane" where lanes are counted besides, or where no lane of the total is spare for it."""
    sure = [i for i in items if not i.definite]
    spare = total is None or number(total[1]) % 2 == 1
    return sure or [i for i in items if i.toward and spare]


def _turn(mods: str, bare: str | None) -> tuple[Side, ...]:
    if bare:
        return ("left",) if bare.lower() == "left" else ("right",)
    if not rule("lanes.turn").search(mods):
        return ()
    sides: tuple[Side, ...] = ("left", "right")
    return tuple(side for side in sides if side in mods)


def _directions(text: str, items: list[_Item]) -> list[Compass | None]:
    """Each item's direction: its own, else its clause's subject's, else a neighbor's."""
    known = [i.toward or _subject(text, i.place) for i in items]
    total = _headline(known, items)
    for index, own in enumerate(known):
        if own is None and index and index != total and _same_clause(text, items[index - 1], items[index]):
            known[index] = known[index - 1]
    for index in range(len(items) - 2, -1, -1):
        if known[index] is None and index != total and _same_clause(text, items[index], items[index + 1]):
            known[index] = known[index + 1]
    return known


def _headline(known: list[Compass | None], items: list[_Item]) -> int | None:
    """The index of "five lanes" where lanes of two directions follow: a total, no direction's share."""
    first = next((k for k, item in enumerate(items) if known[k] is None and item.plain), None)
    if first is None or len({way for way in known[first + 1 :] if way}) < 2:
        return None
    return first if items[first].count >= sum(i.count for i in items[first + 1 :] if not i.inside) - 1 else None


def _subject(text: str, place: int) -> Compass | None:
    """ "The southbound side had ..." in the clause before the item."""
    clause = rule("lanes.clause_end").split(text[:place])[-1]
    found = list(rule("lanes.subject").finditer(clause))
    return compass(found[-1]["dir"]) if found else None


def _same_clause(text: str, first: _Item, second: _Item) -> bool:
    between = text[first.place : second.place]
    return ". " not in between and not rule("common.vehicle_begins").search(between)


def _sums(items: list[_Item], known: list[Compass | None]) -> tuple[dict[str, int], dict[str, tuple[Side, ...]]]:
    turns: dict[str, tuple[Side, ...]] = {}
    for item, way in zip(items, known, strict=True):
        if item.turn:
            turns[way or "any"] = turns.get(way or "any", ()) + item.turn * (1 if len(item.turn) > 1 else item.count)
    ways = dict.fromkeys(way for way in known if way)
    return {way: _count([i for i, w in zip(items, known, strict=True) if w == way]) for way in ways}, turns


def _count(items: list[_Item]) -> int:
    """Lanes of one direction. "three lanes, two through lanes and a turn lane" are three, not six."""
    plain = sum(i.count for i in items if i.plain)
    through = sum(i.count for i in items if not i.plain and not i.turn)
    turning = sum(max(i.count, len(i.turn)) for i in items if i.turn)
    beside = sum(max(i.count, len(i.turn)) for i in items if i.turn and not i.inside)
    return max(plain, through + turning) if plain and through else max(plain + through + beside, turning)


def divided_and_median(text: str) -> tuple[bool | None, Median | None]:
    """Whether the road is said to be divided, and by what; painted lines alone do not divide."""
    if rule("median.undivided").search(text):
        return False, None
    text = rule("median.elsewhere").sub(" ", text)
    kind = next((told.yields["median"] for told in of_role("median_kind") if told.search(text)), None)
    said = bool(rule("median.divided").search(rule("median.painted_line").sub(" ", text)))
    if kind == "painted":
        return said or None, kind
    if said or (kind and rule("median.median_word").search(text)):
        return True, kind
    return None, None


_IN_EACH = rule("turn_lanes.in_each")
"""Not "in the lane for left-turning traffic": a vehicle may wait there."""


def spelled_out(text: str) -> str:
    """Normalized text with its turn lanes in plain words: "a lane for left turns" is a left-turn lane, and of "two
    lanes and a left turn lane in each direction" both are told for each direction."""
    for lane in of_role("lane_for_turns"):
        text = lane.sub(r"\2-turn lane\1", text)
    text = rule("turn_lanes.only").sub(r"\1-turn \2", text)
    return _IN_EACH.sub(r"\1 lanes in each direction with a \2-turn lane in each direction", text)
