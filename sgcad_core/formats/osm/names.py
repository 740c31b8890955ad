"""Names of streets in one spelling: "N. Maple St", "North Maple Street", "Fifth Ave", "US-30", "State Route 17".

Knows American words for kinds of streets, sides and routes; no map and no narrative.
"""

from __future__ import annotations

import re
from typing import NamedTuple

_TOKEN = re.compile(r"[A-Za-z0-9]+(?:['’][A-Za-z]+)?")
_DOTTED = re.compile(r"\b([A-Za-z])\.(?=[A-Za-z]\b)")
_ROUTE = re.compile(
    r"^(?:(?P<us>us)|(?P<interstate>interstate|i)|(?P<county>county|co|cr)|(?P<state>state|st|sr|[a-z]{2}))?"
    r" ?(?:route|rt|rte|road|rd|highway|hwy|sr)? ?(?P<number>\d{1,4})(?: (?P<side>north|south|east|west|[nsew]))?$"
)
_CLASSES = ("us", "interstate", "county", "state")
_SIDES = {
    "north": "n", "south": "s", "east": "e", "west": "w", "northeast": "ne", "northwest": "nw", "southeast": "se",
    "southwest": "sw",
}  # fmt: skip
_SIDES |= {short: short for short in _SIDES.values()}
_KINDS = {
    "street": ("st", "str"), "avenue": ("ave", "av"), "road": ("rd",), "boulevard": ("blvd", "boul"), "lane": ("ln",),
    "drive": ("dr",), "court": ("ct",), "place": ("pl",), "parkway": ("pkwy", "pky"), "highway": ("hwy",),
    "terrace": ("ter", "terr"), "circle": ("cir",), "trail": ("trl",), "square": ("sq",), "turnpike": ("tpke",),
    "expressway": ("expy",), "freeway": ("fwy",), "connector": ("conn",), "alley": ("aly",), "way": (), "loop": (),
    "pike": (), "crossing": ("xing",), "bypass": (), "row": (), "path": (), "plaza": ("plz",),
}  # fmt: skip
_KIND_OF = {word: kind for kind, short in _KINDS.items() for word in (kind, *short)}
_ORDINALS = (
    "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth", "eleventh",
    "twelfth", "thirteenth", "fourteenth", "fifteenth", "sixteenth", "seventeenth", "eighteenth", "nineteenth",
    "twentieth",
)  # fmt: skip
_ENDINGS = {1: "st", 2: "nd", 3: "rd"}
_SHORT = {word: f"{n}{_ENDINGS.get(n, 'th')}" for n, word in enumerate(_ORDINALS, 1)}
_SHORT |= {"st": "saint", "mt": "mount", "ft": "fort", "dr": "doctor", "jr": "junior"}


class StreetName(NamedTuple):
    """A name taken apart. `kind`: "street", "avenue" ..., of a route its class; `side`: "n", "se" ...; "": untold."""

    core: str
    kind: str = ""
    side: str = ""
    route: bool = False

    def likeness(self, other: StreetName) -> int:
        """0: other streets; else 1 for the same core, and 1 more for each of kind and side that is the same."""
        if (self.core, self.route) != (other.core, other.route):
            return 0
        pairs = ((self.kind, other.kind), (self.side, other.side))
        if any(a and b and a != b for a, b in pairs):
            return 0
        return 1 + sum(a == b for a, b in pairs)


def street_name(text: str) -> StreetName | None:
    """A name in one spelling; None of a text without a word."""
    words = [word.lower().replace("’", "'") for word in _TOKEN.findall(_DOTTED.sub(r"\1", text))]
    if not words:
        return None
    if route := _ROUTE.match(" ".join(words)):
        named = next((name for name in _CLASSES if route[name]), "")
        return StreetName(route["number"], named, _SIDES.get(route["side"] or "", ""), True)
    return _plain(words)


def _plain(words: list[str]) -> StreetName:
    """Side before or behind the name, kind at its end, ordinals as numbers; the last word left is always the core."""
    side = kind = ""
    if len(words) > 2 and words[-1] in _SIDES and words[-2] in _KIND_OF:
        side, words = _SIDES[words[-1]], words[:-1]
    if len(words) > 1 and words[-1] in _KIND_OF:
        kind, words = _KIND_OF[words[-1]], words[:-1]
    if len(words) > 1 and words[0] in _SIDES and not side:
        side, words = _SIDES[words[0]], words[1:]
    return StreetName(" ".join(_SHORT.get(word, word) for word in words), kind, side)
