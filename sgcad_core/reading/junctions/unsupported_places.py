"""Places of a crash that cannot be drawn: a roundabout where it happened is refused, one in passing changes nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sgcad_core.errors import Refused
from sgcad_core.kinds import Unsupported, unsupported_kind
from sgcad_core.reading.language import of_role, values
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.text.sentence_roles import STORY_ROLES


def unsupported_places(statements: Iterable[Statement]) -> tuple[str, ...]:
    """Kinds of `kinds.UNSUPPORTED` at which the sentences of the story put the crash or a vehicle of it, in the order
    of the text; none for what is only mentioned."""
    meaning = values("unsupported_place")
    story = [t.text for t in statements if t.role in STORY_ROLES]
    found = [rule.search(text) for text in story for rule in of_role("unsupported")]
    return tuple(dict.fromkeys(meaning[match["place"].lower()] for match in found if match))


def not_drawn(kinds: Sequence[str]) -> str:
    """The fault of a crash at places of these kinds, in words."""
    return f"the crash happened at {_listed(kinds)}, which cannot be drawn yet"


def refuse_unsupported(kinds: Sequence[str]) -> None:
    """Raise Refused where the crash happened at a place of a kind that is refused."""
    refused = [kind for kind in kinds if unsupported_kind(kind).severity == "refuse"]
    if refused:
        raise Refused(not_drawn(refused), [unsupported_kind(kind).remedy for kind in refused])


def _listed(kinds: Sequence[str]) -> str:
    records: list[Unsupported] = [unsupported_kind(kind) for kind in kinds]
    return " and ".join(record.called for record in records)
