"""Names of parties ("Plaintiff", "our insured", "Mr. Ault") as the vehicles that they drive.

Works on sentences in which every vehicle is a number. "Claimant was operating V1 north" becomes "V1 was driving north",
and "Claimant" is V1 in every other sentence, too. Of two parties, the other one has the other of two vehicles. Knows no
motion.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.language import rule, words

_PARTIES = words("party")
_AGAINST = (("plaintiff", "defendant"), ("claimant", "respondent"), ("claimant", "insured"),
            ("petitioner", "respondent"), ("claimant", "defendant"))  # fmt: skip
"""Pairs of opposing parties."""
_DROVE = rule("drivers.drove")
_POSSESSOR = rule("drivers.possessor")


class Drivers(NamedTuple):
    """Number of the vehicle by what a report calls its driver, lower case."""

    called: Mapping[str, str]

    def resolve(self, text: str) -> str:
        """The sentence with the vehicle in place of its driver."""
        text = _POSSESSOR.sub("", text)
        text = _DROVE.sub(_driven, text)
        return rule("drivers.party").sub(self._number, text) if self.called else text

    def _number(self, match: re.Match[str]) -> str:
        return self.called.get(match["who"].lower(), match.group())


NO_DRIVERS = Drivers({})


def drivers(told: Iterable[str], roster: Roster) -> Drivers:
    """Vehicle of each party, from sentences whose vehicles are numbers; parties that are said to drive two are left
    out."""
    meant: dict[str, set[str]] = {}
    for text in told:
        for name, vehicle in _named(text):
            meant.setdefault(name, set()).add(vehicle)
    called = {name: next(iter(ids)) for name, ids in meant.items() if len(ids) == 1 and ids <= set(roster.ids)}
    for pair in _AGAINST:
        for one, other in (pair, pair[::-1]):
            if one in called and other not in meant and (rest := roster.other(called[one])):
                called[other] = rest
    return Drivers(called)


def _named(text: str) -> Iterator[tuple[str, str]]:
    for m in (*rule("drivers.called").finditer(text), *_DROVE.finditer(_POSSESSOR.sub("", text))):
        if party := next((word for word in _PARTIES if word in m["who"].lower().split()), None):
            yield party, m["v"]


def _driven(match: re.Match[str]) -> str:
    """ "Insured was southbound in V1" -> "V1 was southbound"; "Insured drove V1" -> "V1 was driving"."""
    middle = match["middle"].rstrip(" ,")
    drove = match["verb"] and not middle and not match["end"]
    end = "," if match["end"] and middle.startswith(",") else ""
    return f"{match['lead']}{match['v']}{' was driving' if drove else middle}{end}"
