"""What happens to a lone vehicle that touches nothing: it rolls over, burns, folds up, ends in water, leaves the road.

Read only where no contact is told. Knows sentences; no motion and no road.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.language import of_role
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.sentence_roles import STORY_ROLES

EventKind = Literal["rollover", "fire", "jackknife", "water", "departure"]


class Untouched(NamedTuple):
    """The event of a crash without a contact, and where it is told."""

    vehicle: str
    kind: EventKind
    source: Source


def untouched_event(
    statements: Sequence[Statement], roster: Roster, contact_mentions: Sequence[ContactMention]
) -> Untouched | None:
    """The event that weighs most, of a report with vehicle numbers and one vehicle that tells no contact."""
    if roster.counted or len(roster.ids) != 1 or contact_mentions:
        return None
    for wording in of_role("untouched"):
        for t in statements:
            if t.role in STORY_ROLES and (m := wording.search(t.text)):
                return Untouched(roster.ids[0], wording.yields["kind"], Source(t.number, m[0], wording.id))
    return None
