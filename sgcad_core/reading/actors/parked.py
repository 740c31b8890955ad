"""Parked vehicles to which a report that numbers the others gives no number. Knows no deed."""

from __future__ import annotations

import re

from sgcad_core.reading.actors.references import has_actor_numbers
from sgcad_core.reading.language import rule
from sgcad_core.reading.text.traced_text import TracedText


def number_parked(text: TracedText) -> TracedText:
    """A numbered text with the one parked vehicle that somebody hits and that has no number given the next one."""
    named = list(rule("references.parked").finditer(text.text))
    hits = {m.start("who") for m in rule("references.parked_hit").finditer(text.text)}
    hit = next((m.start() for m in named if m.start() in hits), None)
    if hit is None or not has_actor_numbers(text.text):
        return text
    number = max(int(m.group()[1:]) for m in rule("common.vehicle").finditer(text.text)) + 1
    return text.sub(rule("references.parked"), lambda m: _parked(m, f"V{number}", m.start() - hit))


def _parked(match: re.Match[str], id: str, behind: int) -> str:
    """The number; where it is hit first (`behind` 0) with the words that describe it; another one stays as it is."""
    if behind == 0:
        return f"an unnumbered {match['what']} ({id}), which was parked"
    return id if behind > 0 and match["det"].lower() == "the" else match.group()
