"""Names of streets are the same in every spelling, and different where they are told apart."""

import pytest

from sgcad_core.formats.osm.names import StreetName, street_name


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("North Maple Street", "N. Maple St."), ("Fifth Avenue", "5th Ave"), ("Main St NW", "Northwest Main Street"),
        ("US 30", "U.S. Route 30"), ("US-30", "US Highway 30"), ("I-95", "Interstate 95"), ("SR 17", "State Route 17"),
        ("CR 12", "County Road 12"), ("St. Clair Ave", "Saint Clair Avenue"),
        ("Mt Vernon Blvd", "Mount Vernon Boulevard"),
        ("O’Neill Rd", "O'Neill Road"), ("Martin Luther King Jr. Blvd", "Martin Luther King Junior Boulevard"),
    ],
)  # fmt: skip
def test_spellings_of_one_name_are_the_same(one: str, other: str) -> None:
    assert street_name(one) == street_name(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [("Maple Street", "Maple Avenue"), ("N Maple St", "S Maple St"), ("US 30", "State Route 30"),
     ("5th Ave", "6th Ave"), ("30th Street", "Route 30"), ("North Street", "South Street")],
)  # fmt: skip
def test_other_streets_are_told_apart(one: str, other: str) -> None:
    first, second = street_name(one), street_name(other)
    assert first
    assert second
    assert first.likeness(second) == 0


def test_what_is_left_out_fits_less_well() -> None:
    whole = street_name("North Maple Street")
    assert whole
    found = [whole.likeness(name) for text in ("N Maple St", "Maple St", "Maple") if (name := street_name(text))]
    assert found == [3, 2, 1]


def test_a_route_without_its_class_is_any_of_that_number() -> None:
    assert StreetName("30", "us", "", True).likeness(StreetName("30", "", "", True)) == 2


def test_a_side_alone_is_a_name() -> None:
    assert street_name("North Street") == StreetName("north", "street")


def test_a_text_without_words_is_no_name() -> None:
    assert street_name(" - ") is None
