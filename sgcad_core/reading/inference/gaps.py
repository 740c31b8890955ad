"""Reasons why no crash can be drawn from a text, and what it would have to tell.

A text in another language, several reports in one file, an account that was blacked out, a form without an account, a
text without a crash, and a crash whose contact cannot be read. Knows no network.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.normalise import Sentence
from sgcad_core.reading.text.report_styles import is_form

_FEWEST_WORDS = 12
"""Below, the share of small words says nothing."""
_ENGLISH = 0.10
"""Share of small words in a text below which it is hardly English; reports of crashes have 0.2 and more."""
_NOTE = 0.20
"""The same with short-hand and words of traffic, of which notes have 0.4."""


class Gap(NamedTuple):
    """Why a text cannot be drawn, and what is missing."""

    reason: str
    missing: tuple[str, ...]
    roads_too: bool = False
    """Whether the text does not even tell of roads."""
    unread: bool = False
    """Whether a crash is told that the rules cannot read: another reader may."""


_NO_CRASH = Gap("the narrative tells no crash", ("a crash: who touched whom or what",))


def other_language(text: str) -> Gap | None:
    """Whether a text is in another language."""
    words, small = len(rule("gaps.word").findall(text)), len(rule("gaps.english").findall(text))
    short, other = len(rule("gaps.short_english").findall(text)), len(rule("gaps.other_language").findall(text))
    english = (small >= _ENGLISH * words or small + short >= _NOTE * words) and other <= small + short
    if words < _FEWEST_WORDS or english:
        return None
    return Gap("the narrative is not in English", ("an English narrative",), True)


def several_reports(text: str) -> Gap | None:
    """Whether a text holds several reports, each under its number."""
    numbers = dict.fromkeys(m["number"] for m in rule("gaps.report_number").finditer(text))
    if len(numbers) < 2:
        return None
    listed = ", ".join(list(numbers)[:4])
    return Gap(f"the file holds {len(numbers)} reports ({listed})", ("one report a file: split it",), True)


def _blacked_out(sentences: Sequence[Sentence]) -> bool:
    told = " ".join(s.text for s in sentences if s.role != "formal")
    hidden = rule("gaps.blacked_out").sub(" ", told)
    return hidden != told and len(rule("gaps.word").findall(hidden)) < _FEWEST_WORDS


def without_actors(text: str, sentences: Sequence[Sentence]) -> Gap:
    """Why a text names no vehicle."""
    if _blacked_out(sentences):
        return Gap("the account of the crash is blacked out", ("an account that is not redacted",), True)
    if (sentences or is_form(text)) and all(s.role == "formal" for s in sentences):
        what = "the text gives no account of the crash, only what the report says of itself"
        return Gap(what, ("what happened, in the narrative",), True)
    if sentences and not rule("gaps.crash_word").search(text):
        return _NO_CRASH
    return Gap("the narrative names no vehicle", ("which vehicles were involved", "how they traveled"))


def contact_untold(text: str, met: Iterable[bool]) -> Gap | None:
    """Whether no contact of the subject is told; `met`: of each contact, whether it is told and the subject's."""
    known = tuple(met)
    if any(known):
        return None
    if not rule("gaps.crash_word").search(text):
        return _NO_CRASH
    return Gap("the narrative's crash cannot be read: no contact of the report's subject is told",
               ("who struck whom or what", "with which sides"), unread=True)  # fmt: skip


def motion_untold(text: str) -> Gap:
    """The gap of a text with numbered vehicles, without a contact or direction: a drawing would be invented."""
    if not rule("gaps.crash_word").search(text):
        return _NO_CRASH
    reason = "the narrative tells neither who struck whom nor how anybody traveled"
    return Gap(reason, ("who struck whom, and with which sides", "in which direction each traveled"), unread=True)


def too_thin() -> Gap:
    """The gap of a text that tells which two vehicles touched and nothing else: all else would be a guess."""
    reason = "the narrative tells only who touched whom: sides, directions, maneuvers and roads are all left open"
    missing = "with which sides they touched", "in which direction each traveled", "on which road"
    return Gap(reason, missing, unread=True)
