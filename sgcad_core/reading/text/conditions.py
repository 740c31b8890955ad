"""Light, weather and surface as the text states them; None where it does not. Knows no vehicle."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.text.normalise import Sentence
from sgcad_core.reading.text.severity import is_slight
from sgcad_core.records.specs import Light, Surface, Weather


class Conditions(NamedTuple):
    """Conditions at the time of the crash."""

    light: Light | None = None
    weather: Weather | None = None
    surface: Surface | None = None
    sources: Mapping[str, Source] = {}
    """Where each was read."""
    slight: bool = False
    """Whether all that is told of the blow speaks of a slight one."""


_LESS = ("interview", "injury", "police", "restraint", "towing", "health")
"""Roles of sentences that are asked where the crash's own tell nothing; they must tell two of the three."""
_ROLES = ("opening", "road", "conditions", "approach", "impact", "other", "rest", "avoidance")
_KINDS = ("light", "weather", "surface")


def conditions(sentences: Iterable[Sentence]) -> Conditions:
    """What the crash's own sentences say, else others; the worst weather and surface win."""
    told = list(sentences)
    own, less = ([s for s in told if s.role in roles] for roles in (_ROLES, _LESS))
    less = [s for s in less if sum(_told(kind, [s]) is not None for kind in _KINDS) > 1]
    found = {kind: _told(kind, own) or _told(kind, less) for kind in _KINDS}
    values = {role: told[0] for role, told in found.items() if told}
    return Conditions(**values, slight=is_slight(told), sources={role: told[1] for role, told in found.items() if told})


def _told(role: str, said: list[Sentence]) -> tuple[Any, Source] | None:
    signal = rule("conditions.traffic_light")
    lit = [s for s in said if not signal.search(s.text) or rule("conditions.dark").search(s.text)]
    return _first(role, lit if role == "light" else said)


def _first(role: str, said: list[Sentence]) -> tuple[Any, Source] | None:
    """What the first rule of a role states that any sentence meets without a negation before it, and where."""
    for rule_ in of_role(role):
        for sentence in said:
            for m in rule_.finditer(sentence.text):
                if not rule("conditions.negated").search(sentence.text[: m.start()]):
                    return rule_.yields[role], Source(sentence.number, m[0], rule_.id)
    return None
