"""Reports that number no vehicle: each one is numbered where it is first described.

"a 2005 Honda Accord was ..." becomes "a 2005 Honda Accord (V1) was ...", in the order of the text, so that
everything behind works on numbers. A text that has any number stays as it is.
"""

from __future__ import annotations

import re

from sgcad_core.narrative.makes import BODY_WORDS, COLORS, MAKES
from sgcad_core.narrative.traced import Traced

_YEAR = r"(?:19|20)\d\d"
_MAKE = "|".join(sorted(map(re.escape, MAKES), key=len, reverse=True))
_BODY = "|".join(sorted((re.escape(b) for b in BODY_WORDS), key=len, reverse=True))
_COLOR = "|".join(COLORS)
_STOP = r"(?:was|were|is|are|had|has|that|which|who|when|and|pulled|turned|struck|hit|traveling|driven|"
_STOP += r"in|on|at|with|from|made|failed)"
_DESCRIBED = re.compile(
    rf"\b(?:an?|another)\s+(?P<what>(?:(?:{_COLOR}|{_YEAR}|small|large|full-size|compact|loaded|second|two-door|"
    rf"four-door)[ ,]+)*"
    rf"(?:(?P<make>{_MAKE})(?: (?!{_STOP}\b)[A-Z0-9][\w.-]*){{0,3}}(?: (?:{_BODY}))*|(?P<body>{_BODY})))\b(?! "
    rf"(?:stop|lane|dealer|driver|in front))",
    re.I)  # fmt: skip
_STRANGER = re.compile(r"\b(?:non-?contact|unknown|uninvolved|parked cars?|unidentified)\s*$", re.I)
_MOST = 6


def number_vehicles(text: Traced) -> Traced:
    """The normalized text with a number behind each first description; unchanged if there is any number."""
    if re.search(r"\bV\d+\b", text.text):
        return text
    seen: dict[str, int] = {}

    def numbered(match: re.Match[str]) -> str:
        key = (match["make"] or match["body"]).lower()
        if key in seen or len(seen) == _MOST or _STRANGER.search(match.string[: match.start()]):
            return match.group()
        seen[key] = len(seen) + 1
        return f"{match.group()} (V{seen[key]})"

    return text.sub(_DESCRIBED, numbered)
