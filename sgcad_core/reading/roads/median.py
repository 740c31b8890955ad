"""Whether a road is said to be divided, and by what. Painted lines do not divide a road, a painted median may.

Knows no lane.
"""

from __future__ import annotations

from sgcad_core.reading.language import of_role, rule
from sgcad_core.records.specs import Median

_UNDIVIDED = rule("median.undivided")
_DIVIDED = rule("median.divided")

_ELSEWHERE = rule("median.elsewhere")
_PAINTED_LINE = rule("median.painted_line")


def divided_and_median(text: str) -> tuple[bool | None, Median | None]:
    """Whether the road is said to be divided, and by what; painted lines alone do not divide."""
    if _UNDIVIDED.search(text):
        return False, None
    text = _ELSEWHERE.sub(" ", text)
    kind = next((told.yields["median"] for told in of_role("median_kind") if told.search(text)), None)
    said = bool(_DIVIDED.search(_PAINTED_LINE.sub(" ", text)))
    if kind == "painted":
        return said or None, kind
    if said or (kind and rule("median.median_word").search(text)):
        return True, kind
    return None, None
