"""Lanes of every approach to a junction where a report lists them: how many come in, what each is for, how many go out.

"From the west there are two lanes, the right one for right turns", "the north leg has a left-turn lane and a
through/right lane coming in and one lane going out", "one lane leaves on every leg". Reads resolved sentences. Lanes of
a road by directions of travel are read in `sgcad_core.reading.roads.lanes`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from sgcad_core.reading.junctions.approach_clauses import ClauseCutter, LaneClause
from sgcad_core.reading.junctions.approach_items import ApproachToken, LaneItem, lane_uses, tokens
from sgcad_core.reading.junctions.approach_marks import (
    ALL,
    APART,
    MAIN,
    ROADS,
    STEM,
    LegReference,
    LegReferences,
    bearing_of,
    road_names,
)
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import COMPASS, compass_of, turned
from sgcad_core.records.specs import Compass, Turn

MOST = 7
"""Lanes of one approach; more is a misreading."""
_NO_CLAUSE = ("codes", "factors")


@dataclass(frozen=True)
class Approach:
    """Lanes of one leg as told; None: not told."""

    lanes_in: int | None = None
    lanes_out: int | None = None
    turns_in: tuple[Turn, ...] = ()
    """The use of each lane that comes in, from the right curb, where turn lanes are told."""
    source: Source | None = field(default=None, compare=False, repr=False)
    """The sentence that tells the lanes that come in, else those that go out."""

    def over(self, other: Approach) -> Approach:
        """This, and what only the other tells."""
        own = self.lanes_in is not None
        alike = self.lanes_in == other.lanes_in
        return Approach(
            self.lanes_in if own else other.lanes_in,
            self.lanes_out if self.lanes_out is not None else other.lanes_out,
            self.turns_in or (other.turns_in if alike or not own else ()),
            (self.source if own else other.source) or self.source or other.source,
        )


@dataclass(frozen=True)
class Approaches:
    """What is told of single legs, of both legs of an axis, of the leg that ends at a T, of the road that goes on
    there, and of all legs."""

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


def approaches_of(statements: Iterable[Statement]) -> Approaches:
    """What the text lists of its approaches; nothing where it lists none."""
    statements = [*statements]
    reader = _Reader(road_names([t.text for t in statements]))
    for t in statements:
        if t.role not in _NO_CLAUSE:
            reader.sentence(t.text, t.number)
    return reader.result()


class _Reader:
    """Takes sentence after sentence."""

    def __init__(self, names: Mapping[str, Compass]) -> None:
        self.marks = LegReferences(names)
        self.found: dict[str, Approach] = {}
        self.listed: set[str] = set()
        """Keys of which a list is told, not just a number of lanes; without one nothing counts."""
        self.named: set[str] = set()
        """Keys of legs that are named as such, not by a direction of travel."""
        self.last: Approach = Approach()

    def result(self) -> Approaches:
        """All that was found, as far as it is told in such a way that it can be no misreading."""
        whole = [k for k, a in self.found.items() if k.startswith("axis ") and a.lanes_in and a.lanes_out]
        if not self.listed and len(whole) < 2:
            return Approaches()
        sure = {key: approach for key, approach in self.found.items() if self._sure(key, approach)}
        legs = {bearing_of(k): a for k, a in sure.items() if k in COMPASS}
        axes = {bearing_of(k): a for k, a in sure.items() if k.startswith("axis ")}
        stem, main, every = (sure.get(key, Approach()) for key in (STEM, MAIN, ALL))
        return Approaches(legs, axes, stem, main, every)

    def _sure(self, key: str, approach: Approach) -> bool:
        """Whether a leg is listed, or named, or a mere number beside a list of the leg across."""
        if key in self.listed or key in self.named or key in APART or (key.startswith("axis ") and approach.lanes_out):
            return True
        axis = axis_of(bearing_of(key))
        across = {axis_of(bearing_of(k)) for k in self.listed if k not in APART}
        return axis in across and (key not in COMPASS or f"axis {axis}" not in self.listed)

    # -------------------------------------------------------------- one sentence
    def sentence(self, text: str, number: int = 0) -> None:
        """Take what a sentence tells."""
        parts = tokens(text, tuple(self.marks.names))
        kinds = {part.kind for part in parts}
        others = "lanes" not in kinds and rule("approaches.signs").search(text)
        if kinds & {"lanes", "which", "use", "same"} and not others:
            for clause in ClauseCutter(self.marks, text, bool(self.found)).read(parts):
                self._take(clause, Source(number, "", "approaches.lanes"))
        else:
            self._scopes(parts)

    def _scopes(self, parts: Sequence[ApproachToken]) -> None:
        """Note of which road a sentence without lanes speaks."""
        for part in parts:
            if part.kind in ("legs", STEM, *ROADS):
                self.marks.mark = self.marks.of(part) or self.marks.mark

    # -------------------------------------------------------------- what it means
    def _take(self, clause: LaneClause, source: Source) -> None:
        told = self._copied(clause) if clause.copied_from or self._as_before(clause) else _told(clause)
        for key, approach in told.items():
            items = [item for item in clause.items if key in dict(_whose(clause.mark, item))]
            self._weigh(clause.mark, key, items, approach)
            self.found[key] = self.found.get(key, Approach()).over(replace(approach, source=source))
            if approach.lanes_in is not None:
                self.last = approach

    def _as_before(self, clause: LaneClause) -> bool:
        """Whether lanes are told to be the same, and no more than their number is told again."""
        alike = (item.plain and item.count == self.last.lanes_in for item in clause.items)
        return clause.same and all(alike)

    def _copied(self, clause: LaneClause) -> dict[str, Approach]:
        """What comes in on other legs, or on those told last, comes in on these."""
        keys = clause.copied_from.keys if clause.copied_from else ()
        known = next((self.found[key] for key in keys if key in self.found), None) if keys else self.last
        return {key: replace(known, lanes_out=None) for key in clause.mark.keys} if known else {}

    def _weigh(self, mark: LegReference, key: str, items: list[LaneItem], approach: Approach) -> None:
        """Note whether what is told of a leg is a list, and whether the leg is named."""
        turning = any({"L", "R"} & {*item.uses} for item in items)
        whole = approach.lanes_in is not None and approach.lanes_out is not None
        parted = whole and not all(item.way == "both" for item in items)
        if (turning and len(items) > 1) or (parted and key != ALL) or (not items and self.listed):
            self.listed.add(key)
        if not mark.toward and key in COMPASS and any(item.way or turning for item in items):
            self.named.add(key)


def _told(clause: LaneClause) -> dict[str, Approach]:
    """Key -> lanes, of what a clause lists."""
    told: dict[str, Approach] = {}
    groups: dict[str, list[LaneItem]] = {}
    for item in clause.items:
        for key, way in _whose(clause.mark, item):
            if way in ("out", "both"):
                told[key] = Approach(lanes_out=item.count).over(told.get(key, Approach()))
            if way in ("in", "both"):
                groups.setdefault(key, []).append(item)
    for key, some in groups.items():
        count, uses = lane_uses(some)
        came = Approach(min(count, MOST), None, uses if count <= MOST else ())
        told[key] = came.over(told.get(key, Approach()))
    return told


def _whose(mark: LegReference, item: LaneItem) -> Iterator[tuple[str, Literal["in", "out", "both"]]]:
    """Keys of the legs that an item is of, and which way its lanes lead."""
    way = compass_of(item.toward) if item.toward else None
    if way is None:
        yield from ((key, item.way or "in") for key in mark.keys)
        return
    near = [key for key in mark.keys if key in COMPASS and axis_of(bearing_of(key)) == axis_of(way)]
    if near and (not mark.toward or (len(near) == 1 and not item.uses)):
        yield from ((key, "out" if key == way else "in") for key in near)
    elif mark.toward or not near:
        yield (way, "out") if item.way == "out" else (turned(way, 180), "in")
