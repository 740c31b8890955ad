"""The text of a crash report made uniform: one spelling per mention, unit and direction; sentences.

`normalised` is idempotent and changes spelling only: "Vehicle # 1", "vehicle one (V1 - case vehicle)" and
"V 1" all become "V1". Every character keeps its place in the text that was given. Knows no facts.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

from sgcad_core.reading.actors.numbered_walkers import called_by_word
from sgcad_core.reading.actors.part_numbers import number_the_rest
from sgcad_core.reading.actors.references import number_actors, number_cyclists, number_parked
from sgcad_core.reading.language import Rule, of_role, rule, values
from sgcad_core.reading.text.report_styles import in_third_person, named_in_full
from sgcad_core.reading.text.sentence_roles import CRASH_ROLES, Role, role_of
from sgcad_core.reading.text.traced_text import Fill, TracedText, joined
from sgcad_core.reading.text.typos import mended

__all__ = [
    "CRASH_ROLES",
    "NUMBERS",
    "Role",
    "Sentence",
    "normalised",
    "normalize",
    "number",
    "sentences",
    "split_sentences",
]
NUMBERS: dict[str, int] = values("number_word")
MOST_READ = 16_000
"""Characters of a report that are read, four times the longest known: the one limit that keeps any text bearable."""
_TAIL = 12
"""Characters at the end of a piece in which an abbreviation can stand."""
LONGEST = 1000
"""Characters of a sentence; the longest in published reports has about 650."""
_WORDS = {str(number): word for word, number in NUMBERS.items()}


def number(word: str) -> int:
    """3 for "3" and "three"; 1 for "a", "the" and "single"."""
    word = word.lower()
    return int(word) if word.isdigit() else NUMBERS.get(word, 1)


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
    "\u00c2": " ", "\u00c3": " ",  # what is left where a file was read in another encoding twice
})  # fmt: skip


# ------------------------------------------------------------------ mentions, units, directions


def normalize(text: str) -> str:
    """The same report with one spelling for mentions (V1), units (kmph, mph), directions and road words.

    Paragraphs stay apart ("\\n\\n"); everything else is single-spaced. normalize(normalize(t)) == normalize(t).
    """
    return normalised(TracedText.of(text)).text


def normalised(text: TracedText) -> TracedText:
    """`normalize` of a text whose characters know their places; only its first `MOST_READ` characters are read."""
    return joined([p for p in map(_paragraph, _blocks(text.cut(0, MOST_READ))) if p.text], "\n\n")


def _blocks(text: TracedText) -> list[TracedText]:
    """Paragraphs: a line break counts where a sentence ended before it or the line is empty."""
    plain = text.translate(_CHARACTERS)
    return plain.sub(rule("text.space_at_end"), "\n").split(rule("text.paragraph"))


def _paragraph(block: TracedText) -> TracedText:
    idle: Idle = {}
    once = _through(mended(_through(block, _spaces(), {})), _spelling(), idle)
    for _ in range(4):
        again = _through(once, _spelling(), idle)
        if again.text == once.text:
            break
        once = again
    return once


Step = tuple[Rule, str | Fill] | None
"""A rule and what is written for its matches; None: the spaces at either end go."""
Idle = dict[int, str]
"""By a step's number: a text that it leaves as it is. What comes again so is not looked at again."""


def _through(text: TracedText, steps: Sequence[Step], idle: Idle) -> TracedText:
    for place, step in enumerate(steps):
        if idle.get(place) == text.text:
            continue
        changed = text.sub(*step) if step else text.strip()
        if changed.text == text.text:
            idle[place] = text.text
        text = changed
    return text


@cache
def _spelling() -> tuple[Step, ...]:
    return (
        *_spaces(),
        (rule("text.typo"), _mend_typo),
        *((spelling, str(spelling.yields["to"])) for spelling in of_role("spelling")),
        (rule("text.spoken_speed"), lambda m: str(values("spoken_speed")[m.group().lower()])),
        (rule("text.first_vehicle"), "V1"),
        (rule("text.lettered"), lambda m: f"V{ord(m.group(1)) - ord('A') + 1}"),
        (rule("text.lettered_driver"), lambda m: f"the driver of V{ord(m.group(1)) - ord('A') + 1}"),
        (rule("text.vehicle_word"), lambda m: f"V{NUMBERS[m.group(1).lower()]}"),
        (rule("text.vehicle_case"), r"V\1"),
        (rule("text.counted_lane"), _mend_lanes),
        *_spaces(),
    )


@cache
def _spaces() -> tuple[Step, ...]:
    """Single spaces, one full stop at a time, a space behind it and behind commas."""
    return (
        (rule("common.space"), " "),
        (rule("text.full_stops"), "."),
        (rule("text.space_before_mark"), r"\1"),
        (rule("text.glued_sentence"), ". "),
        (rule("text.glued_comma"), ", "),
        (rule("text.glued_bracket"), " ("),
        (rule("text.glued_behind_bracket"), ") "),
        (rule("text.spaces"), " "),
        None,
    )


def _mend_typo(match: re.Match[str]) -> str:
    word = match.group(0)
    to: str = values("typo")[word.lower()]
    return to.capitalize() if word[0].isupper() else to


def _mend_lanes(match: re.Match[str]) -> str:
    """ "4 lane", "four lane" -> "four-lane"; "one lane" is a noun and stays."""
    word = _WORDS.get(match.group(1), match.group(1).lower())
    return match.group(0) if word == "one" else f"{word}-lane"


# ------------------------------------------------------------------ sentences


def sentences(text: str) -> tuple[Sentence, ...]:
    """The sentences of a report as it was written, in order, with roles; vehicles without numbers get some."""
    return split_sentences(normalised(TracedText.of(text)))


def split_sentences(text: TracedText) -> tuple[Sentence, ...]:
    """The sentences of a normalized text; actors without a number get one."""
    found: list[Sentence] = []
    full = named_in_full(in_third_person(called_by_word(text)))
    numbered = number_parked(number_cyclists(number_actors(number_the_rest(full))))
    numbered = numbered.sub(rule("text.mode_of_driving"), "")
    blocks = [block for block in numbered.split_at("\n\n") if block.text]
    for number, block in enumerate(blocks):
        for piece in _split(block):
            found.append(Sentence(piece.text, role_of(piece.text), len(found), number, *piece.span))
    return tuple(found)


def _split(block: TracedText) -> list[TracedText]:
    pieces: list[TracedText] = []
    for part in block.split(rule("text.end")):
        last = pieces[-1].text[-_TAIL:] if pieces else ""
        ended = last.lower().endswith((" dr.", " st.")) or rule("text.road_closed").search(last)
        titled = rule("text.title").search(last)
        joins = pieces and rule("text.abbreviation").search(last) and (titled or not ended)
        if pieces and joins:
            pieces[-1] = joined([pieces[-1], part], " ")
        else:
            pieces.append(part)
    return [cut for piece in pieces for raw in _cut(piece) if (cut := raw.strip()).text]


def _cut(sentence: TracedText) -> list[TracedText]:
    """Pieces of bearable length: no report has such a sentence, and patterns take quadratic time on it."""
    if len(sentence.text) <= LONGEST:
        return [sentence]
    return [sentence.cut(m.start(), m.end()) for m in rule("text.piece").finditer(sentence.text)]
