"""Light, weather and surface: which words of one agree with the others, and what they tell of them."""

from __future__ import annotations

from research.generator.crash.world import Crash
from research.generator.phrase_labels import has

FALLS = {"snow": "rained", "sleet": "rained", **dict.fromkeys(("clear", "cloudy", "fog"), "froze")}
"""Label of the words of a surface that a weather does not allow."""


def untrue(key: str, light: str, weather: str) -> list[str]:
    """Labels of those words of "light", "weather" or "surface" that may not stand beside that light and weather."""
    if key == "surface":
        return [FALLS[weather]] if weather in FALLS else []
    if key == "weather":
        return ["of_road"] + ["bright"] * (light != "day")
    return ["sunlit"] * (weather != "clear")


def beside(key: str, text: str, crash: Crash) -> set[str]:
    """What words of the light tell of the weather, and the other way round."""
    other = {"light": "weather", "weather": "light"}.get(key)
    sunny = other and (crash.light, crash.weather) == ("day", "clear") and has(text, "sunny")
    return {other} if other and sunny else set()
