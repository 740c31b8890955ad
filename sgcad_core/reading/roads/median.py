"""Whether a road is said to be divided, and by what. Painted lines do not divide a road, a painted median may.

Knows no lane.
"""

from __future__ import annotations

from sgcad_core.reading.language import of_role, rule
from sgcad_core.records.specs import Median


def divided_and_median(text: str) -> tuple[bool | None, Median | None]:
    """Whether the road is said to be divided, and by what; painted lines alone do not divide."""
    if rule("median.undivided").search(text):
        return False, None
    text = rule("median.elsewhere").sub(" ", text)
    kind = next((told.yields["median"] for told in of_role("median_kind") if told.search(text)), None)
    said = bool(rule("median.divided").search(rule("median.painted_line").sub(" ", text)))
    if kind == "painted":
        return said or None, kind
    if said or (kind and rule("median.median_word").search(text)):
        return True, kind
    return None, None
