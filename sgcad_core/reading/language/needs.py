"""What a text must hold for a pattern to match in it: words, one of which stands in every match.

`told_by` finds them in the pattern's syntax tree, as the prefilters of RE2 and codesearch do (Cox, "Regular Expression
Matching with a Trigram Index", 2012). A text that `lacks` them all has no match, which is told in a fraction of the
time. Knows no rule.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from math import prod
from re import _parser  # type: ignore[attr-defined]
from typing import Any

Words = frozenset[str]
Needs = tuple[Words, ...]
"""Sets of texts in small letters: a match holds one of each."""
Told = tuple[Words | None, Needs]
"""All that a piece of a pattern matches in full (None: not to be listed), and what its matches hold besides."""
UNKNOWN: Told = (None, ())

_MOST = 64
"""Texts that a piece is listed as; one with more is cut before the next piece."""
_CHARACTERS = 10
_NOTHING: Words = frozenset({""})
_ASCII = 128
_SLOTS = 0xF0000
"""Characters of private use."""
_ODD = (("\u0130", "i"), ("\u0131", "i"), ("\u017f", "s"), ("\u212a", "k"))
"""Characters beyond ASCII that `re` takes for letters of ASCII where capitals do not matter."""
_LETTERS = " etaoinsrhldcumfpgwybvkxjqz"
"""Of English texts, the commonest first."""
_SHARE = {letter: 1 / (rank + 5) for rank, letter in enumerate(_LETTERS)}


# ------------------------------------------------------------------ texts
def lacks(text: str, words: Sequence[str]) -> bool:
    """Whether a text has none of some words in small letters, in whatever case; never if there are none."""
    low = _low_of_short(text) if len(text) < _SHORT else _low_of_long(text)
    for word in words:  # a loop, since `any` takes twice the time
        if word in low:
            return False
    return bool(words)


def _low(text: str) -> str:
    if not text.isascii():
        for odd, letter in _ODD:
            text = text.replace(odd, letter)
    return text.lower()


_SHORT = 2000
"""Characters of a text. The last texts of either kind are kept."""
_low_of_short = lru_cache(maxsize=1024)(_low)
_low_of_long = lru_cache(maxsize=4)(_low)


# ------------------------------------------------------------------ patterns
def needs_of(told: Told) -> tuple[str, ...]:
    """Words in small letters, one of which is in every text with a match, the commonest first; none if not known."""
    exact, more = told
    found = min((*more, *_closed(exact)), key=_commonness, default=frozenset[str]())
    fewer = found if len(found) > _MOST else {word for word in found if not _holds_another(word, found)}
    return tuple(sorted(fewer, key=_share, reverse=True))


def _holds_another(word: str, words: Words) -> bool:
    return any(other in word and other != word for other in words)


def told_by(pattern: str, slots: Sequence[Told] = ()) -> Told:
    """What a pattern tells of its matches; the character `slot(n)` in it stands for `slots[n]`."""
    return _sequence(_parser.parse(pattern), slots)


def slot(number: int) -> str:
    """The character that stands for a slot in a pattern."""
    return chr(_SLOTS + number)


def told_by_words(words: Iterable[str]) -> Told:
    """What any of plain words tells."""
    low = frozenset(word.lower() for word in words)
    return (low, ()) if all(map(str.isascii, low)) else UNKNOWN


def told_by_any(branches: Sequence[Told]) -> Told:
    """Of an alternation: what one branch needs is needed only if every other needs something too."""
    listed = [exact for exact, _ in branches if exact is not None]
    if len(listed) == len(branches):
        return frozenset[str]().union(*listed), ()
    needs = [(*more, *_closed(exact)) for exact, more in branches]
    return (None, (frozenset[str]().union(*(min(n, key=_commonness) for n in needs)),)) if all(needs) else UNKNOWN


@lru_cache(maxsize=4096)
def _share(word: str) -> float:
    """How common a word may be, by its letters."""
    return prod(_SHARE.get(character, 0.03) for character in word)


def _commonness(words: Iterable[str]) -> float:
    return sum(map(_share, words))


def _closed(exact: Words | None) -> Needs:
    return (exact,) if exact and "" not in exact else ()


def _sequence(items: Iterable[tuple[Any, Any]], slots: Sequence[Told]) -> Told:
    """Of pieces one behind another; listed texts that stand side by side are put together."""
    now, whole, needs = _NOTHING, True, list[Words]()
    for kind, value in items:
        exact, more = _piece(str(kind), value, slots)
        needs += more
        if exact is not None and len(now) * len(exact) <= _MOST:
            now = frozenset(a + b for a in now for b in exact) if exact is not _NOTHING else now
            continue
        needs += _closed(now)
        short = exact is not None and len(exact) <= _MOST
        needs += () if short else _closed(exact)
        now, whole = exact if short and exact else _NOTHING, False
    return (now, tuple(needs)) if whole else (None, (*needs, *_closed(now)))


def _piece(kind: str, value: Any, slots: Sequence[Told]) -> Told:
    """Of a node of the tree. Every text is taken for possible where a kind is not known."""
    asked = _KINDS.get(kind)
    return asked(value, slots) if asked else UNKNOWN


def _ahead(value: Any, slots: Sequence[Told]) -> Told:
    exact, more = _sequence(value[1], slots)
    return _NOTHING, (*more, *_closed(exact))


def _repeated(value: Any, slots: Sequence[Told]) -> Told:
    least, most, item = value
    exact, more = _sequence(item, slots)
    if least == most == 1:
        return exact, more
    if least:
        return None, (*more, *_closed(exact))
    return (exact | _NOTHING if most == 1 and exact is not None else None), ()


def _literal(value: int, slots: Sequence[Told]) -> Told:
    if value >= _SLOTS:
        return slots[value - _SLOTS] if value - _SLOTS < len(slots) else UNKNOWN
    return (frozenset({chr(value).lower()}), ()) if value < _ASCII else UNKNOWN


def _set(value: Any, slots: Sequence[Told]) -> Told:
    """Of a set of few characters, each with a branch of its own: `re` makes sets of alternations too."""
    found = list[int]()
    for kind, of in value:
        first, last = of if str(kind) == "RANGE" else (of, of)
        if str(kind) not in ("LITERAL", "RANGE") or last - first >= _CHARACTERS:
            return UNKNOWN
        found += range(first, last + 1)
    return told_by_any([_literal(number, slots) for number in found]) if len(found) <= _CHARACTERS else UNKNOWN


_KINDS: dict[str, Callable[[Any, Sequence[Told]], Told]] = {
    "AT": lambda _value, _slots: (_NOTHING, ()),
    "ASSERT_NOT": lambda _value, _slots: (_NOTHING, ()),
    "ASSERT": _ahead,
    "LITERAL": _literal,
    "IN": _set,
    "BRANCH": lambda value, slots: told_by_any([_sequence(branch, slots) for branch in value[1]]),
    "SUBPATTERN": lambda value, slots: _sequence(value[3], slots),
    "ATOMIC_GROUP": _sequence,
    "MAX_REPEAT": _repeated,
    "MIN_REPEAT": _repeated,
    "POSSESSIVE_REPEAT": _repeated,
}
