"""The text of a crash report made uniform: one spelling per mention, unit and direction; sentences.

`normalize` is idempotent and changes spelling only: "Vehicle # 1", "vehicle one (V1 - case vehicle)" and
"V 1" all become "V1". Knows no facts.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from sgcad_core.language import of_role, rule, values
from sgcad_core.narrative.roles import CRASH_ROLES, Role, role_of
from sgcad_core.narrative.unnumbered import number_vehicles

__all__ = ["CRASH_ROLES", "NUMBERS", "Role", "Sentence", "normalize", "sentences"]

NUMBERS: dict[str, int] = values("number_word")
LONGEST = 1000
"""Characters of a sentence; the longest in published reports has about 650."""
_WORDS = {str(number): word for word, number in NUMBERS.items()}


class Sentence(NamedTuple):
    """One normalized sentence, what it is for, and where it stands (both counted from 0)."""

    text: str
    role: Role
    number: int
    paragraph: int


# ------------------------------------------------------------------ characters
_CHARACTERS = str.maketrans({
    "\u2018": "'", "\u2019": "'", "\u201c": '"', "\u201d": '"', "\u2013": "-", "\u2014": " - ", "\u00a0": " ",
    "\ufffd": '"', "\u2032": "'", "\u2033": '"', "\t": " ", "\r": "\n", "\u00bd": " 1/2", "\u2022": " ", "\x0b": "\n",
    "\x0c": "\n", "\u2028": "\n", "\u2029": "\n", "\x85": "\n",
})  # fmt: skip

_TYPO = rule("text.typo")


# ------------------------------------------------------------------ mentions, units, directions

_LETTERED = rule("text.lettered")
_VEHICLE_WORD = rule("text.vehicle_word")
_VEHICLE_CASE = rule("text.vehicle_case")
_COUNTED_LANE = rule("text.counted_lane")


def normalize(text: str) -> str:
    """The same report with one spelling for mentions (V1), units (kmph, mph), directions and road words.

    Paragraphs stay apart ("\\n\\n"); everything else is single-spaced. normalize(normalize(t)) == normalize(t).
    """
    return "\n\n".join(filter(None, (_paragraph(block) for block in _blocks(text))))


def _blocks(text: str) -> list[str]:
    """Paragraphs: a line break counts where a sentence ended before it or the line is empty."""
    text = rule("text.space_at_end").sub("\n", text.translate(_CHARACTERS))
    return rule("text.paragraph").split(text)


def _paragraph(block: str) -> str:
    once = _spell(block)
    for _ in range(4):
        again = _spell(once)
        if again == once:
            break
        once = again
    return once


def _spell(text: str) -> str:
    text = _spaces(text)
    text = _TYPO.sub(_mend_typo, text)
    for spelling in of_role("spelling"):
        text = spelling.sub(spelling.yields["to"], text)
    text = rule("text.first_vehicle").sub("V1", text)
    text = _LETTERED.sub(lambda m: f"V{ord(m.group(1)) - ord('A') + 1}", text)
    text = _VEHICLE_WORD.sub(lambda m: f"V{NUMBERS[m.group(1).lower()]}", text)
    text = _VEHICLE_CASE.sub(r"V\1", text)
    text = _COUNTED_LANE.sub(_mend_lanes, text)
    return _spaces(text)


def _spaces(text: str) -> str:
    """Single spaces, one full stop at a time, a space behind it and behind commas."""
    text = rule("text.full_stops").sub(".", rule("common.space").sub(" ", text))
    text = rule("text.space_before_mark").sub(r"\1", text)
    text = rule("text.glued_sentence").sub(". ", text)
    text = rule("text.glued_comma").sub(", ", text)
    text = rule("text.glued_bracket").sub(" (", text)
    text = rule("text.glued_behind_bracket").sub(") ", text)
    return rule("text.spaces").sub(" ", text).strip()


def _mend_typo(match: re.Match[str]) -> str:
    word = match.group(0)
    to: str = values("typo")[word.lower()]
    return to.capitalize() if word[0].isupper() else to


def _mend_lanes(match: re.Match[str]) -> str:
    """ "4 lane", "four lane" -> "four-lane"; "one lane" is a noun and stays."""
    word = _WORDS.get(match.group(1), match.group(1).lower())
    return match.group(0) if word == "one" else f"{word}-lane"


# ------------------------------------------------------------------ sentences
_ABBREVIATION = rule("text.abbreviation")
_END = rule("text.end")


def sentences(text: str) -> tuple[Sentence, ...]:
    """The report's sentences in order, normalized, with roles; vehicles without numbers get some."""
    found: list[Sentence] = []
    for number, block in enumerate(filter(None, number_vehicles(normalize(text)).split("\n\n"))):
        for piece in _split(block):
            found.append(Sentence(piece, role_of(piece), len(found), number))
    return tuple(found)


def _split(block: str) -> list[str]:
    pieces: list[str] = []
    for part in _END.split(block):
        joins = pieces and _ABBREVIATION.search(pieces[-1]) and not pieces[-1].lower().endswith((" dr.", " st."))
        if pieces and joins:
            pieces[-1] += " " + part
        else:
            pieces.append(part)
    return [cut.strip() for piece in pieces for cut in _cut(piece) if cut.strip()]


def _cut(sentence: str) -> list[str]:
    """Pieces of bearable length: no report has such a sentence, and patterns take quadratic time on it."""
    if len(sentence) <= LONGEST:
        return [sentence]
    return rule("text.piece").findall(sentence)
