"""Words of light, weather and surface agree with each other."""

import re

import pytest

from mini.generator import clauses_scene, conditions
from mini.generator.grammar import families


@pytest.mark.parametrize(
    ("key", "light", "weather", "words", "may"),
    [
        ("light", "day", "rain", "in bright sunlight", False),
        ("light", "day", "clear", "in bright sunlight", True),
        ("light", "day", "cloudy", "daylight", True),
        ("weather", "dark", "clear", "sunny", False),
        ("weather", "day", "clear", "sunny", True),
        ("weather", "day", "clear", "clear and dry", False),
        ("surface", "day", "snow", "wet with rain", False),
        ("surface", "day", "rain", "wet with rain", True),
        ("surface", "day", "clear", "icy from freezing rain", False),
    ],
)
def test_words_stand_only_beside_what_allows_them(key: str, light: str, weather: str, words: str, may: bool) -> None:
    assert conditions.agrees(words, key, light, weather) is may


@pytest.mark.parametrize("table", ["LIGHT", "WEATHER", "SURFACE"])
def test_every_value_keeps_most_of_its_words(table: str) -> None:
    key, lights = table.lower(), clauses_scene.LIGHT
    for value, options in getattr(clauses_scene, table).items():
        trained = families(options, False)
        for light in lights:
            for weather in clauses_scene.WEATHER:
                if {"LIGHT": light, "WEATHER": weather}.get(table, value) != value:
                    continue
                kept = conditions.fitting(key, tuple(trained), light, weather)
                assert len(kept) > 0.5 * len(trained), (value, light, weather)
                assert not (key == "weather" and [words for words in kept if re.search(r"\bdry\b", words)])
