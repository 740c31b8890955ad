"""Items of lists of lanes: what "two northbound through lanes" tells, noted behind its words while a report is written.

A list tells the lanes of an approach item by item, and where it ends its sentence has told a dozen numbers at once.
Whoever learns to read it is asked behind every item.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

USES = ("left", "through", "right")
MOST = 15
_FIRST, _KINDS = 0xF0000, 8 * len(USES) * (MOST + 1)
"""So many private-use letters from here on are the marks."""
MARKS = "".join(chr(_FIRST + number) for number in range(_KINDS))


@dataclass(frozen=True)
class Item:
    """So many lanes (0 to 15) with one use towards the hub, on the leg of a bearing (0 to 7)."""

    leg: int
    use: str
    lanes: int

    @property
    def mark(self) -> str:
        """The letter that stands behind its words until `Item.of` finds it."""
        return chr(_FIRST + (self.leg * len(USES) + USES.index(self.use)) * (MOST + 1) + min(self.lanes, MOST))

    @staticmethod
    def of(letter: str) -> Item | None:
        """The item that a letter marks."""
        number = ord(letter) - _FIRST
        if not 0 <= number < _KINDS:
            return None
        kind, lanes = divmod(number, MOST + 1)
        return Item(kind // len(USES), USES[kind % len(USES)], lanes)


def placed(text: str, ways: Mapping[int, str]) -> str:
    """A sentence without the marks of items that stand before the words for their way ("two lanes eastbound" may be
    asked for its leg, "two lanes and a left turn lane for eastbound traffic" may not); `ways`: those words by leg."""
    low = text.lower()
    begun = {leg: low.find(way.lower()) for leg, way in ways.items()}
    return "".join(
        letter
        for at, letter in enumerate(text)
        if not (item := Item.of(letter)) or item.leg not in begun or 0 <= begun[item.leg] < at
    )
