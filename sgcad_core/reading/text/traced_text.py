"""Text that remembers, character by character, where it was written: edits keep the place in the original.

`TracedText` has the few operations that normalising needs (sub, split, strip, slice, join) with the results of `re` and
`str`. Places are offsets in the text that `TracedText.of` was given. Knows no crash and no language.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

from sgcad_core.reading.language import Rule

Pattern = re.Pattern[str] | Rule
Fill = Callable[["re.Match[str]"], str]


class TracedText(NamedTuple):
    """Text; character i was written at [starts[i], ends[i]) (a character that was put in: where it was put)."""

    text: str
    starts: Sequence[int]
    ends: Sequence[int]

    @staticmethod
    def of(text: str) -> TracedText:
        """A text as it was written."""
        return TracedText(text, range(len(text)), range(1, len(text) + 1))

    def cut(self, start: int, end: int) -> TracedText:
        """The characters [start, end)."""
        return TracedText(self.text[start:end], self.starts[start:end], self.ends[start:end])

    @property
    def span(self) -> tuple[int, int]:
        """Where the first character begins and the last one ends; (0, 0) of nothing."""
        return (self.starts[0], self.ends[-1]) if self.text else (0, 0)

    def sub(self, pattern: Pattern, to: str | Fill, count: int = 0) -> TracedText:
        """`pattern.sub(to, text, count)`; of a match only what really changes loses its own place."""
        found = _matches(pattern, self.text, count)
        if isinstance(to, str) and "\\" not in to:  # every space of a text
            edits = [(m.start(), m.end(), to) for m in found if m[0] != to]
        else:
            fill = _filling(to) if isinstance(to, str) else to
            edits = [(m.start(), m.end(), new) for m in found if (new := fill(m)) != m[0]]
        return self._edited(edits) if edits else self

    def _edited(self, edits: Iterable[tuple[int, int, str]]) -> TracedText:
        text, starts, ends, at = [], list[int](), list[int](), 0
        for begin, end, new in edits:
            begin, end, new = _trimmed(self.text, begin, end, new)
            text += [self.text[at:begin], new]
            starts += self.starts[at:begin]
            ends += self.ends[at:begin]
            first, last = self._between(begin, end)
            starts += [first] * len(new)
            ends += [last] * len(new)
            at = end
        starts += self.starts[at:]
        ends += self.ends[at:]
        return TracedText("".join([*text, self.text[at:]]), starts, ends)

    def _between(self, begin: int, end: int) -> tuple[int, int]:
        """Where the characters [begin, end) stand; of none, the point between their neighbours, or what these share."""
        if end > begin:
            return self.starts[begin], self.ends[end - 1]
        if not begin:
            first = self.starts[0] if self.text else 0
            return first, first
        before = self.ends[begin - 1]
        return min(before, self.starts[begin] if begin < len(self.text) else before), before

    def split(self, pattern: Pattern) -> list[TracedText]:
        """`pattern.split(text)` of a pattern without groups."""
        found, at = [], 0
        for match in pattern.finditer(self.text):
            found.append(self.cut(at, match.start()))
            at = match.end()
        return [*found, self.cut(at, len(self.text))]

    def split_at(self, mark: str) -> list[TracedText]:
        """`text.split(mark)`."""
        found, at = [], 0
        for piece in self.text.split(mark):
            found.append(self.cut(at, at + len(piece)))
            at += len(piece) + len(mark)
        return found

    def translate(self, table: Mapping[int, str]) -> TracedText:
        """`text.translate(table)` of a table of characters' numbers."""
        edits = [(i, i + 1, table[ord(c)]) for i, c in enumerate(self.text) if ord(c) in table]
        return self._edited(edits) if edits else self

    def strip(self, characters: str | None = None) -> TracedText:
        """`text.strip(characters)`."""
        begin = len(self.text) - len(self.text.lstrip(characters))
        return self.cut(begin, max(begin, len(self.text.rstrip(characters))))


