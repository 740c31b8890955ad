"""Notes on what of a report goes beyond a limit of the reader and was not taken as it is written."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.normalise import MOST_READ
from sgcad_core.reading.text.speeds import FASTEST_MPH, MILES

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading

BEYOND = "limit: "
"""How such a note begins."""


def limit_notes(reading: Reading) -> Iterator[str]:
    """One note a limit that the report goes beyond."""
    length = len(reading.narrative)
    if length > MOST_READ:
        yield f"{BEYOND}the rules read the first {MOST_READ:,} of {length:,} characters; the rest is not read"
    yield from dict.fromkeys(_too_fast(reading))


def _too_fast(reading: Reading) -> Iterator[str]:
    limit = rule("surroundings.limit")
    for sentence in reading.sentences:
        if limit.search(sentence.text):
            continue
        for name, factor in (("surroundings.speed", 1.0), ("surroundings.kmph", MILES)):
            for found in rule(name).finditer(sentence.text):
                mph = (float(found.group("a")) + float(found.group("b") or found.group("a"))) / 2 * factor
                if mph > FASTEST_MPH:
                    most = f"{FASTEST_MPH:.0f} mph, the most that is driven, stands in"
                    yield f"{BEYOND}{found.group().strip()!r} is told; {most}"
