"""Whether all that is told of a crash speaks of a slight blow. Knows no vehicle and no speed."""

from __future__ import annotations

from collections.abc import Iterable

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.normalise import Sentence


def is_slight(sentences: Iterable[Sentence]) -> bool:
    """Whether a sentence tells that a blow was slight, and none that it was hard: one towed, hurt or badly damaged."""
    told = [sentence.text for sentence in sentences]
    return not any(map(_severe, told)) and any(rule("severity.slight").search(text) for text in told)


def _severe(text: str) -> bool:
    denied = rule("severity.denied")
    return any(not denied.search(text[: m.start()]) for m in rule("severity.severe").finditer(text))
