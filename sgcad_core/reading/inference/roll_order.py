"""Which of its contacts a vehicle has behind it when it rolls over, as the order of the telling has it.

A pole that is told first and a curb "causing it to roll over" come before the roll; a tree that is struck "while
rolling" does not. Knows acts and their words; no plan.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.records.timeline import Act


def with_roll_order(crash: CrashFacts, acts: Sequence[Act], narrative: str) -> CrashFacts:
    """The crash with the number of contacts that each vehicle has before it rolls over; at least one."""
    rolls = {act.actor: act for act in acts if act.kind == "rolls_over" and act.start is not None}
    after = {who: max(1, _contacts_before(act, acts, narrative)) for who, act in rolls.items()}
    courses = {
        who: replace(course, rolls_after=after[who]) if course.rolls and who in after else course
        for who, course in crash.courses.items()
    }
    return replace(crash, courses=courses)


def _contacts_before(roll: Act, acts: Sequence[Act], narrative: str) -> int:
    """What else a vehicle is told to touch before its roll: other sentences by their place, its own by its words."""
    mine = {act.other: act for act in reversed(acts) if act.kind == "contact" and act.actor == roll.actor}
    return sum(_is_before(act, roll, narrative) for act in mine.values())


def _is_before(one: Act, roll: Act, narrative: str) -> bool:
    if one.start is None or roll.start is None or one.start != roll.start:
        return one.start is not None and roll.start is not None and one.start < roll.start
    said = narrative[roll.start : roll.end].lower()
    at, rolls = said.find(one.words.lower()), said.find(roll.words.lower())
    return 0 <= at < rolls
