"""Lanes of every approach to a junction where a report lists them: how many come in, what each is for, how many go out.

"From the west there are two lanes, the right one for right turns", "the north leg has a left-turn lane and a
through/right lane coming in and one lane going out", "one lane leaves on every leg". Reads resolved sentences. Lanes of
a road by directions of travel are read in `sgcad_core.narrative.lanes`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from sgcad_core.language import rule
from sgcad_core.narrative.approach_items import Item, Token, count_of, lane_uses, tokens
from sgcad_core.narrative.clauses import Statement
from sgcad_core.narrative.compass import COMPASS, WORDS, compass_of, turned
from sgcad_core.narrative.mentions import axis_of
from sgcad_core.specs import Compass, Turn

MOST = 7
"""Lanes of one approach; more is a misreading."""
_ALL, _STEM = "all", "stem"
_NO_CLAUSE = ("codes", "factors")


@dataclass(frozen=True)
class Approach:
    """Lanes of one leg as told; None: not told."""

    lanes_in: int | None = None
    lanes_out: int | None = None
    turns_in: tuple[Turn, ...] = ()

    def over(self, other: Approach) -> Approach:
        """This, and what only the other tells."""
        own = self.lanes_in is not None
        return Approach(
            self.lanes_in if own else other.lanes_in,
            self.lanes_out if self.lanes_out is not None else other.lanes_out,
            self.turns_in if own else other.turns_in,
        )


@dataclass(frozen=True)
class Approaches:
    """What is told of single legs, of both legs of an axis, of the leg that ends at a T, and of all legs."""

    legs: Mapping[Compass, Approach] = field(default_factory=dict)
    axes: Mapping[Compass, Approach] = field(default_factory=dict)
    stem: Approach = Approach()
    all: Approach = Approach()

    def of(self, bearing: Compass, stem: Compass | None) -> Approach:
        """What is told of the leg at a bearing."""
        told = self.legs.get(bearing, Approach())
        if bearing == stem:
            told = told.over(self.stem)
        return told.over(self.axes.get(axis_of(bearing), Approach())).over(self.all)

    @property
    def named(self) -> tuple[Compass, ...]:
        """Bearings of the legs of which lanes that come in or go out are told, each by its name."""
        return tuple(b for b in COMPASS if b in self.legs)

    @property
    def crossing(self) -> bool:
        """Whether both legs of two roads are told."""
        whole = {axis_of(b) for b in self.legs if turned(b, 180) in self.legs} | {*self.axes}
        return len(whole) > 1

    @property
    def alone(self) -> Compass | None:
        """The leg of a T that has none across, where both legs of the other road are told too."""
        sides = [b for b in self.legs if turned(b, 180) not in self.legs and axis_of(b) not in self.axes]
        return sides[0] if len(sides) == 1 and len(self.legs) == 3 else None


@dataclass
class _Mark:
    """Whose lanes: keys are bearings, "axis N", "all" or "stem"; `toward`: told by directions of travel."""

    keys: tuple[str, ...] = ()
    toward: bool = False

    @property
    def axis(self) -> Compass | None:
        axes = {axis_of(_bearing(key)) for key in self.keys if key not in (_ALL, _STEM)}
        return next(iter(axes)) if len(axes) == 1 else None


def _bearing(key: str) -> Compass:
    return next(c for c in COMPASS if c == key.removeprefix("axis "))


def approaches_of(told: Iterable[Statement]) -> Approaches:
    """What the text lists of its approaches; nothing where it lists none."""
    reader = _Reader()
    for t in told:
        if t.role not in _NO_CLAUSE:
            reader.sentence(t.text)
    return reader.result()


class _Reader:
    def __init__(self) -> None:
        self.found: dict[str, Approach] = {}
        self.listed: set[str] = set()
        """Keys of which a list is told, not just a number of lanes; without one nothing counts."""
        self.named: set[str] = set()
        """Keys of legs that are named as such, not by a direction of travel."""
        self.mark = _Mark()
        self.scope: Compass | None = None
        self.last: Approach = Approach()
        self.heading: Literal["", "in", "out"] = ""
        """What a list stands under: "Lanes out:"."""

    def result(self) -> Approaches:
        """All that was found."""
        if not self.listed:
            return Approaches()
        axes_listed = {axis_of(_bearing(k)) for k in self.listed if k not in (_ALL, _STEM)}
        sure = {
            k: a for k, a in self.found.items()
            if k in self.listed or k in self.named or k in (_ALL, _STEM) or axis_of(_bearing(k)) in axes_listed
        }
        legs = {_bearing(k): a for k, a in sure.items() if k in COMPASS}
        axes = {_bearing(k): a for k, a in sure.items() if k.startswith("axis ")}
        stem, every = sure.get(_STEM, Approach()), sure.get(_ALL, Approach())
        return Approaches(legs, axes, stem, every)

    # -------------------------------------------------------------- one sentence
    def sentence(self, text: str) -> None:
        """Take what a sentence tells."""
        parts = tokens(text)
        if not any(p.kind in ("lanes", "number", "same") for p in parts):
            self._scopes(parts)
            return
        clauses = list(self._clauses(parts, text))
        for mark, items, same in clauses:
            self._take(mark, items, same, text)

    def _scopes(self, parts: Sequence[Token]) -> None:
        for part in parts:
            if part.kind == "axis":
                self.scope = self._axis(part)

    def _axis(self, part: Token) -> Compass | None:
        one, two = compass_of(part.match["one"]), compass_of(part.match["two"])
        return axis_of(one) if one and two and axis_of(one) == axis_of(two) and one != two else None

    def _clauses(self, parts: Sequence[Token], text: str) -> Iterator[tuple[_Mark, list[Item], bool]]:
        """Stretches of lanes of the same legs."""
        mark, items, same, driven = _Mark(self.mark.keys, self.mark.toward), list[Item](), False, False
        previous: Token | None = None
        self.heading = ""
        for part in parts:
            gap = text[previous.end : part.start] if previous else text[: part.start]
            if part.kind == "vehicle":
                driven = True
            elif part.kind == "sep":
                if part.match[0] in ";.":
                    driven = False
                continue
            elif part.kind in ("legs", "ways", "axis", "every", "each", "stem", "place"):
                found = self._mark_of(part)
                if found is None:
                    continue
                if part.kind == "place" or _trails(part, parts, items, text):
                    if items and items[-1].way in ("out", "both") and _near(items[-1], part, text):
                        yield mark, items[:-1], same
                        yield found, items[-1:], False
                        items, same = [], False
                        self.mark = mark
                        previous = part
                        continue
                if items or same:
                    yield mark, items, same
                    items, same = [], False
                mark = self.mark = found
            elif not driven:
                same = self._lane_part(part, items, gap, text) or same
            previous = part
        if items or same:
            yield mark, items, same

    def _mark_of(self, part: Token) -> _Mark | None:
        """Whose lanes a mark tells."""
        words = part.match.groupdict()
        if part.kind in ("legs", "place"):
            keys = tuple(_points(words["list"]))
            mark = _Mark(keys)
        elif part.kind == "ways":
            keys = tuple(turned(w, 180) for w in _points(words["list"] or words["list2"]))
            mark = _Mark(keys, toward=True)
        elif part.kind == "axis":
            axis = self._axis(part)
            if axis is None:
                return None
            mark = _Mark((f"axis {axis}",))
        elif part.kind == "stem":
            mark = _Mark((_STEM,))
        elif part.kind == "each" and (axis := self.mark.axis or self.scope):
            mark = _Mark((f"axis {axis}",))
        else:
            mark = _Mark((_ALL,))
        self.scope = mark.axis or self.scope
        return mark

    def _lane_part(self, part: Token, items: list[Item], gap: str, text: str) -> bool:
        """Add a part to the items; whether it says that all is as before."""
        last = items[-1] if items else None
        if part.kind in ("lanes", "number", "which"):
            _close(last, part, text)
            items.extend(replace(item, way=item.way or self.heading) for item in _items(part, text))
        elif part.kind == "use":
            self._use(part, items, gap)
        elif part.kind in ("out", "in"):
            if not items and text[part.end :].startswith(":"):
                self.heading = "out" if part.kind == "out" else "in"
            _direct(part, items, text)
        elif part.kind == "each_way" and last is not None:
            last.way, last.end = "both", part.end
        elif part.kind == "same":
            return True
        return False

    def _use(self, part: Token, items: list[Item], gap: str) -> None:
        if not items:
            return
        last = items[-1]
        shares = bool(rule("approaches.sharing").search(gap)) and bool(last.uses)
        if not last.uses and not last.bare and (last.count == 1 or last.which or not rule("approaches.lists").search(gap)):
            last.uses.append(part.use)
            last.end = part.end
        elif shares and not gap.strip() == "and":
            last.uses.append(part.use)
            last.end = part.end
        elif shares and not last.bare:
            last.uses.append(part.use)
            last.end = part.end
        else:
            soft = gap.strip() == "and"
            last.after = last.after or gap
            items.append(Item(1, [part.use], bare=True, soft=soft, start=part.start, end=part.end))

    # -------------------------------------------------------------- what it means
    def _take(self, mark: _Mark, items: list[Item], same: bool, text: str) -> None:
        told: dict[str, Approach] = {}
        groups: dict[str, list[Item]] = {}
        for item in items:
            for key, way in _whose(mark, item):
                if way in ("out", "both"):
                    told[key] = Approach(lanes_out=item.count).over(told.get(key, Approach()))
                if way in ("in", "both"):
                    groups.setdefault(key, []).append(item)
        for key, some in groups.items():
            count, uses = lane_uses(some, text)
            told[key] = Approach(min(count, MOST), None, uses if count <= MOST else ()).over(told.get(key, Approach()))
        if same and not groups:
            for key in mark.keys:
                told[key] = replace(self.last, lanes_out=None).over(told.get(key, Approach()))
        for key, approach in told.items():
            self._weigh(mark, key, [item for item in items if key in dict(_whose(mark, item))], approach)
            self.found[key] = self.found.get(key, Approach()).over(approach)
            if approach.lanes_in is not None:
                self.last = approach


    def _weigh(self, mark: _Mark, key: str, items: list[Item], approach: Approach) -> None:
        """Note whether what is told of a leg is a list, and whether the leg is named."""
        turning = any({"L", "R"} & {*item.uses} for item in items)
        whole = approach.lanes_in is not None and approach.lanes_out is not None
        parted = whole and not all(item.way == "both" for item in items)
        if (turning and len(items) > 1) or (parted and key != _ALL) or (not items and self.listed):
            self.listed.add(key)
        if not mark.toward and key in COMPASS and any(item.way or turning for item in items):
            self.named.add(key)


def _points(words: str) -> list[Compass]:
    return [way for m in rule("control.way").finditer(words) if (way := compass_of(m["way"]))]


def _whose(mark: _Mark, item: Item) -> Iterator[tuple[str, Literal["in", "out", "both"]]]:
    """Keys of the legs that an item is of, and which way its lanes lead."""
    way = compass_of(item.toward) if item.toward else None
    if way is None:
        yield from ((key, item.way or "in") for key in mark.keys)
        return
    near = [key for key in mark.keys if key in COMPASS and axis_of(_bearing(key)) == axis_of(way)]
    if near and not mark.toward:
        yield from ((key, "out" if key == way else "in") for key in near)
    else:
        yield turned(way, 180), item.way or "in"


def _items(part: Token, text: str) -> list[Item]:
    """The lanes of a count: "two through lanes"; "right-turn and left-turn lanes" are one each."""
    words = part.match.groupdict()
    mods = (words.get("mods") or "").lower()
    toward = next((m["way"] for m in rule("control.way").finditer(mods)), "") if mods else ""
    uses = [t.use for t in tokens(mods) if t.kind == "use"] if mods else []
    count = words.get("count")
    way: Literal["", "in", "out"] = "out" if any(t.kind == "out" for t in tokens(mods)) else ""
    one = dict(way=way, toward=toward, start=part.start, end=part.end)
    if part.kind == "lanes" and words.get("noun") == "lanes" and count is None and len(uses) > 1:
        return [Item(1, [use], **one) for use in uses]
    if part.kind == "which":
        number = 2 if words["which"].endswith(("two", "others")) else 1
        return [Item(number, which=True, **one)]
    if part.kind == "lanes" and (count or "").lower() in ("", "the", "both"):
        return []
    return [Item(count_of(count), uses, **one)]


def _close(last: Item | None, part: Token, text: str) -> None:
    if last is not None and not last.after:
        last.after = text[last.end : part.start]


def _direct(part: Token, items: list[Item], text: str) -> None:
    """A sign of the direction: of the lanes right before it."""
    way: Literal["in", "out"] = "out" if part.kind == "out" else "in"
    for item in reversed(items):
        between = text[item.end : part.start]
        if not item.way and not re.search(r"[;.]", between):
            item.way = way
        break
    if way == "in":
        return


def _near(item: Item, part: Token, text: str) -> bool:
    return len(text[item.end : part.start]) < 30


def _trails(part: Token, parts: Sequence[Token], items: list[Item], text: str) -> bool:
    """Whether a mark stands behind its lanes: no lanes come between it and the next mark or the end of the clause."""
    if not items or part.kind not in ("every", "each"):
        return False
    for after in parts:
        if after.start < part.end:
            continue
        if after.kind == "sep" and after.match[0] in ";.,":
            return True
        if after.kind in ("lanes", "number", "legs", "ways"):
            return False
    return True


__all__ = ["Approach", "Approaches", "approaches_of", "WORDS"]
