"""The parts of a sentence that lists lanes of approaches: leg, number, use, in or out.

Marks of legs ("from the north", "southbound drivers", "every leg"), counts of lanes with their uses, and signs of the
direction. `sgcad_core.reading.junctions.approach_lanes` assigns them to legs.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.text.normalise import NUMBERS
from sgcad_core.records.specs import Turn

Uses = frozenset[str]
_TURNS: dict[Uses, Turn] = {
    frozenset("R"): "right", frozenset("RT"): "through_right", frozenset("T"): "through",
    frozenset("LT"): "left_through", frozenset("L"): "left", frozenset("LR"): "left_right", frozenset("LRT"): "any",
}  # fmt: skip
_FROM_CURB: tuple[Turn, ...] = ("right", "through_right", "left_right", "any", "through", "left_through", "left")


class ApproachToken(NamedTuple):
    """A part of a sentence, by the rule that reads it."""

    kind: str
    start: int
    end: int
    match: re.Match[str]
    use: str = ""


def tokens(text: str, names: tuple[str, ...] = ()) -> list[ApproachToken]:
    """Parts in order, none within another; of two that begin at one place the longer, else the one of lower weight.

    `names`: of roads.
    """
    found = [
        (m.start(), -m.end(), place, ApproachToken(by.yields["token"], m.start(), m.end(), m, by.yields.get("use", "")))
        for place, by in enumerate(of_role("approach_token"))
        for m in by.finditer(text)
        if m.end() > m.start()
    ]
    found += [
        (m.start(), -m.end(), 99, ApproachToken("named", m.start(), m.end(), m))
        for name in names
        for m in rule("approaches.named").given(name=name).finditer(text)
    ]
    kept: list[ApproachToken] = []
    for _, _, _, token in sorted(found, key=lambda one: one[:3]):
        if not kept or token.start >= kept[-1].end:
            kept.append(token)
    return kept


@dataclass
class LaneItem:
    """Some lanes: how many, the uses of each as far as told (`soft`: joined by "and" to the item before)."""

    count: int
    uses: list[str] = field(default_factory=list)
    way: Literal["", "in", "out", "both"] = ""
    toward: str = ""
    """The direction of travel that its words name, "northbound"."""
    bare: bool = False
    soft: bool = False
    which: bool = False
    start: int = 0
    end: int = 0
    after: str = ""
    """What stands between it and the next item."""

    @property
    def plain(self) -> bool:
        """Whether only a number is told."""
        return not (self.uses or self.way == "out" or self.bare or self.which)


def items_of(part: ApproachToken, text: str, listing: bool) -> list[LaneItem]:
    """The lanes of a count: "two through lanes"; "right-turn and left-turn lanes" are one each. Nothing of "the lane".

    `listing`: within a list, where "right lane" is one too.
    """
    words = part.match.groupdict()
    if part.kind == "which":
        number = 2 if words["which"].endswith(("two", "others")) else 1
        return [LaneItem(number, which=True, start=part.start, end=part.end)]
    if part.kind == "number" and _no_count(words["count"], text[: part.start]):
        return []
    mods = (words.get("mods") or "").lower()
    toward = next((m["way"] for m in rule("control.way").finditer(mods)), "")
    inner = tokens(mods)
    uses, out = [u for t in inner if t.kind == "use" for u in t.use], any(t.kind == "out" for t in inner)
    if uses and "turn" not in mods and rule("approaches.position").match(text[part.end :]):
        uses = [] if not {"T"} & {*uses} else uses
    count = (words.get("count") or "").lower()
    named = bool(uses) if listing else not count and bool(rule("approaches.turning").search(mods))
    if part.kind == "lanes" and count in ("", "the", "both") and not named:
        return []
    way: Literal["", "out"] = "out" if out else ""
    single = words.get("noun") == "lane" and not rule("approaches.two_turns").search(mods)
    if part.kind == "lanes" and len(uses) > 1 and not single and (not count or count_of(count) in (1, len(uses))):
        return [LaneItem(1, [use], way, toward, start=part.start, end=part.end) for use in uses]
    return [LaneItem(count_of(count), uses, way, toward, start=part.start, end=part.end)]


def _no_count(count: str, before: str) -> bool:
    """Whether a number counts no lanes: "Route 9", "a divided one", a paragraph's "3."."""
    if count == "one":
        return not rule("approaches.one").search(before)
    return bool(rule("approaches.numbered").search(before)) or (not before and count.isdigit())


def count_of(word: str | None) -> int:
    """3 of "3", "three" and "only three"; 1 of "a", "another", None."""
    last = (word or "one").lower().split()[-1]
    return int(last) if last.isdigit() else NUMBERS.get(last, 1)


# ------------------------------------------------------------------ uses of the lanes of one approach
def lane_uses(items: list[LaneItem]) -> tuple[int, tuple[Turn, ...]]:
    """Lanes towards the junction and, where turn lanes are told, the use of each from the right curb."""
    total, rest = _total(items)
    elements = _elements(rest, total)
    told = sum(n for _, n in elements)
    if total is None:
        total = told
    elif told < total:
        elements = [*elements, *_rest(elements, total - told)]
    elif told > total:
        total = told
    uses = [_TURNS[used or frozenset("T")] for used, n in elements for _ in range(n)]
    turning = any(use in ("right", "left", "left_right") for use in uses)
    shared = any(use != "through" for use in uses)
    return total, tuple(sorted(uses, key=_FROM_CURB.index)) if turning or (shared and total > 1) else ()


def _rest(elements: list[tuple[Uses, int]], spare: int) -> list[tuple[Uses, int]]:
    """Lanes of which nothing more is told: they go on, the outer ones also to a side that no other serves."""
    rest = ["T"] * spare
    if not any("R" in used for used, _ in elements):
        rest[0] += "R"
    if not any("L" in used for used, _ in elements):
        rest[-1] += "L"
    return [(frozenset(used), 1) for used in rest]


def _total(items: list[LaneItem]) -> tuple[int | None, list[LaneItem]]:
    """The number of all lanes where one comes before the list of what they are for, and the list."""
    first, *rest = items
    if len(first.uses) == 1 and first.count > 1 and rest and all(i.bare for i in rest) and first.count == 1 + len(rest):
        return first.count, [replace(first, count=1), *rest]  # "three lanes for right, through and left"
    if first.uses or first.bare or first.which or not rest:
        return None, items
    if rule("approaches.adding").search(first.after) and not _fits(first.count, rest):
        return None, items
    if any(item.uses for item in rest):
        return first.count, rest
    return None, items


def _fits(total: int, items: list[LaneItem]) -> bool:
    return sum(item.count for item in items) == total and total > 1


def _elements(items: list[LaneItem], total: int | None) -> list[tuple[Uses, int]]:
    """Uses and number of each kind of lane; "straight and right" are uses of one lane unless the total needs two."""
    split = [(frozenset(item.uses), item.count) for item in items]
    if total is not None and sum(n for _, n in split) == total:
        return split
    joined: list[tuple[Uses, int]] = []
    for item in items:
        if item.soft and item.bare and joined and joined[-1][0] == {"T"} and item.uses == ["R"]:
            joined[-1] = (frozenset("RT"), joined[-1][1])
        else:
            joined.append((frozenset(item.uses), item.count))
    return joined
