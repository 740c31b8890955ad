"""The account of one case, put together from its parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from sgcad_core.account.actors import actor_items
from sgcad_core.account.assumed import assumed_items
from sgcad_core.account.contacts import contact_items
from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.motion import motion_items
from sgcad_core.account.notes import Note
from sgcad_core.account.places import place_items
from sgcad_core.account.records import Account, Item, Verdict
from sgcad_core.account.told_places import told_place_items
from sgcad_core.account.unread_text import unread_items
from sgcad_core.records.facts import Fact

NOTHING = Account(verdict="none")


def account_of(made: ExecutedCase | None, facts: Iterable[Fact], notes: Iterable[Note] = ()) -> Account:
    """The account of a case: stated and present, stated and lacking, assumed. `made` None: nothing was executed.

    `facts`: all facts, as read and as written; `notes`: those of the kind `limit` are stated things that were not read.
    """
    if made is None:
        return NOTHING
    told = [*_told(made), *_limits(notes)]
    lacks = [item for item in told if item.kind == "lacks"]
    has = [item for item in told if item.kind == "has"]
    verdict: Verdict = "lacking" if lacks else "whole"
    return Account(verdict=verdict, items=(*lacks, *has, *assumed_items(made, facts)))


def _told(made: ExecutedCase) -> Iterator[Item]:
    yield from actor_items(made)
    yield from contact_items(made)
    yield from motion_items(made)
    yield from place_items(made)
    yield from unread_items(made)
    yield from told_place_items(made)


def _limits(notes: Iterable[Note]) -> Iterator[Item]:
    for note in notes:
        if note.kind == "limit":
            yield Item(
                kind="lacks", field=note.field or "text.limit", subject=note.subject, value=None, text=note.text,
                reason="beyond a limit of ours", start=note.start, end=note.end,
            )  # fmt: skip
