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
"""Words of the weather that no night allows."""
SUNLIT = re.compile(rf"{SUN.pattern}|\bsunlight", re.IGNORECASE)
"""Words of the light that no clouds allow."""
DRY = re.compile(r"\bdry\b", re.IGNORECASE)
"""Words of the weather that may be of the road."""
FALLS = {"snow": "rain", "sleet": "rain", **dict.fromkeys(("clear", "cloudy", "fog"), "sleet|freezing rain")}
"""Words of a surface that the weather does not allow."""


@cache
def fitting(key: str, words: tuple[str, ...], light: str, weather: str) -> list[str]:
    """Those of the words of "light", "weather" or "surface" that agree with that light and that weather."""
    return [said for said in words if agrees(said, key, light, weather)]


def agrees(words: str, key: str, light: str, weather: str) -> bool:
    """Whether words of "light", "weather" or "surface" may stand beside that light and that weather."""
    if key == "surface":
        return weather not in FALLS or not re.search(FALLS[weather], words, re.IGNORECASE)
    if key == "weather":
        return not DRY.search(words) and (light == "day" or not BRIGHT.search(words))
    return weather == "clear" or not SUNLIT.search(words)


def beside(key: str, text: str, crash: Crash) -> set[str]:
    """What words of the light tell of the weather, and the other way round."""
    other, found = ("light", SUN) if key == "weather" else ("weather", SUNNY)
    sunny = key != "surface" and (crash.light, crash.weather) == ("day", "clear") and found.search(text)
    return {other} if sunny else set()
