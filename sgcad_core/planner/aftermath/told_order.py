"""The contacts of a scene in the order in which the report tells them, as far as they come about.

Knows touches of a settled scene; not how contacts are arranged.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from sgcad_core.planner.aftermath.second_contact import sides_missed
from sgcad_core.planner.aftermath.wreck_bodies import Touch
from sgcad_core.planner.motion import STEP_S
from sgcad_core.planner.scene import Scene
from sgcad_core.records.specs import Area, Contact

Pair = frozenset[str]


def pair_of(contact: Contact) -> Pair:
    """The two actors of a contact, in no order."""
    return frozenset((contact.striker, contact.struck))


def other_of(contact: Contact, partner: str) -> tuple[str, tuple[Area, Area]]:
    """The other actor of a contact, and the sides of the partner and of the other one."""
    if partner == contact.striker:
        return contact.struck, (contact.striker_area, contact.struck_area)
    return contact.striker, (contact.struck_area, contact.striker_area)


def touched(touch: Touch) -> Pair:
    """The two of a touch, in no order."""
    return frozenset((touch.first, touch.second))


def met_in_order(touches: Sequence[Touch], pairs: Iterable[Pair]) -> list[Touch | None]:
    """The first touch of each pair behind that of the pair before it; None where there is none."""
    found: list[Touch | None] = []
    rest = list(touches)
    for pair in pairs:
        at = next((n for n, touch in enumerate(rest) if touched(touch) == pair), None)
        found.append(None if at is None else rest[at])
        rest = rest if at is None else rest[at + 1 :]
    return found


@dataclass
class ToldOrder:
    """The told contacts that came about so far. `expected`: all pairs whose touches are told."""

    scene: Scene
    expected: frozenset[Pair]
    pairs: list[Pair] = field(default_factory=list)
    arranged: list[Contact] = field(default_factory=list)
    """Further contacts of vehicles that were brought about, with their sides."""

    @property
    def after(self) -> int:
        """The sample of the last of them; that of the first contact where none came about."""
        met = [touch for touch in met_in_order(self.scene.touches, self.pairs) if touch]
        return math.ceil(met[-1].t_s / STEP_S) if met else self.scene.contact

    @property
    def kept(self) -> bool:
        """Whether all of them still come about, in order."""
        return self.holds()

    @property
    def sides_missed(self) -> int:
        """The number of stated sides on which the arranged contacts do not come about."""
        return sum(sides_missed(self.scene, contact) for contact in self.arranged)

    def holds(self, *more: Pair) -> bool:
        """Whether they, and then more pairs, come about in order in the scene as it is settled."""
        return None not in met_in_order(self.scene.touches, (*self.pairs, *more))

    @property
    def untold(self) -> int:
        """The number of pairs that touch and are not told to."""
        return len({touched(touch) for touch in self.scene.touches} - self.expected)
