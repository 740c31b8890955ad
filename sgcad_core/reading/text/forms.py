"""Printed forms: of a text with check boxes and numbered sections only the account is read.

"VEHICLE 2" in a form's heading numbers nobody, and a box that nobody marked tells nothing. A line stays if it is prose:
a sentence, not in capitals, without boxes. Knows no vehicle and no form by name.
"""

from __future__ import annotations

import re

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.traced_text import TracedText

_FEWEST_MARKS = 3
"""Below, boxes and sections are somebody's punctuation."""


def is_form(text: str) -> bool:
    """Whether a text is a filled-in form."""
    return len(rule("forms.mark").findall(text)) >= _FEWEST_MARKS


def account(text: TracedText) -> TracedText:
    """The text without a form's own lines; characters keep their places. What is no form stays as it is."""
    return text.sub(rule("forms.line"), _told) if is_form(text.text) else text


def _told(match: re.Match[str]) -> str:
    """The line, without the name of its field; nothing where it is the form's."""
    label = rule("forms.label").match(match.group())
    line = match.group()[label.end() :] if label else match.group()
    return line if all(rule("forms.prose").match(words) for words in (match.group(), line)) else ""
