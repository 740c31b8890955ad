"""How much likelier than the rules' values the learned reader of numbered reports holds a model's values.

Log odds by field of `sgcad_core.reading.second_reader.field_claims`, 0 where no question asks for it. Knows no weights.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sgcad_core.reading.second_reader.field_claims import Claims, kind_of
from sgcad_core.reading.second_reader.numbered.numbered_answers import MANEUVERS, relative
from sgcad_core.reading.text.compass import turned

if TYPE_CHECKING:
    from sgcad_core.reading.crash_facts import CrashFacts
    from sgcad_core.records.second_reader import Guess

_LEAST = 1e-3


def support_of(crash: CrashFacts, rules: Claims, said: Claims, guesses: Mapping[str, Guess]) -> dict[str, float]:
    """The log odds of every value of the model's that the rules have another one for."""
    found = {}
    for key in said.keys() & rules.keys() if guesses else ():
        answers = _answers(crash, key, rules[key].value), _answers(crash, key, said[key].value)
        odds = [_odds(guesses[q], ours, theirs) for q, ours, theirs in _both(*answers) if q in guesses]
        if odds:
            found[key] = sum(odds)
    return found


def _both(ours: Mapping[str, str], theirs: Mapping[str, str]) -> Iterator[tuple[str, str, str]]:
    """Questions that both values answer, and answer otherwise."""
    for question in ours.keys() & theirs.keys():
        if ours[question] != theirs[question]:
            yield question, ours[question], theirs[question]


def _odds(guess: Guess, ours: str, theirs: str) -> float:
    one, other = (sum(guess.shares.get(answer, 0.0) for answer in some.split("+")) for some in (theirs, ours))
    return math.log(max(one, _LEAST) / max(other, _LEAST))


def _answers(crash: CrashFacts, key: str, value: Any) -> dict[str, str]:
    """What a value answers to questions, by question."""
    kind, _, of = key.partition(".")
    if kind == "maneuver":
        return {f"maneuver.{of}": MANEUVERS[value]}
    if kind == "areas":
        return {f"area.{vehicle}": side for vehicle, side in value}
    if kind == "legs":
        return {"junction": "yes" if len(value) > 2 else "no"}
    if kind == "lanes":
        return dict(_lanes(crash, value))
    return _turned(crash, of, value) if kind_of(key) == "heading" else {}


def _lanes(crash: CrashFacts, value: Any) -> Iterator[tuple[str, str]]:
    ways = {bearing: f"own{inward}+both{inward + out}" for bearing, inward, out in value}
    for v in crash.vehicles:
        if v.heading and turned(v.heading, 180) in ways:
            yield f"lanes.{v.id}", ways[turned(v.heading, 180)]


def _turned(crash: CrashFacts, of: str, value: Any) -> dict[str, str]:
    """The turn between the first two vehicles, if one of them heads so and the other one as the rules have it."""
    one, two = (crash.vehicle(name) for name in ("V1", "V2"))
    if one is None or two is None or of not in ("V1", "V2"):
        return {}
    one, two = (replace(v, heading=value) if v.id == of else v for v in (one, two))
    turn = relative(one, two)
    return {"turned.V2": turn} if turn is not None else {}
