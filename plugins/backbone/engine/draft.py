"""Guesses at what comes next, taken from an earlier answer: a repair repeats most of it.

Guessed tokens are fed together and kept as far as the decoder picks the same ones, so they change the speed
and never the answer. Knows token ids only.
"""

from __future__ import annotations

from collections.abc import Sequence

_LONGEST = 64
_SHORTEST = 2
_CLUE = 3
"""How many tokens must agree before the place in the earlier answer counts as found."""


class Draft:
    """A place in an earlier answer that follows the new one, and how far to trust it."""

    def __init__(self, earlier: Sequence[int]) -> None:
        self.earlier = list(earlier)
        self.at = 0
        self.length = 16
        self.recent: list[int] = []

    def guess(self, limit: int) -> list[int]:
        """The next tokens, at most `limit`."""
        return self.earlier[self.at : self.at + min(self.length, max(0, limit))]

    def note(self, token: int) -> None:
        """A token of the new answer: follow it, or look for the place anew after a difference."""
        self.recent = [*self.recent[-(_CLUE - 1) :], token]
        if self.at < len(self.earlier) and self.earlier[self.at] == token:
            self.at += 1
        else:
            self.at = self._found() or min(self.at + 1, len(self.earlier))

    def judge(self, guessed: int, right: int) -> None:
        """Guess further after success, less far after failure."""
        if guessed:
            self.length = min(2 * self.length, _LONGEST) if right == guessed else max(right + 1, _SHORTEST)

    def _found(self) -> int | None:
        """Behind the occurrence of the last tokens that is nearest to the present place."""
        if len(self.recent) < _CLUE:
            return None
        ends = [i + _CLUE for i in range(len(self.earlier) - _CLUE + 1) if self.earlier[i : i + _CLUE] == self.recent]
        return min(ends, key=lambda end: abs(end - self.at), default=None)
