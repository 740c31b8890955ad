"""Light, weather and surface as the text states them; None where it does not. Knows no vehicle."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from sgcad_core.language import of_role, rule
from sgcad_core.narrative.text import Sentence
from sgcad_core.specs import Light, Surface, Weather


class Conditions(NamedTuple):
    """Conditions at the time of the crash."""

    light: Light | None = None
    weather: Weather | None = None
    surface: Surface | None = None


_NEGATED = rule("conditions.negated")
_ROLES = ("opening", "road", "conditions", "approach", "impact", "other", "rest", "avoidance")


def conditions(sentences: Iterable[Sentence]) -> Conditions:
    """What the crash's own sentences say; the worst weather and surface win."""
    text = [s.text for s in sentences if s.role in _ROLES]
    lit = [t for t in text if not rule("conditions.traffic_light").search(t) or "dark" in t.lower()]
    light = _first("light", lit)
    return Conditions(light, _first("weather", text), _first("surface", text))


def _first(role: str, text: list[str]) -> Any:
    """What the first rule of a role states that any sentence meets without a negation before it."""
    for rule_ in of_role(role):
        for sentence in text:
            for m in rule_.finditer(sentence):
                if not _NEGATED.search(sentence[: m.start()]):
                    return rule_.yields[role]
    return None
