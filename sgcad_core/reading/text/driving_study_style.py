"""Narratives of driving studies: the one who is watched is the "subject", the others are told by their part.

They leave out articles and nouns ("Lead vehicle brakes", "Subject must stop") and tell the driver by pronoun. Here they
are brought to the words that other reports use, so that everything behind reads them alike.
"""

from __future__ import annotations

from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.text.traced_text import TracedText


def tells_study(text: str) -> bool:
    """Whether a normalized text has a subject that a study watched."""
    return bool(rule("near_names.study").search(text))


def named_in_full(text: TracedText) -> TracedText:
    """The normalized text with articles and nouns for everybody; unchanged where it is no study's."""
    if not tells_study(text.text):
        return text
    numbered = bool(rule("common.vehicle").search(text.text))
    for spelling in of_role("study_spelling"):
        text = text.sub(spelling, spelling.yields["to"])
    return text.sub(rule("near_names.whole"), "V1") if numbered else text
