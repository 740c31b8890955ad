"""Whether all that is told of a crash speaks of a slight blow. Knows no vehicle and no speed."""

from __future__ import annotations

from collections.abc import Iterable

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.normalise import Sentence


def is_slight(sentences: Iterable[Sentence]) -> bool:
    """Whether a sentence tells a slight blow, or no more than a contact, and none a hard one: one towed, hurt or badly
    damaged."""
    told = [sentence.text for sentence in sentences]
    if any(map(_severe, told)):
        return False
    touched = any(map(rule("severity.touched").search, told)) and not any(map(rule("severity.blow").search, told))
    return touched or any(map(rule("severity.slight").search, told))


def _severe(text: str) -> bool:
    denied = rule("severity.denied")
    return any(not denied.search(text[: m.start()]) for m in rule("severity.severe").finditer(text))
