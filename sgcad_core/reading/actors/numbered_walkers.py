"""People on foot and cyclists with a letter and a number ("P1, a pedestrian"), called by their words instead.

"The front of V1 struck P1" becomes "The front of V1 struck the pedestrian", which every later stage reads; a second one
becomes "the second pedestrian". P1 without a word for what it is stays: reports also letter passengers so.
"""

from __future__ import annotations

import re

from sgcad_core.reading.language import rule, values
from sgcad_core.reading.text.traced_text import TracedText


def called_by_word(text: TracedText) -> TracedText:
    """The normalized text with words for its numbered people; unchanged where it has none."""
    named = {(m["id"] or m["bracketed"]): m["word"] or m["noun"] for m in rule("walkers.lettered").finditer(text.text)}
    if named:
        name = rule("walkers.name").given(names=tuple(named))
        text = text.sub(name, lambda m: _phrase(m, named[m.group()], int(m.group()[-1])))
    return text.sub(rule("walkers.counted"), lambda m: _phrase(m, m["word"], int(m["number"])))


def _phrase(match: re.Match[str], word: str, number: int) -> str:
    """ "the pedestrian", the numbers above 1 with their ordinal; a capital where the text has one in front of it."""
    starts = match.start() == 0 or match.string[: match.start()].rstrip().endswith((".", "\n"))
    word = _FULL.get(word.lower(), word.lower())
    ordinal = f"{_ORDINALS[number]} " if number in _ORDINALS else ""
    return f"{'The' if starts else 'the'} {ordinal}{word}"


_FULL = {"ped": "pedestrian"}
_ORDINALS = {n: word for word, n in values("ordinal").items() if n > 1 and word.isalpha()}
