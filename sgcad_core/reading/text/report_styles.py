"""Styles of reports that are brought to one form: driving studies, first-person statements, printed forms.

Driving studies call the watched vehicle the "subject", leave out articles and nouns ("Lead vehicle brakes", "Subject
must stop") and tell the driver by pronoun. In the first person, the narrator's vehicle becomes "the reporting vehicle".
Of a text with check boxes and numbered sections only the account is read: a line stays if it is prose, not in capitals,
without boxes. Knows no form by name.
"""

from __future__ import annotations

import re

from sgcad_core.reading.actors.references import has_actor_numbers
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.text.traced_text import TracedText


def tells_study(text: str) -> bool:
    """Whether a normalized text has a subject that a study watched."""
    return bool(rule("near_names.study").search(text))


def named_in_full(text: TracedText) -> TracedText:
    """The normalized text with articles and nouns for every actor; unchanged where it is no study's."""
    if not tells_study(text.text):
        return text
    numbered = bool(rule("common.vehicle").search(text.text))
    for spelling in of_role("study_spelling"):
        text = text.sub(spelling, spelling.yields["to"])
    if not numbered:
        return text
    text = text.sub(rule("near_names.whole"), "V1")
    alone = {m.group() for m in rule("common.vehicle").finditer(text.text)} == {"V1", "V2"}
    return text.sub(rule("near_names.other_whole"), "V2") if alone else text


def tells_first_person(text: str) -> bool:
    """Whether the narrator of a normalized text without vehicle numbers is in the crash."""
    return bool(rule("first_person.teller").search(text)) and not has_actor_numbers(text)


def in_third_person(text: TracedText) -> TracedText:
    """The normalized text with a name for the narrator's vehicle; unchanged in the third person."""
    if not tells_first_person(text.text):
        return text
    for spelling in of_role("first_person"):
        text = text.sub(spelling, spelling.yields["to"])
    return text


_FEWEST_MARKS = 3
"""Below, boxes and sections are punctuation."""


def is_form(text: str) -> bool:
    """Whether a text is a filled-in form."""
    return len(rule("forms.mark").findall(text)) >= _FEWEST_MARKS


def account(text: TracedText) -> TracedText:
    """The text without a form's own lines; characters keep their places. A text that is no form stays as it is."""
    return text.sub(rule("forms.line"), _prose_of_line) if is_form(text.text) else text


def _prose_of_line(match: re.Match[str]) -> str:
    """The line, without the name of its field; nothing where it is the form's."""
    label = rule("forms.label").match(match.group())
    line = match.group()[label.end() :] if label else match.group()
    return line if all(rule("forms.prose").match(words) for words in (match.group(), line)) else ""
