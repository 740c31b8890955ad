"""Lanes of every approach to a junction where a report lists them: how many come in, what each is for, how many go out.

"From the west there are two lanes, the right one for right turns", "the north leg has a left-turn lane and a
through/right lane coming in and one lane going out", "one lane leaves on every leg". Reads resolved sentences. Lanes of
a road by directions of travel are read in `sgcad_core.narrative.lanes`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from sgcad_core.language import rule
from sgcad_core.narrative.approach_items import Item, Token, items_of, lane_uses, tokens
from sgcad_core.narrative.clauses import Statement
from sgcad_core.narrative.compass import COMPASS, compass_of, turned
from sgcad_core.narrative.mentions import axis_of
from sgcad_core.specs import Compass, Turn

MOST = 7
"""Lanes of one approach; more is a misreading."""
_ALL, _STEM, _MAIN = "all", "stem", "main"
_APART = (_ALL, _STEM, _MAIN)
"""Keys that name no bearing."""
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
        alike = self.lanes_in == other.lanes_in
        return Approach(
            self.lanes_in if own else other.lanes_in,
            self.lanes_out if self.lanes_out is not None else other.lanes_out,
            self.turns_in or (other.turns_in if alike or not own else ()),
        )


@dataclass(frozen=True)
class Approaches:
    """What is told of single legs, of both legs of an axis, of the leg that ends at a T, of the road that goes on there, and of
    all legs."""

    legs: Mapping[Compass, Approach] = field(default_factory=dict)
    axes: Mapping[Compass, Approach] = field(default_factory=dict)
    stem: Approach = Approach()
    main: Approach = Approach()
    all: Approach = Approach()

    def of(self, bearing: Compass, stem: Compass | None) -> Approach:
        """What is told of the leg at a bearing."""
        told = self.legs.get(bearing, Approach())
        if bearing == stem:
            told = told.over(self.stem)
        told = told.over(self.axes.get(axis_of(bearing), Approach()))
        if stem and axis_of(bearing) != axis_of(stem):
            told = told.over(self.main)
        return told.over(self.all)

    @property
    def named(self) -> tuple[Compass, ...]:
        """Bearings of the legs of which lanes that come in or go out are told, each by its name."""
        return tuple(b for b in COMPASS if b in self.legs)

    @property
    def crossing(self) -> tuple[Compass, ...]:
        """The axes of two roads of which both legs are told; none where it are fewer."""
        whole = {axis_of(b) for b in self.legs if turned(b, 180) in self.legs} | {*self.axes}
        return tuple(sorted(whole)) if len(whole) == 2 else ()

    @property
    def alone(self) -> Compass | None:
        """The leg of a T that has none across, where both legs of the other road are told too."""
        ending = [b for b, a in self.legs.items() if {*a.turns_in} == {"left", "right"}]
        if len(ending) == 1:
            return ending[0]
        sides = [b for b in self.legs if turned(b, 180) not in self.legs and axis_of(b) not in self.axes]
        return sides[0] if len(sides) == 1 and len(self.legs) == 3 else None


@dataclass
class _Mark:
    """Whose lanes: keys are bearings, "axis N", "all" or "stem"; `toward`: told by directions of travel."""

    keys: tuple[str, ...] = ()
    toward: bool = False

    @property
    def axis(self) -> Compass | None:
        axes = {axis_of(_bearing(key)) for key in self.keys if key not in _APART}
        return next(iter(axes)) if len(axes) == 1 else None


def _bearing(key: str) -> Compass:
    return next(c for c in COMPASS if c == key.removeprefix("axis "))


def road_names(texts: Sequence[str]) -> dict[str, Compass]:
    """Names of roads with the axis on which they lie; of two roads the other lies square to the one that is told."""
    found: dict[str, Compass] = {}
    for text in texts:
        for m in rule("approaches.name").finditer(text):
            words = {key.rstrip("2345"): value for key, value in m.groupdict().items() if value}
            way = _points(words["way"]) if "way" in words else [_bearing(words["letters"].split("-")[0])]
            for name in _forms(words["name"]):
                if way:
                    found.setdefault(name, axis_of(way[0]))
    axes = {*found.values()}
    if len(axes) == 1:
        across = axis_of(turned(next(iter(axes)), 90))
        others = {m[0] for text in texts for m in rule("approaches.all_names").finditer(text)}
        if len({name.split()[0] for name in others} - {*found}) == 1:
            found |= {form: across for name in others for form in _forms(name) if form not in found}
    return found


def _forms(name: str) -> set[str]:
    """A name in full and its first word, where that is one of its own."""
    return {form for form in (name, name.split()[0]) if rule("approaches.own_name").search(form)}


def approaches_of(told: Iterable[Statement]) -> Approaches:
    """What the text lists of its approaches; nothing where it lists none."""
    told = [*told]
    reader = _Reader(road_names([t.text for t in told]))
    for t in told:
        if t.role not in _NO_CLAUSE:
            reader.sentence(t.text)
    return reader.result()


class _Reader:
    def __init__(self, names: Mapping[str, Compass]) -> None:
        self.names = names
        self.found: dict[str, Approach] = {}
        self.listed: set[str] = set()
        """Keys of which a list is told, not just a number of lanes; without one nothing counts."""
        self.named: set[str] = set()
        """Keys of legs that are named as such, not by a direction of travel."""
        self.mark = _Mark()
        self.scope: Compass | None = None
        self.last: Approach = Approach()

    def result(self) -> Approaches:
        """All that was found."""
        told_axes = [k for k, a in self.found.items() if k.startswith("axis ") and a.lanes_in and a.lanes_out]
        if not self.listed and len(told_axes) < 2:
            return Approaches()
        axes_listed = {axis_of(_bearing(k)) for k in self.listed if k not in _APART}
        both = {axis_of(_bearing(k)) for k in self.listed if k.startswith("axis ")}
        sure = {
            k: a for k, a in self.found.items()
            if k in self.listed or k in self.named or k in _APART or (k.startswith("axis ") and a.lanes_out)
            or (axis_of(_bearing(k)) in axes_listed and not (k in COMPASS and axis_of(_bearing(k)) in both))
        }
        legs = {_bearing(k): a for k, a in sure.items() if k in COMPASS}
        axes = {_bearing(k): a for k, a in sure.items() if k.startswith("axis ")}
        stem, every = sure.get(_STEM, Approach()), sure.get(_ALL, Approach())
        return Approaches(legs, axes, stem, sure.get(_MAIN, Approach()), every)

    # -------------------------------------------------------------- one sentence
    def sentence(self, text: str) -> None:
        """Take what a sentence tells."""
        parts = tokens(text, tuple(self.names))
        kinds = {p.kind for p in parts}
        others = "lanes" not in kinds and rule("approaches.signs").search(text)
        if kinds & {"lanes", "which", "use", "same"} and not others:
            for clause in _Clauses(self, text).read(parts):
                self._take(clause)
        else:
            self._scopes(parts)

    def _scopes(self, parts: Sequence[Token]) -> None:
        for part in parts:
            if part.kind in ("axis", "legs", "named", "other", "main", "stem"):
                self.mark = self.mark_of(part) or self.mark

    def mark_of(self, part: Token) -> _Mark | None:
        """Whose lanes a mark tells."""
        words = part.match.groupdict()
        if part.kind in ("legs", "place"):
            keys = tuple(_points(words["list"]))
            mark = _Mark(keys)
        elif part.kind == "ways":
            keys = tuple(turned(w, 180) for w in _points(words["list"] or words["list2"]))
            mark = _Mark(keys, toward=True)
        elif part.kind == "axis":
            axis = _axis(part)
            if axis is None:
                return None
            mark = _Mark((f"axis {axis}",))
        elif part.kind == "named":
            mark = _Mark((f"axis {self.names[part.match[0]]}",))
        elif part.kind == "leading":
            mark = _Mark(tuple(turned(w, 180) for w in _points(words["way"])), toward=True)
        elif part.kind == "unknown":
            mark = _Mark()
        elif part.kind == "stem":
            mark = _Mark((_STEM,))
        elif part.kind == "main":
            mark = _Mark((_MAIN,))
        elif part.kind == "other":
            if self.scope is None:
                return None
            mark = _Mark((f"axis {axis_of(turned(self.scope, 90))}",))
        elif part.kind == "each" and (name := self._known(words.get("of")) or self._known(words.get("name"))):
            mark = _Mark((f"axis {self.names[name]}",))
        elif part.kind == "each" and self.mark.keys == (_MAIN,):
            mark = _Mark((_MAIN,))
        elif part.kind == "each" and (axis := self.mark.axis or self.scope):
            mark = _Mark((f"axis {axis}",))
        else:
            mark = _Mark((_ALL,))
        self.scope = mark.axis or self.scope
        return mark

    def _known(self, words: str | None) -> str | None:
        return next((name for name in _forms(words) if name in self.names), None) if words else None

    def copy(self, to: _Mark, source: _Mark) -> None:
        """What comes in on the legs of one mark comes in on those of another."""
        known = next((self.found[key] for key in source.keys if key in self.found), None)
        if known is not None:
            for key in to.keys:
                self.found[key] = self.found.get(key, Approach()).over(replace(known, lanes_out=None))
                self.listed.add(key)

    # -------------------------------------------------------------- what it means
    def _take(self, clause: _Clause) -> None:
        mark, items, same = clause
        told: dict[str, Approach] = {}
        groups: dict[str, list[Item]] = {}
        for item in items:
            for key, way in _whose(mark, item):
                if way in ("out", "both"):
                    told[key] = Approach(lanes_out=item.count).over(told.get(key, Approach()))
                if way in ("in", "both"):
                    groups.setdefault(key, []).append(item)
        for key, some in groups.items():
            count, uses = lane_uses(some)
            told[key] = Approach(min(count, MOST), None, uses if count <= MOST else ()).over(told.get(key, Approach()))
        plain = all(item.plain and item.count == self.last.lanes_in for some in groups.values() for item in some)
        if same and plain and not any(item.way == "out" for item in items):
            told.clear()
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


class _Clause(NamedTuple):
    """Lanes of the same legs; `same`: they are as those told before."""

    mark: _Mark
    items: list[Item]
    same: bool


@dataclass
class _Clauses:
    """Cuts a sentence into stretches of lanes of the same legs."""

    reader: _Reader
    text: str
    items: list[Item] = field(default_factory=list)
    same: bool = False
    driven: bool = False
    """Whether a vehicle was named: the lanes behind it are where it drives."""
    heading: Literal["", "in", "out"] = ""
    """What a list stands under: "Lanes out:"."""
    next: Literal["", "in", "out"] = ""
    """Which way the next lanes lead: "leaves with one"."""
    before: Literal["", "out"] = ""
    """Whether the lanes told last lead out."""
    last: Token | None = None
    marked: Token | None = None
    """The last mark, while no lanes follow it."""

    def read(self, parts: Sequence[Token]) -> Iterator[_Clause]:
        """The stretches in order."""
        for part in parts:
            if part.kind == "sep":
                self.driven = self.driven and part.match[0] not in ";."
                continue
            if part.kind in ("named", "other", "main") and rule("approaches.located").search(self.text[: part.start]):
                continue
            if part.kind in _MARKS or (part.kind == "each_way" and self.items and self.items[-1].way == "out"):
                yield from self._marked(part)
            elif part.kind == "vehicle":
                self.driven = True
            elif part.kind == "leading" and not self.items and not self.last:
                yield from self._marked(part)
            elif part.kind == "leading":
                if self.items and not self.driven:
                    self.items[-1].way, self.items[-1].toward = "out", part.match["way"]
                    self.items[-1].end = part.end
            elif not self.driven:
                self._lanes(part)
            self.last = part
        yield from self._flush()

    def _flush(self) -> Iterator[_Clause]:
        if self.items or self.same:
            yield _Clause(self.reader.mark, self.items, self.same and self.marked is not None)
        self.before = "out" if self.items and self.items[-1].way == "out" else ""
        self.items, self.same = [], False

    # -------------------------------------------------------------- whose lanes
    def _marked(self, part: Token) -> Iterator[_Clause]:
        before = self.reader.mark
        found = self.reader.mark_of(part)
        self.driven = self.driven and not rule("approaches.drivers").search(self.text[: part.start])
        if found is None:
            return
        gap = self._gap(part)
        if self.same and not self.items and self.marked and part.kind == "legs":
            self.reader.mark, self.same = before, False
            self.reader.copy(before, found)
            return
        if part.kind == "every" and self.marked and not self.items and self.marked.kind in ("axis", "named", "other", "main"):
            self.reader.mark = before
            return
        if self.marked and not self.items and _alike(self.marked, part) and rule("approaches.joint").fullmatch(gap):
            found = _Mark(tuple(dict.fromkeys((*before.keys, *found.keys))), found.toward)
        elif self.marked and not self.items and part.kind in ("named", "main", "other") and gap.strip() in ("on", "on the", "of"):
            return
        elif self.items and self._of_last(part, found, before, gap):
            self.reader.mark = before
            return
        elif self.items and self._behind(part, before):
            yield from self._trailing(part, found, before)
            return
        elif self.items:
            self.reader.mark = before
            yield from self._flush()
        self.reader.mark, self.marked = found, part

    def _gap(self, part: Token) -> str:
        return self.text[self.last.end : part.start] if self.last else self.text[: part.start]

    def _of_last(self, part: Token, found: _Mark, before: _Mark, gap: str) -> bool:
        """ "two lanes westbound" on a leg that is named: which way these lanes lead."""
        last = self.items[-1]
        if part.kind != "ways" or not rule("approaches.beside").fullmatch(gap) or last.toward:
            return False
        if before.toward and not (last.plain and before.axis == found.axis and before.keys != found.keys):
            return False
        if before.axis is None or before.axis != found.axis or len(before.keys) > 1 or before.keys[0] not in COMPASS:
            return False
        last.toward, last.end = part.match["list"] or part.match["list2"], part.end
        return True

    def _behind(self, part: Token, before: _Mark) -> bool:
        """Whether a mark stands behind the lanes of which it tells."""
        between = self.text[self.items[-1].end : part.start]
        if rule("approaches.cut").search(between):
            return False
        single = all(key in COMPASS for key in before.keys) and before.keys != ()
        if part.kind in ("every", "each", "each_way"):
            return True
        if part.kind == "ways":
            return bool(rule("approaches.beside").fullmatch(between))
        return (not single and part.kind in ("place", "legs")) or (part.kind == "place" and self.items[-1].way == "out")

    def _trailing(self, part: Token, found: _Mark, before: _Mark) -> Iterator[_Clause]:
        """The lanes before the mark are those of its legs; of others before them, if the last go out."""
        last = self.items[-1]
        only_last = len(self.items) > 1 and (last.way == "out" or (part.kind == "ways" and last.plain))
        if only_last:
            self.items, rest = [last], self.items[:-1]
            yield _Clause(before, rest, self.same)
        self.same = False
        self.reader.mark, self.marked = found, None
        if part.kind in ("place", "legs") or last.way == "out" or (part.kind == "ways" and not last.plain):
            yield from self._flush()
            self.reader.mark = before if part.kind in ("place", "legs") else found

    # -------------------------------------------------------------- lanes
    def _lanes(self, part: Token) -> None:
        """Add a part to the lanes of this stretch."""
        last = self.items[-1] if self.items else None
        if part.kind in ("lanes", "number", "which"):
            if last is not None and not last.after:
                last.after = self.text[last.end : part.start]
            opening = self.marked is not None and self._gap(part).strip() == ":"
            new = items_of(part, self.text, bool(self.items) or opening)
            way = self.next or self.heading or (self.before if self._again(part) else "")
            self.items.extend(replace(item, way=item.way or way) for item in new)
            self.next = ""
        elif part.kind == "use":
            self._use(part)
        elif part.kind in ("out", "in"):
            self._directed(part)
        elif part.kind == "each_way" and last is not None:
            last.way, last.end = "both", part.end
            if len(self.items) > 1 and last.count * 2 == self.items[-2].count and self.items[-2].plain:
                del self.items[-2]  # "two lanes, one each way"
        elif part.kind == "same":
            self.same = True

    def _again(self, part: Token) -> bool:
        """Whether a bare number counts what was counted before: "two go out to the east and two to the west"."""
        return part.kind == "number" and not self.items and bool(rule("approaches.ended").match(self.text[part.end :]))

    def _directed(self, part: Token) -> None:
        """A sign of the direction: of the lanes right before it, or of all that come in the list under it."""
        way: Literal["in", "out"] = "out" if part.kind == "out" else "in"
        if not self.items:
            self.heading = way if self.text[part.end :].startswith((":", ",")) else self.heading
        elif way == "out" and rule("approaches.ahead").match(self.text[part.end :]):
            self.next = way
        elif not self.items[-1].way and not rule("approaches.cut").search(self.text[self.items[-1].end : part.start]):
            self.items[-1].way = way

    def _use(self, part: Token) -> None:
        gap = self._gap(part)
        if not self.items:
            listing = "lane" in self.text.lower() or bool(self.reader.found)
            if self.marked and listing and rule("approaches.bare").fullmatch(gap):
                self.items.append(Item(1, [*part.use], bare=True, start=part.start, end=part.end))
            return
        last = self.items[-1]
        shares = bool(last.uses) and bool(rule("approaches.sharing").fullmatch(gap))
        soft = bool(rule("approaches.soft").search(gap))
        first = not last.uses and not last.bare and (last.count == 1 or last.which or not rule("approaches.lists").search(gap))
        if first or (shares and not (soft and last.bare)):
            last.uses.extend(part.use)
            last.end = part.end
            return
        last.after = last.after or gap
        self.items.append(Item(1, [*part.use], bare=True, soft=soft, start=part.start, end=part.end))


def _alike(first: Token, second: Token) -> bool:
    """Whether two marks may be joined: both legs, or both directions of travel."""
    return first.kind == second.kind or {first.kind, second.kind} == {"legs", "place"}


_MARKS = ("legs", "unknown", "named", "other", "main", "ways", "axis", "every", "each", "stem", "place")


def _axis(part: Token) -> Compass | None:
    one, two = compass_of(part.match["one"]), compass_of(part.match["two"])
    return axis_of(one) if one and two and axis_of(one) == axis_of(two) and one != two else None


def _points(words: str) -> list[Compass]:
    return [way for m in rule("control.way").finditer(words) if (way := compass_of(m["way"]))]


def _whose(mark: _Mark, item: Item) -> Iterator[tuple[str, Literal["in", "out", "both"]]]:
    """Keys of the legs that an item is of, and which way its lanes lead."""
    way = compass_of(item.toward) if item.toward else None
    if way is None:
        yield from ((key, item.way or "in") for key in mark.keys)
        return
    near = [key for key in mark.keys if key in COMPASS and axis_of(_bearing(key)) == axis_of(way)]
    if near and (not mark.toward or (len(near) == 1 and not item.uses)):
        yield from ((key, "out" if key == way else "in") for key in near)
    elif mark.toward or not near:
        yield (way, "out") if item.way == "out" else (turned(way, 180), "in")


__all__ = ["Approach", "Approaches", "approaches_of"]
