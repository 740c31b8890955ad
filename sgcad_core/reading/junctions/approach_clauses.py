"""A sentence that lists lanes of approaches, cut into stretches of lanes of the same legs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from sgcad_core.reading.junctions.approach_items import ApproachToken, LaneItem, items_of
from sgcad_core.reading.junctions.approach_marks import KINDS, ROADS, LegReference, LegReferences
from sgcad_core.reading.language import rule
from sgcad_core.reading.text.compass import COMPASS


class LaneClause(NamedTuple):
    """Lanes of the same legs; `same`: they are as those told before, or as those of `copied_from`."""

    mark: LegReference
    items: list[LaneItem]
    same: bool
    copied_from: LegReference | None = None


@dataclass
class ClauseCutter:
    """Cuts a sentence into stretches of lanes of the same legs."""

    marks: LegReferences
    text: str
    known: bool = False
    """Whether lanes were told before this sentence."""
    items: list[LaneItem] = field(default_factory=list)
    same: bool = False
    driven: bool = False
    """Whether a vehicle was named: the lanes behind it are where it drives."""
    heading: Literal["", "in", "out"] = ""
    """What a list stands under: "Lanes out:"."""
    next: Literal["", "in", "out"] = ""
    """Which way the next lanes lead: "leaves with one"."""
    last: ApproachToken | None = None
    marked: ApproachToken | None = None
    """The last mark, while no lanes follow it."""

    def read(self, parts: Sequence[ApproachToken]) -> Iterator[LaneClause]:
        """The stretches in order."""
        for part in parts:
            if part.kind == "sep":
                self.driven = self.driven and part.match[0] not in ";."
                continue
            if part.kind in ROADS and rule("approaches.located").search(self.text[: part.start]):
                continue
            if part.kind in KINDS or (part.kind == "each_way" and self.items and self.items[-1].way == "out"):
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

    def _flush(self) -> Iterator[LaneClause]:
        if self.items or self.same:
            yield LaneClause(self.marks.mark, self.items, self.same and self.marked is not None)
        self.items, self.same = [], False

    # -------------------------------------------------------------- legs of the lanes
    def _marked(self, part: ApproachToken) -> Iterator[LaneClause]:
        before = self.marks.mark
        found = self.marks.of(part)
        self.driven = self.driven and not rule("approaches.drivers").search(self.text[: part.start])
        if found is None:
            return
        gap = self._gap(part)
        if self.same and not self.items and self.marked and part.kind == "legs":
            self.marks.mark, self.same = before, False
            yield LaneClause(before, [], True, found)
            return
        if part.kind == "every" and self.marked and not self.items and self.marked.kind in ROADS:
            self.marks.mark = before
            return
        if self.marked and not self.items and _alike(self.marked, part) and rule("approaches.joint").fullmatch(gap):
            found = LegReference(tuple(dict.fromkeys((*before.keys, *found.keys))), found.toward)
        elif self.marked and not self.items and part.kind in ROADS and gap.strip() in ("on", "on the", "of"):
            return
        elif self.items and self._of_last(part, found, before, gap):
            self.marks.mark = before
            return
        elif self.items and self._behind(part, before):
            yield from self._trailing(part, found, before)
            return
        elif self.items:
            self.marks.mark = before
            yield from self._flush()
        self.marks.mark, self.marked = found, part

    def _gap(self, part: ApproachToken) -> str:
        return self.text[self.last.end : part.start] if self.last else self.text[: part.start]

    def _of_last(self, part: ApproachToken, found: LegReference, before: LegReference, gap: str) -> bool:
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

    def _behind(self, part: ApproachToken, before: LegReference) -> bool:
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

    def _trailing(self, part: ApproachToken, found: LegReference, before: LegReference) -> Iterator[LaneClause]:
        """The lanes before the mark are those of its legs; of others before them, if the last go out."""
        last = self.items[-1]
        only_last = len(self.items) > 1 and (last.way == "out" or (part.kind == "ways" and last.plain))
        if only_last:
            self.items, rest = [last], self.items[:-1]
            yield LaneClause(before, rest, self.same)
        self.same = False
        self.marks.mark, self.marked = found, None
        if part.kind in ("place", "legs") or last.way == "out" or (part.kind == "ways" and not last.plain):
            yield from self._flush()
            self.marks.mark = before if part.kind in ("place", "legs") else found

    # -------------------------------------------------------------- lanes
    def _lanes(self, part: ApproachToken) -> None:
        """Add a part to the lanes of this stretch."""
        last = self.items[-1] if self.items else None
        if part.kind in ("lanes", "number", "which"):
            if last is not None and not last.after:
                last.after = self.text[last.end : part.start]
            opening = self.marked is not None and self._gap(part).strip() == ":"
            new = items_of(part, self.text, bool(self.items) or opening)
            way = self.next or self.heading
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

    def _directed(self, part: ApproachToken) -> None:
        """A sign of the direction: of the lanes right before it, or of all that come in the list under it."""
        way: Literal["in", "out"] = "out" if part.kind == "out" else "in"
        if not self.items:
            self.heading = way if self.text[part.end :].startswith((":", ",")) else self.heading
        elif way == "out" and rule("approaches.ahead").match(self.text[part.end :]):
            self.next = way
        elif not self.items[-1].way and not rule("approaches.cut").search(self.text[self.items[-1].end : part.start]):
            self.items[-1].way = way

    def _use(self, part: ApproachToken) -> None:
        gap = self._gap(part)
        if not self.items:
            listing = "lane" in self.text.lower() or self.known
            if self.marked and listing and rule("approaches.bare").fullmatch(gap):
                self.items.append(LaneItem(1, [*part.use], bare=True, start=part.start, end=part.end))
            return
        last = self.items[-1]
        shares = bool(last.uses) and bool(rule("approaches.sharing").fullmatch(gap))
        soft = bool(rule("approaches.soft").search(gap))
        between = self.text[last.end : part.start]
        listed = rule("approaches.lists").search(gap) or rule("approaches.list_opens").search(between)
        single = last.count == 1 or last.which or not listed
        first = not last.uses and not last.bare and single
        if first or (shares and not (soft and last.bare)):
            last.uses.extend(part.use)
            last.end = part.end
            return
        last.after = last.after or gap
        self.items.append(LaneItem(1, [*part.use], bare=True, soft=soft, start=part.start, end=part.end))


def _alike(first: ApproachToken, second: ApproachToken) -> bool:
    """Whether two marks may be joined: both legs, or both directions of travel."""
    return first.kind == second.kind or {first.kind, second.kind} == {"legs", "place"}
