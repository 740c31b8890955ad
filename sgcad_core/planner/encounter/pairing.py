"""The search for the encounter of a declared contact, over the options of two actors.

Cheapest combinations first, until no remaining one can beat the best. Knows options and encounters, no other actors and
no world clock.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from heapq import nsmallest
from typing import NamedTuple

from sgcad_core.planner.actor_plan import Role, comes_against
from sgcad_core.planner.encounter.encounter_search import Meeting, find_meeting
from sgcad_core.planner.encounter.motion_options import Option
from sgcad_core.planner.encounter.out_of_lanes import OUT
from sgcad_core.records.specs import Area, Contact

GOOD = 1.95
"""Total cost below which no further stages are tried: less than a maneuver that is not visible."""
_CONTENT = 0.35
"""A contact is accepted at once where its own cost (place, clarity) is below this."""


class Encounter(NamedTuple):
    """The chosen options and their meeting."""

    first: Option
    second: Option
    meeting: Meeting

    @property
    def cost(self) -> float:
        """Oddity of the options and of the contact."""
        return self.first.cost + self.second.cost + self.meeting.cost


Ways = tuple[Sequence[Option], Sequence[Option]]


class Stage(NamedTuple):
    """Both actors' options, how many of their combinations are tried, and the total cost below which that is the last
    stage."""

    ways: Ways
    most: int
    enough: float = GOOD


Known = dict[tuple[Option, Option], Meeting | None]
"""Meetings of the combinations tried so far: later stages contain many of them again."""


def search(stages: Iterable[Stage], wanted: tuple[Area, Area] | None) -> Encounter | None:
    """The least odd encounter on the wanted sides; later stages are tried while there is no good one."""
    best: Encounter | None = None
    known: Known = {}
    for stage in stages:
        best = _best(_pairs(*stage.ways, stage.most), wanted, best, known)
        if best is not None and best.cost < stage.enough:
            break
    return best


def _best(
    pairs: Iterable[tuple[Option, Option]], wanted: tuple[Area, Area] | None, best: Encounter | None, known: Known
) -> Encounter | None:
    """The better of the encounter so far and those among some combinations, the cheapest combinations first."""
    for a, b in sorted(pairs, key=lambda pair: pair[0].cost + pair[1].cost):
        if best is not None and a.cost + b.cost >= best.cost:
            break
        if (a, b) not in known:
            known[a, b] = _meeting(a, b, wanted)
        found = known[a, b]
        if found is not None and (best is None or a.cost + b.cost + found.cost < best.cost):
            best = Encounter(a, b, found)
            if found.cost < _CONTENT:
                break
    return best


def _meeting(a: Option, b: Option, wanted: tuple[Area, Area] | None) -> Meeting | None:
    one, two = a.motion_with(b), b.motion_with(a)
    if not one.drivable or not two.drivable:
        return None
    glances = (a.role.glances and b.role.glances) or a.role.goes_on or b.role.goes_on
    spins, parts = (a.role.spins, b.role.spins), (part_of(a.role), part_of(b.role))
    found = find_meeting(one, two, wanted, spins, glances=glances, parts=parts if wanted else (None, None))
    return found if found is not None and found.cost < OUT else None


def part_of(role: Role) -> Area | None:
    """The part of its side at which an actor touches: of a told corner the flank, where its side is the end; the left
    one of a front that meets an oncoming front off center."""
    if role.told.offset and role.side == role.other_side == "front" and comes_against(role):
        return "left"
    if role.told.corner is None or role.side not in role.told.corner:
        return None
    end, flank = role.told.corner
    return flank if role.side == end else end


def _pairs(first: Sequence[Option], second: Sequence[Option], most: int) -> Iterator[tuple[Option, Option]]:
    """Combinations in the order of the product of their ranks: far entries of one list with the first of the other."""
    ranks = ((i, j) for i in range(min(len(first), most)) for j in range(min(len(second), most)))
    for i, j in nsmallest(most, ranks, key=lambda pair: ((pair[0] + 1) * (pair[1] + 1), pair)):
        yield first[i], second[j]


def cannot(contact: Contact, found: Encounter | None) -> str:
    """The note that a pair cannot touch as declared, and on which sides it meets in ordinary driving."""
    said = f"{contact.striker} and {contact.struck} cannot touch as declared in any driving"
    if found is None:
        return f"{said}: their ways never meet"
    sides = found.meeting.sides
    return f"{said}; as they drive, the {sides[0]} of {contact.striker} meets the {sides[1]} of {contact.struck}"
