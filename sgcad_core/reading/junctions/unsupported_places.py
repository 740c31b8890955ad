"""Places of a crash that cannot be drawn as they are; one that is named in passing changes nothing."""

from __future__ import annotations

from collections.abc import Iterable

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
