"""Sentences as words of features in which vehicles have parts instead of numbers, and directions depend on none."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple, cast

from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.text.compass import between, compass_of
from sgcad_core.reading.text.normalise import NUMBERS
from sgcad_core.records.specs import Compass

NEAR, FEW = 4, 10
"""Distance of pairs of words; numbers below this one may count lanes."""


class Token(NamedTuple):
    """A word, a vehicle's id, a compass point or a number."""

    kind: str
    text: str


class Said(NamedTuple):
    """A sentence in tokens."""

    number: int
    subject: str | None
    tokens: tuple[Token, ...]

    def about(self, vehicle: str) -> bool:
        """Whether it names the vehicle or speaks of it."""
        return self.subject == vehicle or Token("vehicle", vehicle) in self.tokens


def said_of(statements: Iterable[Statement]) -> tuple[Said, ...]:
    """The sentences that tell something, in tokens."""
    return tuple(Said(t.number, t.subject, tokens(t.text)) for t in statements if t.role != "formal")


def tokens(text: str) -> tuple[Token, ...]:
    """A text in tokens."""
    return tuple(_token(m.group()) for m in rule("wordings.token").finditer(text.lower()))


@lru_cache(maxsize=20_000)
def _token(word: str) -> Token:
    if word[0] == "v" and word[1:].isdigit():
        return Token("vehicle", word.upper())
    if word.isdigit() or word in NUMBERS:
        return Token("number", str(NUMBERS.get(word, word)))
    point = compass_of(word)
    return Token("compass", point) if point else Token("word", word)


class Voice(NamedTuple):
    """How tokens are shown: who is who, which way is D0, and whether small numbers are."""

    names: Mapping[str, str]
    ahead: Compass | None
    counts: bool = False

    def shown(self, some: Iterable[Token]) -> list[str]:
        """The tokens as words of features."""
        return [self._one(token) for token in some]

    def _one(self, token: Token) -> str:
        if token.kind == "vehicle":
            return self.names.get(token.text, "THIRD")
        if token.kind == "compass":
            return f"D{between(self.ahead, token.text)}" if self.ahead else "D"  # type: ignore[arg-type]
        if token.kind == "number":
            return f"#{token.text}" if self.counts and int(token.text) < FEW else "NUM"
        return token.text


def grams(said: Sequence[str], most: int) -> Iterator[str]:
    """One to so many words in a row."""
    for n in range(1, most + 1):
        for i in range(len(said) - n + 1):
            yield "_".join(said[i : i + n])


def pairs(said: Sequence[str], far: int = NEAR) -> Iterator[str]:
    """Two words in order with fewer than so many between them."""
    for i, one in enumerate(said):
        yield from (f"{one}~{other}" for other in said[i + 1 : i + 1 + far])


def first_way(said: Iterable[Said]) -> Compass | None:
    """The first compass point in some sentences."""
    found = next((token.text for one in said for token in one.tokens if token.kind == "compass"), None)
    return cast("Compass | None", found)
