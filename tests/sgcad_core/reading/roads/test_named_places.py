"""Streets, coordinates and distances are found where they stand; what is no place is not."""

import pytest

from sgcad_core.reading.roads.named_places import NamedPlaces, named_places


def names(text: str) -> list[str]:
    return [street.text for street in named_places(text).streets]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("V1 was northbound on N. Maple St and V2 on East 5th Avenue.", ["N. Maple St", "East 5th Avenue"]),
        ("at the intersection of Broadway and Fifth", ["Broadway", "Fifth"]),
        ("on US-30 near State Route 17", ["US-30", "State Route 17"]),
        ("The driver went down Martin Luther King Jr. Blvd.", ["Martin Luther King Jr. Blvd."]),
        ("LOCATION: N MAPLE ST AT 5TH AVE\nUNIT 1 WAS NORTHBOUND", ["N Maple St", "5th Ave"]),
        ("Elm Street. Later on Elm Street again.", ["Elm Street"]),
        ("The street was wet. A Street. Unit 1 stopped. It was on Friday.", []),
    ],
)
def test_streets_are_found_as_they_are_called(text: str, found: list[str]) -> None:
    assert names(text) == found


def test_spans_are_places_in_the_text() -> None:
    text = "AT N MAPLE ST AND 5TH AVE, UNIT 1 STOPPED"
    for street in named_places(text).streets:
        assert text[street.start : street.end].lower() == street.text.lower()


def test_a_street_knows_the_directions_told_of_it() -> None:
    text = "V1 went north on Pine Street. V2 went westbound on Oak Road. V3 was southbound in lane two of Pine Street."
    assert {s.text: s.ways for s in named_places(text).streets} == {"Pine Street": ("N", "S"), "Oak Road": ("W",)}


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("at 40.12345, -75.54321.", (40.12345, -75.54321)),
        ("Latitude: 40.12345 N, Longitude: 75.54321 W", (40.12345, -75.54321)),
        ("33.86520° S / 151.20990° E", (-33.8652, 151.2099)),
        ("95.12345, -75.54321", (None, None)),
        ("damage of 1200.50, 300.25 dollars", (None, None)),
    ],
)
def test_coordinates_are_degrees_north_and_east(text: str, place: tuple[float | None, float | None]) -> None:
    found = named_places(text)
    assert (found.latitude, found.longitude) == place


@pytest.mark.parametrize(
    ("told", "metres"), [("150 feet", 45.72), ("20 yards", 18.288), ("30 m", 30.0), ("half mile", 804.672)]
)
def test_a_distance_from_a_street_is_in_metres(told: str, metres: float) -> None:
    away = named_places(f"On Elm Street, about {told} north of Oak Road, V1 struck V2.").away
    assert away
    assert (away.metres, away.way, away.street) == (pytest.approx(metres), "N", "Oak Road")


def test_a_distance_from_something_else_is_none() -> None:
    assert named_places("On Elm Street, 150 feet north of the bridge, V1 struck V2.").away is None


def test_a_text_without_places_has_none() -> None:
    assert named_places("V1 struck V2.") == NamedPlaces()
