"""The text of a crash report made uniform: one spelling per mention, unit and direction; sentences.

`normalised` is idempotent and changes spelling only: "Vehicle # 1", "vehicle one (V1 - case vehicle)" and
"V 1" all become "V1". Every character keeps its place in the text that was given. Knows no facts.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from sgcad_core.narrative.roles import CRASH_ROLES, Role, role_of
from sgcad_core.narrative.traced import Traced, joined
from sgcad_core.narrative.unnumbered import number_vehicles

__all__ = ["CRASH_ROLES", "NUMBERS", "Role", "Sentence", "normalised", "normalize", "sentences", "split_sentences"]

NUMBERS = {
    "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10,
}  # fmt: skip
LONGEST = 1000
"""Characters of a sentence; the longest in published reports has about 650."""
_WORDS = {str(number): word for word, number in NUMBERS.items()}
_NUMBER = rf"(?:\d{{1,2}}|{'|'.join(NUMBERS)})"
NUM = rf"(?:{_NUMBER}|a single|single)"
"""A count of lanes."""
_COMPASS = r"(?:north|south)(?:[ -]?(?:east|west))?|east|west"


class Sentence(NamedTuple):
    """One normalized sentence, what it is for, and where it stands (all counted from 0).

    [start, end): its characters in the text as it was given, white space around left out.
    """

    text: str
    role: Role
    number: int
    paragraph: int
    start: int = 0
    end: int = 0


# ------------------------------------------------------------------ characters
_CHARACTERS = str.maketrans({
    "\u2018": "'", "\u2019": "'", "\u201c": '"', "\u201d": '"', "\u2013": "-", "\u2014": " - ", "\u00a0": " ",
    "\ufffd": '"', "\u2032": "'", "\u2033": '"', "\t": " ", "\r": "\n", "\u00bd": " 1/2", "\u2022": " ", "\x0b": "\n",
    "\x0c": "\n", "\u2028": "\n", "\u2029": "\n", "\x85": "\n",
})  # fmt: skip

_TYPOS = {
    "easr": "east", "raod": "road", "raodway": "roadway", "roaday": "roadway", "roadwy": "roadway", "waitng": "waiting",
    "becuase": "because", "becasue": "because", "hosptial": "hospital", "precrsh": "precrash", "drdiver": "driver",
    "dirver": "driver", "approxiamtely": "approximately", "approximatley": "approximately", "assosiative": "associated",
    "associative": "associated", "thru": "through", "loosing": "losing", "waived": "waved",
    "intesection": "intersection",
    "intersecton": "intersection", "interesection": "intersection", "vehcile": "vehicle", "vehicel": "vehicle",
    "vechicle": "vehicle", "vehilce": "vehicle", "veihcle": "vehicle", "vehice": "vehicle",
    "travelling": "traveling", "traveing": "traveling", "travling": "traveling", "negoatiating": "negotiating",
    "negotating": "negotiating", "negociating": "negotiating", "manuever": "maneuver", "manuver": "maneuver",
    "manoeuvre": "maneuver", "centreline": "centerline", "lefthand": "left", "righthand": "right",
    "struct": "struck", "strcuk": "struck", "sturck": "struck", "collied": "collided",
    "contacetd": "contacted", "conctacted": "contacted", "imapcted": "impacted", "imapct": "impact",
    "lighed": "lighted", "daylite": "daylight", "daylght": "daylight", "striaght": "straight", "staight": "straight",
    "signalled": "signaled", "unsignalled": "unsignaled", "sideswipped": "sideswiped", "teh": "the", "adn": "and",
    "infront": "in front", "inthe": "in the", "onthe": "on the", "ofthe": "of the",
    "alot": "a lot", "oppostie": "opposite", "opposit": "opposite",
    "northound": "northbound", "southound": "southbound", "eastound": "eastbound", "westound": "westbound",
    "nortbound": "northbound", "soutbound": "southbound", "eastboud": "eastbound", "westboud": "westbound",
}  # fmt: skip
_TYPO = re.compile(rf"\b({'|'.join(map(re.escape, _TYPOS))})\b", re.I)

_COUNTED = (
    "lanes?|years?|quarters?|points?|doors?|ways?|vehicles?|wheels?|times|occupants?|people|feet|meters?|cars?|legs?"
)
# ------------------------------------------------------------------ mentions, units, directions
_SPELLINGS: tuple[tuple[str, str], ...] = (
    (r"(?-i:\b([a-z]{2,})(V\d{1,2})\b)", r"\1 \2"),
    # a vehicle's number
    (rf"\b(?:vehicle|veh)s?\b\.?\s*(?:#|no\.?|number|num\.?|"
     rf"-)?\s*\.?\s*#?\s*({_NUMBER})\b(?!\s*[-/]?\s*(?:{_COUNTED})\b)", r"V\1"),
    (rf"\bV\s*(?:#|-)?\s*({_NUMBER})\b", r"V\1"),
    (rf"\b(?:traffic )?unit\s*(?:#|no\.?|number)?\s*({_NUMBER})\b(?!\s*[-/]?\s*(?:{_COUNTED})\b)", r"V\1"),
    (r"\bD(\d)\b(?!-)", r"the driver of V\1"),
    (rf"\bdriver\s*(?:#|no\.?|number)?\s*({_NUMBER})\b(?!\s*[-/]?\s*(?:{_COUNTED})\b)", r"the driver of V\1"),
    # "V1 (V1 - case vehicle)", "V1 (case vehicle)"
    (r"\bV(\d+)\s*,?\s*\(\s*V\1\b[^()]{0,40}\)", r"V\1"),
    (r"\bV(\d+)\s*\(\s*(?:the )?case vehicle\s*\)", r"V\1"),
    (r"\(\s*V(\d+)\s*\)", r"(V\1)"),
    (r"\(\s*V(\d+)\s*[-,:;]\s*", r"(V\1, "),
    (r"\(([^()]{1,60}?)\s*[-,:;]\s*V(\d+)\s*\)", r"(V\2, \1)"),
    (r"\bV(\d+)\s*,\s*(?=\S)", r"V\1, "),
    (r"\bV(\d+)(?=(?:19|20)\d\d\b)", r"V\1 "),
    # units
    (r"(?<=\d)\s*(?:kmph|kmp|kpmh|kphm|kph|km/h|km/hr|kmh|kilomet(?:er|re)s (?:per|an) hour)\b\.?", " kmph"),
    (r"(?<=\d)\s*(?:mph|m\.p\.h\.|mi/h|mhp|miles (?:per|an) hour)(?![a-z])", " mph"),
    # directions
    (rf"\b({_COMPASS})[ -]+bound(?:ed)?\b", r"\1bound"),
    (r"\b(north|south)[ -](east|west)(?=\b|bound|erly|ern)", r"\1\2"),
    (r"\bN\s?/?\s?B\b", "northbound"), (r"\bS\s?/?\s?B\b", "southbound"),
    (r"\bE\s?/?\s?B\b", "eastbound"), (r"\bW\s?/?\s?B\b", "westbound"),
    (r"\b(north|south|east|west)ward(?:s|ly)?\b", r"\1"),
    # roads
    (r"(?<![\w-])(?:type )?[\"']?T[\"']?[ -]*(?:type |style )?(?:legged )?intersection", "T-intersection"),
    (r"\b(?:three|3)[ -]?(?:legged|leg|way)[ -]intersection", "T-intersection"),
    (r"\b(?:four|4)[ -]?(?:legged|leg|way)[ -]intersection", "four-leg intersection"),
    (r"\bcent(?:er|re)[ -]line\b", "centerline"),
    (r"\btraffic way", "trafficway"), (r"\bu[ -]turn", "u-turn"),
    (r"\btractor[ -]trailer", "tractor-trailer"), (r"\bpick[ -]up\b(?=(?: truck)?\b)", "pickup"),
    (r"\brear[ -]end(ed|ing|s)?\b", r"rear-end\1"), (r"\bside[ -]swip", "sideswip"), (r"\bhead[ -]on\b", "head-on"),
    (r"\bit's (?=(?:front|rear|back|left|right|side|lane|own|path|top|trailer|driver|final|bumper|brakes|"
     r"passenger)\b)", "its "),
    (r"\bpre[ -]crash\b", "precrash"), (r"\bcounter[ -]clockwise\b", "counterclockwise"),
)  # fmt: skip
_PATTERNS = tuple((re.compile(pattern, re.I), to) for pattern, to in _SPELLINGS)
_LETTERED = re.compile(r"\b[Vv]ehicle ([A-D])\b(?!-| ?pillar)")
_VEHICLE_WORD = re.compile(rf"\bV({'|'.join(NUMBERS)})\b", re.I)
_VEHICLE_CASE = re.compile(r"\bv0*(\d+)\b", re.I)
_COUNTED_LANE = re.compile(
    rf"(?<!#)(?<!# )(?<!number )\b({'|'.join(_WORDS)}|{'|'.join(NUMBERS)})[ -]+lane\b(?!s)", re.I
)


def normalize(text: str) -> str:
    """The same report with one spelling for mentions (V1), units (kmph, mph), directions and road words.

    Paragraphs stay apart ("\\n\\n"); everything else is single-spaced. normalize(normalize(t)) == normalize(t).
    """
    return normalised(Traced.of(text)).text


def normalised(text: Traced) -> Traced:
    """`normalize` of a text whose characters know their places."""
    return joined([p for p in map(_paragraph, _blocks(text)) if p.text], "\n\n")


def _blocks(text: Traced) -> list[Traced]:
    """Paragraphs: a line break counts where a sentence ended before it or the line is empty."""
    plain = text.sub(_CHARACTER, lambda m: str(_CHARACTERS[ord(m[0])]))
    return plain.sub(_SPACE_AT_END, "\n").split(_PARAGRAPH)


_CHARACTER = re.compile(f"[{re.escape(''.join(map(chr, _CHARACTERS)))}]")
_SPACE_AT_END = re.compile(r"[ ]+\n")
_PARAGRAPH = re.compile(r"\n\s*\n|(?<=[.!?\"):])\n(?=\s*[A-Z\"])")


def _paragraph(block: Traced) -> Traced:
    once = _spell(block)
    for _ in range(4):
        again = _spell(once)
        if again.text == once.text:
            break
        once = again
    return once


def _spell(text: Traced) -> Traced:
    text = _spaces(text).sub(_TYPO, _mend_typo)
    for pattern, to in _PATTERNS:
        text = text.sub(pattern, to)
    text = text.sub(_MISREAD_ONE, "V1")
    text = text.sub(_LETTERED, lambda m: f"V{ord(m.group(1)) - ord('A') + 1}")
    text = text.sub(_VEHICLE_WORD, lambda m: f"V{NUMBERS[m.group(1).lower()]}")
    text = text.sub(_VEHICLE_CASE, r"V\1").sub(_COUNTED_LANE, _mend_lanes)
    return _spaces(text)


_MISREAD_ONE = re.compile(r"\bV[iIl]\b")
_SPACES: tuple[tuple[re.Pattern[str], str], ...] = tuple((re.compile(pattern), to) for pattern, to in (
    (r"\s+", " "), (r"\s*\.(?:\s*\.)+", "."),
    (r"\s+([,;.])(?=\s|$)", r"\1"),
    (r"(?<=[a-z\d)%\"])\.(?=[A-Z\"])|(?<=mph)\.(?=[A-Z])|(?<=MPH)\.(?=[A-Z])", ". "),
    (r"(?<=[A-Za-z)]),(?=[A-Za-z\d])", ", "),
    (r"(?<=[a-z\d)])\((?=\w)", " ("),
    (r"(?<=[\w)])\)(?=[A-Za-z\d])", ") "),
    (r" +", " "),
))  # fmt: skip


def _spaces(text: Traced) -> Traced:
    """Single spaces, one full stop at a time, a space behind it and behind commas."""
    for pattern, to in _SPACES:
        text = text.sub(pattern, to)
    return text.strip()


def _mend_typo(match: re.Match[str]) -> str:
    word = match.group(0)
    to = _TYPOS[word.lower()]
    return to.capitalize() if word[0].isupper() else to


def _mend_lanes(match: re.Match[str]) -> str:
    """ "4 lane", "four lane" -> "four-lane"; "one lane" is a noun and stays."""
    word = _WORDS.get(match.group(1), match.group(1).lower())
    return match.group(0) if word == "one" else f"{word}-lane"


# ------------------------------------------------------------------ sentences
_ABBREVIATION = re.compile(
    r"\b(?:approx|no|st|ave|rd|rt|rte|hwy|blvd|dr|mr|mrs|ms|jr|vs|etc|e\.g|i\.e|u\.s|a\.m|p\.m|lbs?|ft|min|hrs?|"
    r"yrs?|inc|co|"
    r"[A-Z])\.$", re.I)  # fmt: skip
_END = re.compile(r"(?<=[.!?])[\"')]*\s+(?=[\"'(]*[A-Z\d])")


def sentences(text: str) -> tuple[Sentence, ...]:
    """The sentences of a report as it was written, in order, with roles; vehicles without numbers get some."""
    return split_sentences(normalised(Traced.of(text)))


def split_sentences(text: Traced) -> tuple[Sentence, ...]:
    """The sentences of a normalized text."""
    found: list[Sentence] = []
    blocks = [block for block in number_vehicles(text).split(_BREAK) if block.text]
    for number, block in enumerate(blocks):
        for piece in _split(block):
            found.append(Sentence(piece.text, role_of(piece.text), len(found), number, *piece.span))
    return tuple(found)


_BREAK = re.compile("\n\n")


def _split(block: Traced) -> list[Traced]:
    pieces: list[Traced] = []
    for part in block.split(_END):
        last = pieces[-1].text if pieces else ""
        joins = pieces and _ABBREVIATION.search(last) and not last.lower().endswith((" dr.", " st."))
        if pieces and joins:
            pieces[-1] = joined([pieces[-1], part], " ")
        else:
            pieces.append(part)
    return [cut for piece in pieces for raw in _cut(piece) if (cut := raw.strip()).text]


_BEARABLE = re.compile(rf"(?s).{{1,{LONGEST}}}(?:\s|$)|.{{1,{LONGEST}}}")


def _cut(sentence: Traced) -> list[Traced]:
    """Pieces of bearable length: no report has such a sentence, and patterns take quadratic time on it."""
    if len(sentence.text) <= LONGEST:
        return [sentence]
    return [sentence.cut(m.start(), m.end()) for m in _BEARABLE.finditer(sentence.text)]
