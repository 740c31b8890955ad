"""Reports that number no vehicle: each one is numbered where it is first described.

"a 2005 Honda Accord was ..." becomes "a 2005 Honda Accord (V1) was ...", in the order of the text, so that
everything behind works on numbers. A text that has any number stays as it is.
"""

from __future__ import annotations

import re

from sgcad_core.language import rule
from sgcad_core.narrative.traced import Traced

_DESCRIBED = rule("unnumbered.described")
_STRANGER = rule("unnumbered.stranger")
_MOST = 6
_NEAR = 40
"""Characters before a description in which a word may say that it is of a stranger."""


def number_vehicles(text: Traced) -> Traced:
    """The normalized text with a number behind each first description; unchanged if there is any number."""
    if rule("common.vehicle").search(text.text):
        return text
    seen: dict[str, int] = {}

    def numbered(match: re.Match[str]) -> str:
        key = (match["make"] or match["body"]).lower()
        near = match.string[max(0, match.start() - _NEAR) : match.start()]
        if key in seen or len(seen) == _MOST or _STRANGER.search(near):
            return match.group()
        seen[key] = len(seen) + 1
        return f"{match.group()} (V{seen[key]})"

    return text.sub(_DESCRIBED, numbered)
