"""The small language in which phrases are written: `[a|b|c]` chooses, `{slot}` is filled.

Choices may nest. Filling a slot is reported, so that the caller knows which facts the text told; labels of a phrase
(`phrase_labels`) stay in it until it is filled.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from random import Random

from research.generator.phrase_labels import plain
from research.generator.phrase_notes import MARKS, name_of
from research.generator.records import SLOTS, Group

_CHOICE = re.compile(r"\[([^\[\]]*)\]")
Fill = Callable[[str], str]


_NUMBERED = re.compile(r"\bthe (lane (?:one|two|three|four|five|\d)\b)")
_ARTICLE = re.compile(r"\b([Aa]) (?=(?:[aeioAEIO]|8|11\b|18\b|un(?!i)|urb)(?!ne\b|nce|eu))")
"""`a` before a vowel, which fillings and choices bring together; not before "one" or "unit"."""


def choose(rng: Random, clause: str) -> str:
    """Resolve every `[a|b]`, innermost first."""
    while True:
        found = _CHOICE.search(clause)
        if not found:
            return clause
        chosen = rng.choice(found[1].split("|"))
        clause = clause[: found.start()] + chosen + clause[found.end() :]


def clause_of(rng: Random, options: Group | Sequence[str], held_out: bool) -> str:
    """One clause of a side of the split, or of those chosen before, its choices made."""
    return choose(rng, rng.choice(sided(options, held_out)))


def sided(options: Group | Sequence[str], held_out: bool) -> Sequence[str]:
    """The clauses of a side of the split; of those chosen before all."""
    return options.side(held_out) if isinstance(options, Group) else options


def fill(clause: str, slot: Fill) -> str:
    """Put slot values in, take the labels out and tidy the spaces."""
    text = SLOTS.sub(lambda m: slot(m[1]), plain(clause))
    text = re.sub(r" +", " ", text)
    text = re.sub(r" ([,.;])", r"\1", text)
    text = re.sub(r",+(?=[,.;:]|'s\b)", "", text)
    text = _NUMBERED.sub(r"\1", text)
    return _ARTICLE.sub(r"\1n ", text).strip()


MARK = 0xE000
"""Private-use letters from here on stand behind the sentences of a report while it is written."""
_MARKED = re.compile(f"[{chr(MARK)}-{chr(MARK + 0x18FF)}{MARKS}]+")


HINT = "~"
"""First letter of notes on how a sentence is built, which tell nothing of the crash."""


class StatedFacts(set[str]):
    """Facts that a text told; `take` hands out those of one sentence, repeated ones too."""

    def __init__(self) -> None:
        super().__init__()
        self._fresh: set[str] = set()

    def add(self, fact: str) -> None:
        """Note one fact."""
        super().add(fact)
        self._fresh.add(fact)

    def __ior__(self, facts: Iterable[str]) -> StatedFacts:  # type: ignore[override, misc]
        """Note several."""
        for fact in facts:
            self.add(fact)
        return self

    def take(self) -> frozenset[str]:
        """Facts noted since the last call."""
        fresh, self._fresh = frozenset(self._fresh), set()
        return fresh


@dataclass
class Written:
    """A narrative, where each of its sentences ends and which facts it tells, and where each noted phrase ends."""

    narrative: str = ""
    sentences: list[tuple[int, frozenset[str]]] = field(default_factory=list)
    notes: list[tuple[int, list[str]]] = field(default_factory=list)


def unmark(text: str) -> tuple[str, list[tuple[int, int]], list[tuple[int, list[str]]]]:
    """A text without its marks, (end, number) of every marked sentence and (end, names) of every noted phrase."""
    marks: list[tuple[int, int]] = []
    notes: dict[int, list[str]] = {}
    size = end = 0
    out: list[str] = []
    for run in _MARKED.finditer(text):
        out.append(text[end : run.start()])
        size, end = size + run.start() - end, run.end()
        for letter in run[0]:
            if name := name_of(letter):
                notes.setdefault(size, []).append(name)
            else:
                marks.append((size, ord(letter) - MARK))
    return "".join([*out, text[end:]]), marks, list(notes.items())


def sentence(text: str) -> str:
    """First letter large, one full stop at the end."""
    text = text.strip().rstrip(",")
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "!", "?")) else text + "."
