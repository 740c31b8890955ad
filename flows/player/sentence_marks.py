"""The sentences of a report and how each of them was read: one account for player, desk and report page.

Places are [start, end) in the narrative as it was written; the pages show it with words about persons replaced. Knows
no page and no thing that a page lights up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

MARKS = ("contradicts", "unread", "lacks")
"""How a sentence was not read as it stands, the gravest first: the report says something else as well; something of it
was not read; the scenario lacks something that it tells."""
MARK_WORDS = {"contradicts": "contradicted", "unread": "not read", "lacks": "not in the scenario"}
"""The same in words, which stand beside the color."""
READ = "read"
"""The mark of a sentence that tells facts and that the account has nothing against."""
Row = Mapping[str, Any]
Place = tuple[int, int]


class ToldSentence(NamedTuple):
    """One sentence: [start, end) in the text as shown, [of, upto) as written, the fields of its facts, its mark."""

    start: int
    end: int
    of: int
    upto: int
    fields: tuple[str, ...]
    mark: str


def told_sentences(facts: Iterable[Row], items: Iterable[Row], shown: Callable[[Place], Place]) -> list[ToldSentence]:
    """The sentences that tell facts, or that the account's items name, in order.

    `shown`: where a place of the narrative stands in the text as shown; empty where it was left out.
    """
    fields: dict[Place, dict[str, None]] = {}
    for fact in facts:
        if place := _place(fact):
            fields.setdefault(place, {})[fact["field"]] = None
    marks = _marks(items)
    for place in marks:
        if not any(_overlap(place, one) for one in fields):
            fields[place] = {}
    found, at = list[ToldSentence](), 0
    for place, told in sorted(fields.items()):
        start, end = shown(place)
        if at <= start < end:
            found.append(ToldSentence(start, end, *place, tuple(told), _gravest(place, marks)))
            at = end
    return found


def _place(row: Row) -> Place | None:
    start, end = row.get("start"), row.get("end")
    return None if start is None or end is None else (start, end)


def _overlap(one: Place, other: Place) -> bool:
    return one[0] < other[1] and other[0] < one[1]


def _marks(items: Iterable[Row]) -> dict[Place, str]:
    """Places of the narrative with the gravest thing that the account says of them."""
    found: dict[Place, str] = {}
    for item in items:
        if item["kind"] in MARKS and (place := _place(item)):
            found[place] = min(found.get(place, item["kind"]), item["kind"], key=MARKS.index)
    return found


def _gravest(place: Place, marks: Mapping[Place, str]) -> str:
    return min((mark for one, mark in marks.items() if _overlap(one, place)), key=MARKS.index, default=READ)


def sentence_at(sentences: Iterable[ToldSentence], start: int | None) -> int:
    """Number of the sentence that a place as written begins in; -1 for none."""
    inside = (k for k, s in enumerate(sentences) if start is not None and s.of <= start < s.upto)
    return next(inside, -1)
