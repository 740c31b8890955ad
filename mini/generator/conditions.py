"""Light, weather and surface: which words of one agree with the others, and what they tell of them."""

from __future__ import annotations

import re
from functools import cache

from mini.generator.world import Crash

SUN = re.compile(
    r"(?<!not )\b(?:sunny|sunshine|sun|sunlit|blue sk(?:y|ies)|sk(?:y|ies) (?:\w+ )?blue)\b", re.IGNORECASE
)
"""Words of the weather that tell daylight."""
SUNNY = re.compile(r"\bsunny|\bsunshine|\bblue sk(?:y|ies)|\bsk(?:y|ies) (?:\w+ )?blue", re.IGNORECASE)
"""Words of the light that tell a clear sky."""
BRIGHT = re.compile(rf"{SUN.pattern}|\bbright", re.IGNORECASE)
SUNLIT = re.compile(rf"{SUN.pattern}|\bsunlight", re.IGNORECASE)
"""Words of the light that no clouds allow."""
DRY = re.compile(r"\bdry\b", re.IGNORECASE)
FALLS = {"snow": "rain", "sleet": "rain", "clear": "sleet|freezing rain"}
"""Words of a surface that the weather does not allow."""


def fitting(key: str, options: list[str], crash: Crash) -> list[str]:
    """The words of "light", "weather" or "surface" that agree with the other two; all where none does."""
    return [words for words in options if agrees(words, key, crash.light, crash.weather)] or options


@cache
def agrees(words: str, key: str, light: str, weather: str) -> bool:
    """Whether words of "light", "weather" or "surface" may stand beside that light and that weather."""
    if key == "surface":
        return weather not in FALLS or not re.search(FALLS[weather], words, re.IGNORECASE)
    if key == "weather":  # "dry" is the air or the road, who knows
        return not DRY.search(words) and (light == "day" or not BRIGHT.search(words))
    return weather == "clear" or not SUNLIT.search(words)


def beside(key: str, text: str, crash: Crash) -> set[str]:
    """What words of the light tell of the weather, and the other way round."""
    other, found = ("light", SUN) if key == "weather" else ("weather", SUNNY)
    sunny = key != "surface" and (crash.light, crash.weather) == ("day", "clear") and found.search(text)
    return {other} if sunny else set()
