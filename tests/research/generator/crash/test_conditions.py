"""Words of light, weather and surface agree with each other."""

import re

import pytest

from research.generator.clauses import scene_clauses
from research.generator.crash import conditions


@pytest.mark.parametrize(
    ("key", "light", "weather", "labels"),
    [
        ("light", "day", "rain", ["sunlit"]),
        ("light", "day", "clear", []),
        ("weather", "dark", "clear", ["of_road", "bright"]),
        ("weather", "day", "clear", ["of_road"]),
        ("surface", "day", "snow", ["rained"]),
        ("surface", "day", "rain", []),
        ("surface", "day", "clear", ["froze"]),
    ],
)
def test_words_stand_only_beside_what_allows_them(key: str, light: str, weather: str, labels: list[str]) -> None:
    assert conditions.untrue(key, light, weather) == labels


@pytest.mark.parametrize("table", ["LIGHT", "WEATHER", "SURFACE"])
def test_every_value_keeps_most_of_its_words(table: str) -> None:
    key, lights = table.lower(), scene_clauses.LIGHT
    for value, options in getattr(scene_clauses, table).items():
        trained = options.side(False)
        for light in lights:
            for weather in scene_clauses.WEATHER:
                if {"LIGHT": light, "WEATHER": weather}.get(table, value) != value:
                    continue
                kept = options.without(False, conditions.untrue(key, light, weather))
                assert len(kept) > 0.5 * len(trained), (value, light, weather)
                assert not (key == "weather" and [words for words in kept if re.search(r"\bdry\b", words)])
                assert not (weather == "snow" and [words for words in kept if key == "surface" and "rain" in words])
