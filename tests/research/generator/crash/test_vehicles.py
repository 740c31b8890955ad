"""What the generator calls vehicles and their sides means the same to the reader."""

import re

import pytest

from research.generator.crash.vehicles import COLORS, KIND_WEIGHTS, bodies, by_kind, kind_told, models
from research.generator.incidents import SITUATIONS, make_incident
from research.generator.records import Phrase, records
from sgcad_core.kinds import ACTORS
from sgcad_core.reading.language import values, words
from sgcad_core.reading.text.area_phrases import area_of

DOORS = {"4-door", "four-door", "two-door", "2-door utility"}
"""Door counts, which name no kind by themselves."""
AREAS = [
    (heading.partition(".")[2], one.text)
    for heading, sections in records("contact").items() if heading.startswith("AREA.")
    for section in sections.values() for one in section
]  # fmt: skip
UNREAD = re.compile(
    r"(?:daytime running|stop|backup) light|high beam|trunk hood|\bL |\bR |"
    r"front passenger|passenger's front wheel"
)
"""Words of sides that the reader does not know, or takes for less than the phrase says."""


def test_every_kind_has_names_and_bodies() -> None:
    assert set(models()) == set(bodies()) == set(KIND_WEIGHTS) <= set(ACTORS)


def test_a_body_names_its_kind_by_a_word_of_the_vocabulary() -> None:
    named = {name for listed in bodies().values() for name in listed} - DOORS
    assert {name for name in named if not any(word in name.lower() for word in values("body"))} == set()


@pytest.mark.parametrize(("name", "kind"), [
    ("Ford Explorer", "suv"), ("Ford Taurus", "car"), ("Peterbilt", "truck"), ("quad cab pickup", "pickup"),
    ("a delivery van", "van"), ("a motorcyclist", "motorcycle"), ("another vehicle", "car"),
])  # fmt: skip
def test_the_vocabulary_says_what_kind_a_name_is_of(name: str, kind: str) -> None:
    assert kind_told(name) == kind


def test_a_name_of_two_kinds_is_of_the_one_that_its_record_needs() -> None:
    honda = Phrase("Honda", needs=("motorcycle",), weight=2)
    assert by_kind([Phrase("Honda Accord"), honda]) == {"car": ("Honda Accord",), "motorcycle": ("Honda", "Honda")}


def test_only_names_whose_kind_cannot_be_told_need_one() -> None:
    needing = [one for key in ("MODEL", "BODY") for one in records("vehicles")[key]["counted"] if one.needs]
    assert [one.text for one in needing if one.needs[0] == kind_told(one.text)] == []


def test_colors_are_words_of_the_vocabulary() -> None:
    assert set(COLORS) <= set(words("color"))


@pytest.mark.parametrize("area", ["front", "back", "left", "right"])
def test_no_phrase_of_a_side_is_read_as_another_side(area: str) -> None:
    told = [re.sub(r"\[([^\[\]|]*)[^\[\]]*\]", r"\1", text) for of, text in AREAS if of == area]
    found = {text: area_of(text) for text in told if not UNREAD.search(text)}
    assert {text: zone for text, zone in found.items() if zone and area not in zone.split("/")} == {}
    assert sum(zone is not None for zone in found.values()) > 0.8 * len(found)


def test_sides_of_incident_reports_allow_what_their_words_say() -> None:
    made = [make_incident(seed) for seed in range(200)]
    sides = {side for one in made for key in ("subject_area", "other_area") for side in one.allowed.get(key, ())}
    assert sides == {side for situation in SITUATIONS for pair in situation.sides for side in pair}
