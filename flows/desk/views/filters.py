"""Filters, sorting, counts and pages of the list's rows; `ListQuery` is the page's query string and back."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, get_args
from urllib.parse import urlencode

from flows.desk.views.list_rows import TRUSTS, Row, Trust

PAGE = 100
"""Cases on a page."""
FLAGS: Mapping[str, tuple[str, Callable[[Row], bool]]] = {
    "lacking": ("something told is lacking", lambda row: row.lacking > 0),
    "disagreeing": ("readers disagree", lambda row: row.disagreeing > 0),
    "doubts": ("has doubts", lambda row: row.doubts > 0),
    "mended": ("mended by a person", lambda row: row.mended > 0),
    "unmended": ("not mended yet", lambda row: row.mended == 0),
}
"""Conditions of the list: label and test."""
FACETS: Mapping[str, str] = {
    "trust": "Trust", "status": "Status", "kind": "Kind of crash", "place": "Place", "config": "Config",
}  # fmt: skip
_RANK: Mapping[Trust, int] = {trust: k for k, trust in enumerate(TRUSTS)}
SORTS: Mapping[str, tuple[str, Callable[[Row], Any]]] = {
    "trust": ("Trust", lambda r: (_RANK[r.trust], -r.lacking, -r.disagreeing - r.doubts, _low(r), r.case, r.config)),
    "case": ("Case", lambda r: (r.case, r.config)),
    "kind": ("Crash", lambda r: (r.kind, r.place, r.case)),
    "confidence": ("Confidence", lambda r: (_low(r), r.case)),
    "lacking": ("Told and lacking", lambda r: (-r.lacking, r.case)),
    "assumed": ("Assumed", lambda r: (-r.assumed, r.case)),
    "doubts": ("Doubts", lambda r: (-r.doubts - r.disagreeing, r.case)),
    "config": ("Config", lambda r: (r.config, r.case)),
}
"""Columns that sort, each with its first order."""


def _low(row: Row) -> float:
    return -1.0 if row.confidence is None else row.confidence


@dataclass(frozen=True)
class ListQuery:
    """The list's filters and order; empty means all. `below`: maximum confidence, in [0, 1]."""

    text: str = ""
    trust: str = ""
    status: str = ""
    kind: str = ""
    place: str = ""
    config: str = ""
    flag: str = ""
    below: float | None = None
    sort: str = "trust"
    reverse: bool = False
    page: int = 1

    @staticmethod
    def of(query: Mapping[str, str]) -> ListQuery:
        """Read a query string; unknown values are ignored."""
        texts = {name: str(query.get(name, ""))[:200] for name in ("text", *FACETS)}
        flag, sort = query.get("flag", ""), query.get("sort", "trust")
        return ListQuery(
            **texts, flag=flag if flag in FLAGS else "", below=_share(query.get("below", "")),
            sort=sort if sort in SORTS else "trust", reverse=query.get("reverse") == "1",
            page=max(1, _whole(query.get("page", "1"))),
        )  # fmt: skip

    def query(self, **changes: Any) -> str:
        """The query string of this with changes; without a change of page it is the first one."""
        asked = replace(self, **({"page": 1} | changes))
        said = {f.name: getattr(asked, f.name) for f in fields(asked) if getattr(asked, f.name) != f.default}
        return urlencode({name: "1" if value is True else value for name, value in said.items()})

    @property
    def narrowed(self) -> bool:
        """Whether it leaves anything out."""
        return any((self.text, self.flag, self.below is not None, *(getattr(self, name) for name in FACETS)))


def _share(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0 <= value <= 1 else None


def _whole(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 8 else 1


def chosen(rows: Iterable[Row], asked: ListQuery) -> list[Row]:
    """The rows that were asked for, in their order."""
    found = [row for row in rows if holds(row, asked)]
    return sorted(found, key=SORTS[asked.sort][1], reverse=asked.reverse)


def holds(row: Row, asked: ListQuery) -> bool:
    """Whether a row is asked for."""
    return not _unlike(row, asked) and _fits(row, asked)


def _unlike(row: Row, asked: ListQuery) -> list[str]:
    """The facets in which a row is another than what is asked for."""
    return [name for name in FACETS if (wanted := getattr(asked, name)) and getattr(row, name) != wanted]


def _fits(row: Row, asked: ListQuery) -> bool:
    """Whether a row has what is asked for beside the facets."""
    if asked.flag and not FLAGS[asked.flag][1](row):
        return False
    if asked.below is not None and (row.confidence is None or row.confidence > asked.below):
        return False
    return not asked.text or all(word in _told(row) for word in asked.text.casefold().split())


def _told(row: Row) -> str:
    return " ".join((row.case, row.config, row.kind, row.place, row.contact, row.reason, row.status)).casefold()


def counts(rows: Sequence[Row], asked: ListQuery) -> dict[str, list[tuple[str, int]]]:
    """For each facet its values, in order, with the number of cases that selecting one would leave."""
    tallies: dict[str, Counter[str]] = {name: Counter() for name in FACETS}
    for row in rows:
        unlike = _unlike(row, asked)
        if len(unlike) < 2 and _fits(row, asked):  # one more choice may bring it in, in that facet alone
            for name in unlike or FACETS:
                tallies[name][getattr(row, name)] += 1
    return {name: _in_order(name, tally, getattr(asked, name)) for name, tally in tallies.items()}


def _in_order(name: str, tally: Counter[str], wanted: str) -> list[tuple[str, int]]:
    known = get_args(Trust) if name == "trust" else sorted({*tally, wanted}, key=lambda value: (-tally[value], value))
    return [(value, tally[value]) for value in known if value and (tally[value] or value == wanted)]


def page_of(rows: Sequence[Row], asked: ListQuery) -> tuple[Sequence[Row], int, int]:
    """The rows of the page that was asked for (the last one where there are fewer), its number, and how many pages."""
    pages = max(1, -(-len(rows) // PAGE))
    number = min(asked.page, pages)
    return rows[(number - 1) * PAGE : number * PAGE], number, pages


def around(rows: Sequence[Row], key: str) -> tuple[Row | None, Row | None, int]:
    """The cases before and after one in the order of the list, and its number from 1 (0: it is not in there)."""
    for k, row in enumerate(rows):
        if row.key == key:
            return rows[k - 1] if k else None, rows[k + 1] if k + 1 < len(rows) else None, k + 1
    return None, rows[0] if rows else None, 0
