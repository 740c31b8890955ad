"""Whether a report tells that somebody lost control: skidded, slid, spun or could not hold the road.

One answer for the whole text: who it was is often left to the reader.
"""

from __future__ import annotations

import re

_LOST = re.compile(
    r"\b(?:los[et]|losing|loss of|regain\w*) (?:\w+ ){0,3}(?:control|traction)|(?<!no )\bskid(?! mark)|"
    r"\bslid(?:e|ing)?\b(?! door)|\bfishtail|\byaw|\bhydroplan|\bout of control|\bovercorrect|\bjackknif|"
    r"\bspun out", re.I)  # fmt: skip


def tells_lost_control(narrative: str) -> bool:
    """Whether somebody did not drive in the ordinary way."""
    return bool(_LOST.search(narrative))
