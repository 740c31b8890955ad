"""Cyclists beside the one vehicle that a report numbers."""

import pytest

from sgcad_core.reading.reading import read

CYCLIST = (
    "Vehicle 1 was traveling south on Oak Street. A cyclist was riding east on Elm Avenue. The front of Vehicle 1 "
    "struck the left side of the bicycle."
)


def test_a_cyclist_without_a_number_has_a_way_and_sides_of_its_own() -> None:
    crash = read(CYCLIST).crash
    assert [(v.id, v.kind, v.heading) for v in crash.vehicles] == [("V1", "car", "S"), ("B1", "bicycle", "E")]
    contact = crash.contacts[0]
    assert (contact.striker, contact.struck, contact.struck_area) == ("V1", "B1", "left")


@pytest.mark.parametrize(
    "text",
    [
        "V1 was northbound and swerved around a cyclist. V1 struck a tree with its front.",
        "V1 was northbound. V2 was stopped for a cyclist. The front of V1 struck the back of V2.",
    ],
)
def test_who_touches_nobody_is_no_actor(text: str) -> None:
    assert all(v.id.startswith("V") for v in read(text).crash.vehicles)


def test_the_sentences_keep_their_places() -> None:
    reading = read(CYCLIST)
    said = next(f for f in reading.facts if f.field == "vehicles.B1.heading")
    assert CYCLIST[said.start : said.end].startswith("A cyclist")