def joined(parts: Sequence[TracedText], glue: str = "") -> TracedText:
    """`glue.join(parts)`; the glue stands between its neighbours."""
    text, starts, ends = [], list[int](), list[int]()
    for number, part in enumerate(parts):
        if number and glue:
            text.append(glue)
            starts += [ends[-1] if ends else 0] * len(glue)
            ends += [part.starts[0] if part.text else starts[-1]] * len(glue)
        text.append(part.text)
        starts += part.starts
        ends += part.ends
    return TracedText("".join(text), starts, ends)


Runs = tuple[tuple[int, int, int], ...]
"""(begins here, begins there, ends there) of stretches of text up to the next; equally long ones are letter by letter
the same."""


def runs(text: TracedText) -> Runs:
    """Where a text stands in the one it was made of, in few words; () if it is the very same so far as it goes.

    A character goes on letter by letter, or belongs to the same edit as the one before it.
    """
    found: list[tuple[int, int, int]] = []
    begin = there = last = -1
    for here, (start, end) in enumerate(zip(text.starts, text.ends, strict=True)):  # long texts: nothing is called here
        verbatim = start == last and end == start + 1 and last - there == here - begin
        if (verbatim or (start == there and end == last)) and begin >= 0:
            last = end
            continue
        if begin >= 0:
            found.append((begin, there, last))
        begin, there, last = here, start, end
    if begin >= 0:
        found.append((begin, there, last))
    return () if found[1:] == [] and (not found or found[0] == (0, 0, len(text.text))) else tuple(found)


def placed(text: str, where: Runs) -> TracedText:
    """The text whose `runs` are known."""
    if not where:
        return TracedText.of(text)
    starts, ends = list[int](), list[int]()
    for (here, there, last), (then, _, _) in zip(where, (*where[1:], (len(text), 0, 0)), strict=True):
        same = then - here == last - there
        starts += range(there, last) if same else [there] * (then - here)
        ends += range(there + 1, last + 1) if same else [last] * (then - here)
    return TracedText(text, starts, ends)


SPACES = 2
"""So few characters that are left out are spaces."""


def redactions(where: Runs) -> list[dict[str, int]]:
    """Places of a text at which others words were written, of its `runs`: [start, end) here (empty: words were left
    out) and how many characters stood there."""
    found: list[dict[str, int]] = []
    last = 0
    behind = (*where[1:], (-1, 0, 0)) if where else ()
    for (here, there, end), (then, _, _) in zip(where, behind, strict=True):
        if here and there - last > SPACES:  # what stands before the first character is space
            found.append({"start": here, "end": here, "removed": there - last})
        if then >= 0 and then - here != end - there:
            found.append({"start": here, "end": then, "removed": end - there})
        last = end
    return found


def shown(text: TracedText, start: int, end: int) -> tuple[int, int]:
    """Where in an edited text that stands which was written at [start, end); empty if nothing of it is left."""
    first, last = bisect_right(text.ends, start), bisect_left(text.starts, end)
    return first, max(first, last)


def _matches(pattern: Pattern, text: str, count: int) -> Iterable[re.Match[str]]:
    found = pattern.finditer(text)
    return found if not count else (m for m, _ in zip(found, range(count), strict=False))


def _trimmed(text: str, begin: int, end: int, new: str) -> tuple[int, int, str]:
    """A replacement without the characters that it leaves alone at either end."""
    while begin < end and new and text[begin] == new[0]:
        begin, new = begin + 1, new[1:]
    while begin < end and new and text[end - 1] == new[-1]:
        end, new = end - 1, new[:-1]
    return begin, end, new


@lru_cache(maxsize=512)
def _filling(template: str) -> Fill:
    r"""What a template of `re.sub` with \1 to \9 makes of a match; other escapes are not understood."""
    first, *further = template.split("\\")
    plain, groups = [first, *(part[1:] for part in further)], [int(part[0]) for part in further]

    def fill(match: re.Match[str]) -> str:
        made = [plain[0]]
        for group, behind in zip(groups, plain[1:], strict=True):
            made += [match[group] or "", behind]
        return "".join(made)

    return fill
