"""Notes behind phrases: the actor of a mention or of a named side, the lanes of an item of a list or of a road.

While a report is written, marks stand behind the words of such phrases; taken out again they say where each ends and
what it tells, in whatever sentence it stands. A list tells the lanes of an approach item by item, and a clause that
never trained speaks of "the nose of V2" as every other does: the model is asked there. Phrases within
codes and statements have no notes.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Mapping
from itertools import pairwise

from research.generator.crash.world import Actor
from research.generator.phrase_labels import has
from research.generator.records import slots_of
from research.model.answer_grammar import AREAS

IDS = ("V1", "V2", "V3", "V4", "P1", "B1", "O1")
USES = ("left", "through", "right")
MOST = 8
"""Lanes that an item can tell."""
PLACES = ("first", "second")
"""Of roads whose lanes a report tells, in its order."""


def _names() -> list[str]:
    names = [f"leg={b}" for b in range(8)] + [f"use={use}" for use in USES] + [f"lanes={n}" for n in range(MOST + 1)]
    names += [f"id={i}" for i in IDS] + [f"{i}.area={a}" for i in IDS if i.startswith("V") for a in AREAS]
    names += [f"heading={b}" for b in range(8)]
    return names + [f"road={place}" for place in PLACES] + [f"each={n}" for n in range(1, MOST + 1)] + ["ways=one"]


_ASKED = _names()
ASKED = len(_ASKED)
"""So many notes, the first, are asked at the ends of their phrases. The others only say where a value is told: how a
road lies may stand in a later sentence."""
NOTES = {name: index for index, name in enumerate([*_ASKED, *(f"axis={a}" for a in range(4))])}
_FIRST = 0xF0000
"""Private-use letters from here on are the marks, one for every name of `NOTES`."""
_NAMES = {chr(_FIRST + index): name for name, index in NOTES.items()}
MARKS = "".join(_NAMES)
_RUN = re.compile(f"[{MARKS}]+")
_LEGS = {chr(_FIRST + NOTES[f"leg={b}"]): b for b in range(8)}
_TAIL = re.compile(r"[\s,.;:]*$")
_ONE, _OTHER = ("V", "Vf", "Vi", "S", "sa"), ("W", "T", "ta")
"""Slots of the one that a clause is about and of the other."""
OWNERS = {"sa": "S", "ta": "T"}
"""Slots of sides and of those whose sides they are."""


def noted(text: str, names: Iterable[str]) -> str:
    """A phrase with marks behind its words, before what punctuation it ends with; `names` are of `NOTES`."""
    marks = "".join(chr(_FIRST + NOTES[name]) for name in names)
    tail = _TAIL.search(text)
    end = tail.start() if tail else len(text)
    return text[:end] + marks + text[end:] if end else text


def item(text: str, leg: int, use: str, count: int) -> str:
    """An item of a list with its note: so many lanes with one use, on the way of traffic from the leg of a bearing,
    whether there is such a leg or not; "through" where no use is said."""
    return noted(text, (f"leg={leg}", f"use={use}", f"lanes={min(count, MOST)}", f"heading={(leg + 4) % 8}"))


def road(text: str, place: int, axis: int, each: int, one_way: bool) -> str:
    """A phrase for a road with its note: the first or second (`place`, from 0) whose lanes a report tells; `each`:
    lanes of each way in which it is driven, 0 where they differ or its phrase leaves them open."""
    names = [f"road={PLACES[place]}"]
    if each:
        names += [f"each={min(each, MOST)}", f"axis={axis}"] + ["ways=one"] * one_way
    return noted(text, names)


def name_of(letter: str) -> str | None:
    """What a letter marks; None for letters of the text."""
    return _NAMES.get(letter)


def placed(text: str, ways: Mapping[int, str]) -> str:
    """A sentence in which both ways of a road have lists, without the notes of items that cannot be told yet from those
    of the other way: behind "eastbound traffic has" they can, before "for eastbound traffic" they cannot. Behind
    "eastbound and westbound traffic have" only those of the way that is named last can. `ways`: by leg, the words for
    its way."""
    low = text.lower()

    def kept(run: re.Match[str]) -> str:
        leg = next((_LEGS[letter] for letter in run[0] if letter in _LEGS), None)
        named = {way: low.rfind(words.lower(), 0, run.start()) for way, words in ways.items()}
        last = max(named, key=named.__getitem__)
        return run[0] if leg is None or (leg == last and named[last] >= 0) else ""

    return _RUN.sub(kept, text)


class Slots:
    """What the slots of one clause tell, asked from left to right as they are filled.

    A side is told where both it and its owner are named: behind "the nose of V2", behind "its nose" once V2 was named.
    """

    def __init__(self, clause: str, one: Actor, other: Actor, areas: Mapping[str, str], given: Container[str]) -> None:
        """`areas`: the sides that the slots `sa` and `ta` name, where they name those of an impact; `given`: slots that
        are filled with words of another meaning than theirs."""
        self.areas = areas
        own = dict.fromkeys(_ONE, one) | dict.fromkeys(_OTHER, other)
        self.actors = {slot: actor for slot, actor in own.items() if slot in areas or slot not in given}
        headings: dict[str, int | None] = {"dir": one.heading, "xb": one.heading, "from": one.heading, "opp": one.leg}
        headings |= {"outdir": one.out, "outxb": one.out}
        self.headings = {slot: heading for slot, heading in headings.items() if slot not in given}
        named = slots_of(clause)
        pairs = set(pairwise(named))
        self.joined = {a for a in areas if (a, OWNERS[a]) in pairs and not has(clause, f"{a}_apart")}
        """Sides whose owner follows them ("the {sa} of {S}")."""
        self.filled: set[str] = set()
        self.open: set[str] = set()

    def next(self, slot: str) -> list[str]:
        """Names of what the next slot tells."""
        actor = self.actors[slot].id if slot in self.actors else ""
        told = {side for side in self.open if OWNERS[side] == slot}
        if slot in self.areas:
            at_once = OWNERS[slot] in self.filled and slot not in self.joined
            told, self.open = ({slot}, self.open) if at_once else (set(), self.open | {slot})
        self.open -= told
        self.filled.add(slot)
        names = [f"id={actor}"] * (slot not in OWNERS) + [f"heading={self.headings.get(slot)}"]
        return [name for name in names + [f"{actor}.area={self.areas[side]}" for side in told] if name in NOTES]
