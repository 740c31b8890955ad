"""Light, weather and surface as the text states them; None where it does not. Knows no vehicle."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from sgcad_core.language import of_role, rule
from sgcad_core.narrative.motion import Cue
from sgcad_core.narrative.text import Sentence
from sgcad_core.specs import Light, Surface, Weather


class Conditions(NamedTuple):
    """Conditions at the time of the crash."""

    light: Light | None = None
    weather: Weather | None = None
    surface: Surface | None = None
    sources: Mapping[str, Cue] = {}
    """Where each was read."""


_NEGATED = rule("conditions.negated")
_ROLES = ("opening", "road", "conditions", "approach", "impact", "other", "rest", "avoidance")


def conditions(sentences: Iterable[Sentence]) -> Conditions:
    """What the crash's own sentences say; the worst weather and surface win."""
    said = [s for s in sentences if s.role in _ROLES]
    lit = [s for s in said if not rule("conditions.traffic_light").search(s.text) or "dark" in s.text.lower()]
    found = {role: _first(role, lit if role == "light" else said) for role in ("light", "weather", "surface")}
    values = {role: told[0] for role, told in found.items() if told}
    return Conditions(**values, sources={role: told[1] for role, told in found.items() if told})


def _first(role: str, said: list[Sentence]) -> tuple[Any, Cue] | None:
    """What the first rule of a role states that any sentence meets without a negation before it, and where."""
    for rule_ in of_role(role):
        for sentence in said:
            for m in rule_.finditer(sentence.text):
                if not _NEGATED.search(sentence.text[: m.start()]):
                    return rule_.yields[role], Cue(sentence.number, m[0], rule_.id)
    return None
