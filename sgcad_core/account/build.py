"""The account of one case, put together from its parts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from sgcad_core.account.assumed import assumed_items, unsure_items
from sgcad_core.account.contacts import actor_items, at_contact_items, contact_items
from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.motion import motion_items
from sgcad_core.account.notes import Note
from sgcad_core.account.odd_scenes import odd_scenes
from sgcad_core.account.places import map_items, place_items
from sgcad_core.account.records import Account, Disagreement, Item
from sgcad_core.account.second_opinion import weighed
from sgcad_core.account.told_places import parking_items, signal_items, told_place_items
from sgcad_core.account.unread_clauses import unread_clauses
from sgcad_core.account.unread_text import unread_items
from sgcad_core.account.verdict import (
    ORDER,
    contradictions,
    guesses,
    implied_swings,
    odd_driving,
    places,
    sentence_of,
    untold_swerves,
    verdict_of,
)
from sgcad_core.case.records import Stage
from sgcad_core.records.facts import Fact

NOTHING = Account(verdict="none", sentence="there is no scenario")


def account_of(
    made: ExecutedCase | None,
    facts: Iterable[Fact],
    notes: Sequence[Note] = (),
    asked: Sequence[Disagreement] = (),
    models: Collection[Stage] = (),
) -> Account:
    """The account of a case: stated and present, stated and lacking, assumed. `made` None: nothing was executed.

    `facts`: all facts, as read and as written; `notes`: those of the kind `limit` are stated things that were not read;
    `asked`: what the writers were asked about and kept; `models`: stages that a model wrote.
    """
    if made is None:
        return NOTHING.model_copy(update={"disagreements": tuple(asked)})
    told, differing = weighed(made, [*_told(made), *_limits(notes)], asked, models)
    told += [*odd_driving(made, notes), *untold_swerves(made, notes), *places(made), *unread_clauses(made)]
    told += odd_scenes(made)
    told += [*contradictions(made), *guesses(made), *unsure_items(made)]
    ranked = sorted(told, key=lambda item: ORDER.index(item.kind))
    items = (*ranked, *assumed_items(made, facts), *implied_swings(notes))
    verdict = verdict_of(items, differing)
    said = sentence_of(verdict, items, differing)
    return Account(verdict=verdict, sentence=said, items=items, disagreements=tuple(differing))


def _told(made: ExecutedCase) -> Iterator[Item]:
    yield from actor_items(made)
    yield from contact_items(made)
    yield from at_contact_items(made)
    yield from motion_items(made)
    yield from place_items(made)
    yield from unread_items(made)
    yield from told_place_items(made)
    yield from signal_items(made)
    yield from parking_items(made)
    yield from map_items(made)


def _limits(notes: Iterable[Note]) -> Iterator[Item]:
    for note in notes:
        if note.kind == "limit":
            yield Item(
                kind="lacks", field=note.field or "text.limit", subject=note.subject, value=None, text=note.text,
                reason="beyond a limit of ours", start=note.start, end=note.end,
            )  # fmt: skip
