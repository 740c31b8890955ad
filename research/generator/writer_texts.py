"""Whole narratives that writers made from fact sheets: rows in wordings that no list of phrases has.

A writer got the facts of a made crash as a dry table and told them in his own words, without having seen the phrases,
the rules or a real report. `written/<voice>.jsonl` has one a line: `text`, the `crash` (the fields of `world.Crash`)
and what is `told` of it, by the names of facts that all of the generator uses. There are few of them, so each is shown
in up to eight ways: the world turned by quarters, and the first two vehicles with each other's numbers.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

from research.generator.crash.world import Access, Actor, Contact, Crash, Leg
from research.generator.report import Report
from research.generator.targets import Targets, drawn_facts

FOLDER = Path(__file__).parent / "written"
DRAWN = 0.25
"""Share of the rows that show a drawing beside the narrative."""
_ROUND = ("north", "east", "south", "west")
_POINT = re.compile(
    r"(?<![A-Za-z])(?:(?P<long>(?:north|south)?(?:east|west)|north|south)(?P<end>[a-z]*)"
    r"|(?P<short>[NS]?[EW]|[NS])(?P<bound>/?B)?)(?![A-Za-z])",
    re.IGNORECASE,
)
_NUMBER = re.compile(r"\b(?:V|Vehicle|Unit|Veh\.?|VEHICLE|UNIT|VEH\.?)(?: No\.)?[ -]?#? ?[12]\b")
_WORDED = re.compile(
    r"\b(?:first|second|other|vehicle one|vehicle two|unit one|unit two|insured|case)\b", re.IGNORECASE
)


@dataclass(frozen=True)
class Written:
    """A narrative, its crash, and the facts of it that the narrative tells."""

    id: str
    text: str
    crash: Crash
    told: frozenset[str]


def load(folder: Path = FOLDER) -> tuple[Written, ...]:
    """All narratives of a folder.

    Raises:
        ValueError: names the file and line that is no narrative, or the folder without any.
    """
    found = tuple(one for file in sorted(folder.glob("*.jsonl")) for one in _of_file(file))
    if not found:
        raise ValueError(f"{folder} has no written narratives (*.jsonl); they come with the source, not with a wheel")
    return found


def _of_file(file: Path) -> Iterator[Written]:
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        try:
            given = json.loads(line)
            yield Written(given["id"], given["text"], crash_of(given["crash"]), frozenset(given["told"]))
        except (ValueError, KeyError, TypeError) as fault:
            raise ValueError(f"{file}, line {number}: no narrative with crash and told facts ({fault!r})") from fault


def crash_of(given: dict[str, Any]) -> Crash:
    """A crash from its fields as JSON."""
    parts: dict[str, Any] = {
        key: [kind(**one) for one in given[key]]
        for key, kind in (("legs", Leg), ("actors", Actor), ("contacts", Contact), ("accesses", Access))
    }
    return Crash(**(given | parts))


# ------------------------------------------------------------------ other ways to see it
def turned(one: Written, quarters: int) -> Written:
    """The same crash with the world turned clockwise by quarters: every compass word, every bearing, every axis."""
    if not quarters % 4:
        return one
    crash, by = one.crash, 2 * quarters
    legs = sorted((replace(leg, bearing=(leg.bearing + by) % 8) for leg in crash.legs), key=lambda leg: leg.bearing)
    actors = [replace(a, leg=(a.leg + by) % 8, out=None if a.out is None else (a.out + by) % 8) for a in crash.actors]
    accesses = [replace(access, leg=(access.leg + by) % 8) for access in crash.accesses]
    moved = replace(crash, main=(crash.main + by) % 8, legs=legs, actors=actors, accesses=accesses)
    told = frozenset(_turned_fact(fact, by) for fact in one.told)
    return replace(one, text=_POINT.sub(lambda m: _turned_word(m, quarters), one.text), crash=moved, told=told)


def _turned_fact(fact: str, by: int) -> str:
    """A fact of a road names its axis (0 to 3)."""
    key, _, axis = fact.partition(".")
    return f"{key}.{(int(axis) + by) % 4}" if axis and key in ("lanes", "median", "turns", "limit", "ways") else fact


def _turned_word(found: re.Match[str], quarters: int) -> str:
    """A compass word turned; a single letter only where it stands for a direction of travel ("N/B")."""
    if long := found["long"]:
        if found["end"].lower() not in ("", "bound", "ern", "erly", "ward", "wards", "ernmost", "er"):
            return found[0]
        return _like(long, _moved(long.lower(), quarters)) + found["end"]
    short = found["short"]
    if not short.isupper() or not (found["bound"] or len(short) == 2):
        return found[0]
    initials = {"n": "north", "s": "south", "e": "east", "w": "west"}
    word = _moved("".join(initials[c] for c in short.lower()), quarters)
    return "".join(w[0].upper() for w in re.findall("north|south|east|west", word)) + (found["bound"] or "")


def _moved(word: str, quarters: int) -> str:
    """ "north" turned by one is "east", "northeast" is "southeast"."""
    points = [_ROUND[(_ROUND.index(w) + quarters) % 4] for w in re.findall("north|south|east|west", word)]
    return "".join(sorted(points, key=lambda point: point in ("east", "west")))


def _like(was: str, word: str) -> str:
    return word.upper() if was.isupper() and len(was) > 1 else word.capitalize() if was[0].isupper() else word


def renumbered(one: Written) -> Written:
    """The same crash, the first two vehicles with each other's numbers; as it is where words stand for the numbers."""
    names = [actor.id for actor in one.crash.actors]
    if not {"V1", "V2"} <= set(names) or _WORDED.search(one.text) or not _NUMBER.search(one.text):
        return one
    other = {"V1": "V2", "V2": "V1"}
    at = {name: i for i, name in enumerate(names)}
    order = [at[other.get(name, name)] for name in names]  # place i is taken by who was at order[i]
    actors = [replace(one.crash.actors[i], id=names[place]) for place, i in enumerate(order)]
    contacts = [replace(c, striker=order.index(c.striker), struck=order.index(c.struck)) for c in one.crash.contacts]
    told = frozenset(
        f"{key}.{other[name]}" if name in other else fact for fact in one.told for key, _, name in [fact.partition(".")]
    )
    text = _NUMBER.sub(_swapped, one.text)
    return replace(one, text=text, crash=replace(one.crash, actors=actors, contacts=contacts), told=told)


def _swapped(found: re.Match[str]) -> str:
    return found[0][:-1] + {"1": "2", "2": "1"}[found[0][-1]]


# ------------------------------------------------------------------ rows
def report_of(one: Written, seed: int, image: bool = False) -> Report:
    """The narrative as a report, with or without the crash's drawing."""
    drawn = drawn_facts(one.crash, control=True, arrows=True, access=False) if image else set[str]()
    told = set(one.told) | ({"legs"} if "layout" in one.told else set())
    targets = Targets(one.crash, told | drawn, alone=not image)
    mode = "both" if image else "text"
    return Report(seed, mode, one.crash, one.text, image, targets.road, targets.behavior, targets, told, drawn)


def some_report(found: Sequence[Written], seed: int) -> Report:
    """One of the narratives, in one of its ways."""
    rng = Random(f"{seed} written")
    one = turned(rng.choice(found), rng.randrange(4))
    return report_of(renumbered(one) if rng.random() < 0.5 else one, seed, image=rng.random() < DRAWN)


@cache
def shipped() -> tuple[Written, ...]:
    """The narratives beside this module."""
    return load()
