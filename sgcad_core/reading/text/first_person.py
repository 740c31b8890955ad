"""Statements in the first person: "I was driving north when the other car hit me" tells of the teller's vehicle.

They are brought to the words that other reports use: the teller, who is never described, is "the reporting vehicle".
"""

from __future__ import annotations

from sgcad_core.reading.actors.references import has_actor_numbers
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.text.traced_text import TracedText


def tells_first_person(text: str) -> bool:
    """Whether the teller of a normalized text that numbers nobody is in the crash."""
    return bool(rule("first_person.teller").search(text)) and not has_actor_numbers(text)


def in_third_person(text: TracedText) -> TracedText:
    """The normalized text with a name for the teller's vehicle; unchanged where somebody else tells."""
    if not tells_first_person(text.text):
        return text
    for spelling in of_role("first_person"):
        text = text.sub(spelling, spelling.yields["to"])
    return text
