"""Many words as one pattern that is quick to refuse: words that begin alike are put together.

`re` tries the branches of an alternation one after another, at every place of a text. Branches that begin with other
letters exclude each other, so that they may change places; those that begin alike keep their order. So the pattern
matches what the plain alternation matches, and the same one of several words. Knows no language.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import groupby, takewhile

_FEW = 4
"""So few branches are tried as fast as a set of letters is looked at."""


def any_of(words: Iterable[str]) -> str:
    """A pattern, one group, for any of plain words: of those that match at a place the first one in their order.

    Words with capitals or letters beyond ASCII are left as they stand, since letters may be the same in another case.
    """
    return _any_of(tuple(dict.fromkeys(words)))


@lru_cache(maxsize=256)
def _any_of(words: tuple[str, ...]) -> str:
    plain = all(word.isascii() and word == word.lower() for word in words)
    return f"(?:{'|'.join(_branches(words) if plain else map(re.escape, words))})"


def _branches(words: Sequence[str]) -> Iterator[str]:
    """Branches of words; the empty word excludes none, and stays between those before and behind it."""
    if len(words) <= _FEW:
        yield from map(re.escape, words)
        return
    for some, run in groupby(words, key=bool):
        yield from _by_letter(list(run)) if some else ("",)


def _by_letter(words: Sequence[str]) -> Iterator[str]:
    groups: dict[str, list[str]] = {}
    for word in words:
        groups.setdefault(word[0], []).append(word)
    branches = [_together(group) for group in groups.values()]
    if len(groups) > _FEW:
        yield f"(?=[{''.join(map(re.escape, groups))}])(?:{'|'.join(branches)})"
    else:
        yield from branches


def _together(words: Sequence[str]) -> str:
    """Words that begin alike."""
    same = takewhile(lambda letters: len(set(letters)) == 1, zip(*words, strict=False))
    begun = "".join(letters[0] for letters in same)
    rest = [word[len(begun) :] for word in words]
    return re.escape(begun) + (f"(?:{'|'.join(_branches(rest))})" if len(rest) > 1 else "")
