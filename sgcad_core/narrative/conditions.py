"""Light, weather and surface as the text states them; None where it does not. Knows no vehicle."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple, TypeVar

from sgcad_core.narrative.text import Sentence
from sgcad_core.specs import Light, Surface, Weather


class Conditions(NamedTuple):
    """Conditions at the time of the crash."""

    light: Light | None = None
    weather: Weather | None = None
    surface: Surface | None = None


Word = TypeVar("Word", Light, Weather, Surface)

_LIGHT: tuple[tuple[Light, str], ...] = (
    ("dark_lit", r"\bdark\w*\b(?![^.;]{0,20}\b(?:not|un)\s?-?(?:lit|lighted|illuminated))"
                 r"(?![^.;]{0,40}\b(?:no|without|lack of)(?: \w+)? (?:street ?|over ?head )?light)"
                 r"[^.;]{0,50}\b(?:but|with|and)?\s*(?:\w+ ){0,4}"
                 r"(?<!un)(?<!un-)(?:lighted|lit|lights?|illuminat\w+|street ?lights?|streetlighting|lighting)\b"),
    ("dark_lit", r"\b(?:street ?(?:lights|lighting|lamps)|roadway was (?:illuminated|lighted|lit)|"
                 r"artificial(?:ly)? (?:light(?:s|ing)?|lit|illuminat(?:ion|ed))|illuminated by|illuminated and)\b"),
    ("dark", r"\b(?:dark|darkness|unlighted|unlit|not illuminated|no illumination|night ?time|at night|midnight|"
             r"late evening|late night|late at night)\b"),
    ("dark", r"\b(?:(?:9|10|11)(?::\d\d)? ?p\.?m|12:\d\d ?a\.?m|[1-4](?::\d\d)? ?a\.?m|2[0-3]:?\d\d hours|"
             r"0[0-4]:?\d\d hours)\b"),
    ("dawn", r"\b(?:dawn|daybreak|sunrise|morning twilight|sun (?:was|had) (?:\w+ )?(?:coming up|come up|rising|"
             r"risen))\b"),
    ("dusk", r"\b(?:dusk|twilight|sunset|sun (?:was|had) (?:\w+ )?(?:set|setting|going down|gone down))\b"),
    ("day", r"\b(?:daylight|day ?light|day ?time|broad day|sunny|daylight hours|during the day)\b"),
    ("day", r"\b(?:it was|lighting(?: conditions?)? (?:was|were)) light\b(?! (?:rain|snow|drizzl|fog|mist|traffic))|"
            r"\bsun was (?:shining|out)\b"),
    ("day", r"\b(?:mid-?day|noon|late morning|mid-?morning|(?:early |mid-?)?afternoon|morning daylight)\b"),
)  # fmt: skip
_WEATHER: tuple[tuple[Weather, str], ...] = (
    ("snow", r"\b(?:snowing|snow(?: was)? falling|snowy|snow ?storm|light snow|heavy snow|with snow|"
             r"blowing snow|snow flurries)\b"),
    ("sleet", r"\b(?:sleet\w*|freezing rain|hail|hailing)\b"),
    ("rain", r"\b(?:raining|rainy|(?<!wet from )(?<!wet with )rain(?!ed|[ -](?:soaked|slick\w*|covered))|drizzl\w+|"
             r"rained upon|wet weather)\b"),
    ("fog", r"\b(?:fog|foggy|smog|mist|misty|misting)\b"),
    ("cloudy", r"\b(?:cloud\w*|overcast)\b"),
    ("clear", r"\b(?:clear|sunny|no adverse|no atmospheric|no (?:weather|environmental)|without adverse|"
              r"(?:no|without(?: any)?|free of) precipitation|not (?:raining|snowing)|sun was (?:shining|out))\b"),
    ("clear", r"\b(?:weather|atmospheric)(?: conditions?)?(?: (?:was|were|being|and))* (?:good|fair|fine|nice|dry|"
              r"normal|(?:not|never) an? (?:contributing |causal )?factor)\b|"
              r"\b(?:good|fair|fine|nice|dry) weather\b"),
    ("rain", r"\brain\b"),
)  # fmt: skip
_SURFACE: tuple[tuple[Surface, str], ...] = (
    ("ice", r"\b(?:icy|ice[ -]covered|(?:covered|coated) (?:with|in|by) ice|black ice|patch\w* of ice|ice on|"
            r"slick with ice|and ice\b)"),
    ("snow", r"\b(?:snow[ -](?:and ice )?covered|snow[ -]cover\w*|covered (?:with|in) snow|slush\w*|snow and ice "
             r"covered|packed snow|snow[ -]packed)\b"),
    ("dry", r"\bfree of (?:moisture|water)\b"),
    ("wet", r"\b(?:wet|damp|moist|standing water|water on the road|rain[ -](?:soaked|slick\w*|covered)|"
            r"slick (?:from|with) (?:the )?rain)\b"),
    ("dry", r"\bdry(?! weather)\b"),
)  # fmt: skip
_NEGATED = re.compile(
    r"\b(?:no|not|without|had just stopped|stopped|earlier|previous\w*|before (?:the|it))\b(?: (?!and\b|but\b|"
    r"or\b)\w+){0,3} ?$",
    re.I)  # fmt: skip
_ROLES = ("opening", "road", "conditions", "approach", "impact", "other", "rest", "avoidance")


def conditions(sentences: Iterable[Sentence]) -> Conditions:
    """What the crash's own sentences say; the worst weather and surface win."""
    text = [s.text for s in sentences if s.role in _ROLES]
    lit = [
        t
        for t in text
        if not re.search(r"traffic (?:light|signal)|turn signal|green light|red light", t, re.I) or "dark" in t.lower()
    ]
    light = _first(_LIGHT, lit)
    return Conditions(light, _first(_WEATHER, text), _first(_SURFACE, text))


def _first(rules: tuple[tuple[Word, str], ...], text: list[str]) -> Word | None:
    """The first rule that any sentence meets without a negation before it."""
    for value, pattern in rules:
        for sentence in text:
            for m in re.finditer(pattern, sentence, re.I):
                if not _NEGATED.search(sentence[: m.start()]):
                    return value
    return None
