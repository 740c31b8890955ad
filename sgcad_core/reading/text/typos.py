"""Typing errors mended: a word that no report uses becomes the one word of the rules that is one slip away.

A slip is a letter left out, put in, taken for another one, or two letters exchanged (Damerau's edits, as in Norvig,
"How to write a spelling corrector", 2007; found by the deletions of both words, as SymSpell does); or a space left
out between two words; or a digit for a letter that looks like it. `spelling.npz` (made by
`python -m research.training.readers.train_spelling POOL`) holds the words to mend towards, which all stand in the
language data, with how often reports use them, and hashes of all words that reports use, which stay, as do the words
of the class `kept_word`. Names stay: a word with a capital within a sentence is mended to a direction or a word for a
vehicle only. Knows no grammar.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from hashlib import blake2b
from pathlib import Path

import numpy as np

from sgcad_core.errors import ConfigError
from sgcad_core.reading.language import rule, words
from sgcad_core.reading.text.traced_text import TracedText

WEIGHTS = Path(__file__).with_name("spelling.npz")
SHORTEST = 4
"""Letters of a word to mend towards; the word itself may have one less."""
_SURER = 3.0
"""How many times oftener than the next one a word must be used to be taken."""
_KEPT = frozenset(words("kept_word"))
_LOOKALIKES = str.maketrans("0158", "olsb")


@dataclass(frozen=True)
class Spelling:
    """`targets`: word -> how many reports use it. `known`: hashes of words that reports use, sorted."""

    targets: Mapping[str, float]
    known: frozenset[int]
    _seen: dict[str, str | None] = field(default_factory=dict, repr=False, compare=False)

    def meant(self, word: str) -> str | None:
        """The word that is meant by one in small letters; None where it stays."""
        if word not in self._seen:
            self._seen[word] = self._mended(word)
        return self._seen[word]

    def _mended(self, word: str) -> str | None:
        if word in self.targets or word in _KEPT or hashed(word) in self.known:
            return None
        if not word.isalpha():
            letters = word.translate(_LOOKALIKES)
            return letters if letters in self.targets and len(letters) >= SHORTEST else None
        if len(word) < SHORTEST - 1:
            return None
        near = sorted(((self.targets[t], t) for t in set(self._near(word))), reverse=True)
        if near and (len(near) == 1 or near[0][0] >= _SURER * near[1][0]):
            return near[0][1]
        return None if near else self._parted(word)

    def _near(self, word: str) -> Iterator[str]:
        for key in {word, *deletions(word)}:
            for target in self._index.get(key, ()):
                if target[0] == word[0] and len(target) >= SHORTEST and one_slip(word, target):
                    yield target

    def _parted(self, word: str) -> str | None:
        """Two words that were written as one, the commoner of the rarer halves."""
        halves = [(min(self.targets[a], self.targets[b]), f"{a} {b}") for i in range(2, len(word) - 1)
                  if (a := word[:i]) in self.targets and (b := word[i:]) in self.targets]  # fmt: skip
        return max(halves)[1] if halves else None

    @cached_property
    def _index(self) -> Mapping[str, tuple[str, ...]]:
        found: dict[str, list[str]] = {}
        for target in self.targets:
            for key in {target, *deletions(target)}:
                found.setdefault(key, []).append(target)
        return {key: tuple(words) for key, words in found.items()}


def mended(text: TracedText) -> TracedText:
    """The text with typing errors mended, and capitals where sentences have none; every character keeps its place."""
    spelling = load()
    if not rule("typos.has_capitals").search(text.text):
        text = text.sub(rule("typos.small_sentence"), lambda m: m.group().upper())
    shouted = not any(c.islower() for c in text.text)
    return text.sub(rule("typos.word"), lambda m: _word(spelling, m, shouted))


def _word(spelling: Spelling, match: re.Match[str], shouted: bool) -> str:
    word = match.group()
    meant = spelling.meant(word.lower())
    if meant is None:
        return word
    inside = word[0].isupper() and not shouted and not rule("typos.begins").search(match.string, 0, match.start())
    if inside and not rule("typos.of_actor_or_way").fullmatch(meant):
        return word
    if word.isupper():
        return meant.upper()
    return meant.capitalize() if word[0].isupper() else meant


def deletions(word: str) -> set[str]:
    """The word without one of its letters, for each letter."""
    return {word[:i] + word[i + 1 :] for i in range(len(word))}


def one_slip(a: str, b: str) -> bool:
    """Whether one edit (insertion, deletion, substitution, transposition of neighbors) makes one word the other."""
    if abs(len(a) - len(b)) > 1 or a == b:
        return False
    i = next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    if len(a) != len(b):
        long, short = (a, b) if len(a) > len(b) else (b, a)
        return long[i + 1 :] == short[i:]
    return a[i + 1 :] == b[i + 1 :] or (a[i : i + 2] == b[i : i + 2][::-1] and a[i + 2 :] == b[i + 2 :])


def hashed(word: str) -> int:
    """A number of 32 bits for a word in small letters."""
    return int.from_bytes(blake2b(word.encode(), digest_size=4).digest(), "little")


def save(targets: Mapping[str, int], known: Iterable[str], file: Path) -> None:
    """Write the file of words."""
    hashes = np.array(sorted({hashed(word) for word in known}), dtype=np.uint32)
    counts = np.array(list(targets.values()), dtype=np.uint32)
    np.savez_compressed(file, targets=np.frombuffer(" ".join(targets).encode(), np.uint8), counts=counts, known=hashes)


@lru_cache(maxsize=2)
def load(file: Path = WEIGHTS) -> Spelling:
    """The words of a file. Raises ConfigError where it is missing or holds something else."""
    try:
        with np.load(file) as kept:
            targets = kept["targets"].tobytes().decode().split()
            counts = [float(n) for n in kept["counts"]]
            known = frozenset(int(n) for n in kept["known"])
        return Spelling(dict(zip(targets, counts, strict=True)), known)
    except (OSError, ValueError, KeyError) as fault:
        remedy = "make it with `python -m research.training.readers.train_spelling POOL`"
        raise ConfigError(f"{file}: is no file of words for mending typing errors ({fault}); {remedy}") from fault
