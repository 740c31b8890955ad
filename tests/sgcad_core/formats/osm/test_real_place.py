"""A report's place is found in a map by what it says, and laid under its bearings; else a reason says why not."""

import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, assume, given
from hypothesis import settings as rules
from hypothesis import strategies as st

from sgcad_core import settings
from sgcad_core.formats.osm.fit import laid_on, settled
from sgcad_core.formats.osm.real_place import axes_of, real_place
from sgcad_core.formats.osm.street_map import StreetMap, read_street_map
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.compass import COMPASS, NAMES
from sgcad_core.records.place import Place
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import hub_control
from tests.effort import many
from tests.sgcad_core.formats.osm.sketches import Sketch, polar

TOWN = read_street_map(settings.CONFIGS / "extracts" / "streets.osm")
MET = "The front of V1 struck the right side of V2 in the intersection."


def laid(text: str, *maps: StreetMap) -> tuple[Place, RoadLayout]:
    """The place of a report, and the layout of its roads there."""
    facts = read(text).roads
    place = real_place(text, facts, layout_of_facts(facts, as_counted=True), maps or (TOWN,))
    layout, found = settled(layout_of_facts(facts, laid=laid_on(place, facts, axes_of(text))), place)
    assert found
    return found, layout


def headings(layout: RoadLayout) -> dict[str, float]:
    return {leg.bearing: (45 * COMPASS.index(leg.bearing) + leg.skew_deg) % 360 for leg in layout.legs}


def lanes(layout: RoadLayout) -> dict[str, tuple[int, int]]:
    return {leg.bearing: (leg.lanes_in, leg.lanes_out) for leg in layout.legs}


def facts(place: Place) -> dict[str, tuple[str, str, bool]]:
    return {fact.field: (fact.told, fact.on_map, fact.agrees) for fact in place.facts}


# ------------------------------------------------------------------ found and fitted
def test_a_crossing_by_two_names_has_the_lanes_limits_and_control_of_the_map() -> None:
    place, layout = laid(f"V1 was northbound on N Maple St. V2 was eastbound on East 5th Ave. {MET}")
    assert place.found
    assert headings(layout) == {"N": 12, "E": 102, "S": 192, "W": 282}
    assert lanes(layout) == {"N": (2, 2), "E": (1, 2), "S": (2, 2), "W": (2, 1)}
    west = next(leg for leg in layout.legs if leg.bearing == "W")
    assert (west.turns_in, west.speed_limit_mph, west.control) == (("through_right", "left"), 30, "signal")


def test_the_origin_is_where_the_streets_meet() -> None:
    place, _ = laid(f"V1 was northbound on N Maple St. V2 was eastbound on East 5th Ave. {MET}")
    x, y = 210 * math.sin(math.radians(12)), 210 * math.cos(math.radians(12))
    assert place.origin == pytest.approx(
        (40.0 + y / 111_320, -100.0 + x / (111_320 * math.cos(math.radians(40)))), abs=1e-6
    )


def test_a_diagonal_street_keeps_its_heading_and_its_bearing_in_the_report() -> None:
    place, layout = laid(f"V1 was eastbound on Old Post Road. V2 was northbound on Mill Rd. {MET}")
    assert sorted(headings(layout).values()) == [52, 102, 232, 282]
    assert {one.bearing: one.road for one in place.legs}["N"] == "NE"


def test_a_t_junction_has_the_stem_of_the_map() -> None:
    text = "V2 was northbound on Orchard Lane at a stop sign, at its T-intersection with Old Post Road. "
    place, layout = laid(text + "V1 was eastbound on Old Post Road. The front of V1 struck the left side of V2.")
    assert sorted(headings(layout).values()) == [102, 192, 282]
    assert facts(place) == {"legs": ("3", "3", True), "control": ("stop", "stop", True)}


def test_a_divided_road_has_its_median() -> None:
    _, layout = laid(f"V1 was northbound on N Maple St. V2 was eastbound on Harbor Blvd. {MET}")
    assert {leg.bearing: (leg.median, leg.lanes_in) for leg in layout.legs}["E"] == ("grass", 2)


def test_a_roundabout_is_one() -> None:
    text = "V1 was northbound on Lakeview Drive and entered the roundabout at College Way. "
    place, layout = laid(f"{text}V2 was eastbound on College Way. {MET}")
    assert place.found
    assert layout.circle_lanes == 1
    assert facts(place)["circle"][2]


def test_a_point_of_a_highway_by_its_number_and_a_distance() -> None:
    text = "V1 was westbound on US-40 about 500 feet east of County Road 12. V2 slowed. "
    place, layout = laid(text + "The front of V1 struck the back of V2.")
    assert place.place
    assert (place.place.where, headings(layout)) == ("152 m E of County Road 12", {"E": 102, "W": 282})


def test_coordinates_alone_find_a_junction() -> None:
    text = f"V1 was northbound and V2 was eastbound at 40.00185, -99.99949. {MET} It is a four-leg intersection."
    place, _ = laid(text)
    assert place.place
    assert place.place.streets == ("North Maple Street", "East 5th Avenue")


# ------------------------------------------------------------------ told against the map
def test_told_lanes_stand_where_the_map_has_others_and_both_are_told() -> None:
    text = "V1 was northbound on N Maple St, a six-lane, two-way road. V2 was eastbound on East 5th Ave. " + MET
    place, layout = laid(text)
    assert facts(place)["lanes"] == ("6", "4", False)
    assert lanes(layout)["S"] == (3, 3)
    assert "against it: lanes of North Maple Street: 6, on the map 4" in place.sentence


def test_lanes_that_agree_are_the_maps() -> None:
    text = "V1 was northbound on N Maple St, a four-lane, two-way road. V2 was eastbound on East 5th Ave. " + MET
    assert facts(laid(text)[0])["lanes"] == ("4", "4", True)


def test_a_told_lane_exists_even_where_the_map_lacks_it() -> None:
    text = "V1 was northbound on N Maple St in lane three. V2 was eastbound on East 5th Ave. " + MET
    assert lanes(laid(text)[1])["S"][0] == 3


def test_a_told_control_stands() -> None:
    text = "V1 was northbound on N Maple St. V2 was eastbound on East 5th Ave. V2 had a stop sign. "
    place, layout = laid(text + MET)
    assert facts(place)["control"] == ("stop", "signal", False)
    assert hub_control(layout.legs) == "stop"


def test_who_drives_against_a_one_way_street_has_a_lane() -> None:
    text = (
        "V1 was southbound on First Street. V2 was eastbound on E 4th Ave. The front of V2 struck the right side of V1."
    )
    assert lanes(laid(text)[1])["N"] == (1, 2)


def test_a_told_t_junction_stays_one_where_the_map_has_four_legs() -> None:
    text = "V1 was northbound on Cedar Street at a T-intersection with E 4th Ave. V2 was eastbound on E 4th Ave. "
    place, layout = laid(text + MET)
    assert facts(place)["legs"] == ("3", "4", False)
    assert len(layout.legs) == 3


# ------------------------------------------------------------------ not found
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("V1 was northbound and V2 was eastbound.", "names no street and no coordinates"),
        ("V1 was northbound on Pine Street. V2 was eastbound on Oak Road.", "has no Pine Street and no Oak Road"),
        ("V1 was northbound on Mill Road. V2 was eastbound on Oak Road.", "streets.osm has Mill Road but no Oak Road"),
        ("V1 was northbound on Cedar Street. V2 was eastbound on Old Post Road.", "do not meet in streets.osm"),
        ("V1 was northbound on Park Street. V2 was eastbound on Elm Street.", "2 places fit equally"),
        (
            "V1 was eastbound on N Maple St. V2 was northbound on East 5th Ave.",
            "does not fit: the report has roads to the",
        ),
        ("V1 was northbound and V2 was eastbound at 10.00000, 20.00000.", "no junction of streets.osm is near"),
    ],
)
def test_a_place_that_is_not_found_says_why(text: str, said: str) -> None:
    place, layout = laid(f"{text} {MET}")
    assert not place.found
    assert said in place.sentence
    assert layout == layout_of_facts(read(f"{text} {MET}").roads)


@pytest.mark.parametrize(
    ("told", "latitude"),
    [
        ("The intersection has a traffic signal.", 40.02076),
        ("It has an all-way stop.", 40.01329),
        ("It was in Dunmore.", 40.01329),
    ],
)
def test_of_two_places_the_told_control_or_town_decides(told: str, latitude: float) -> None:
    place, _ = laid(f"V1 was northbound on Park Street. V2 was eastbound on Elm Street. {told} {MET}")
    assert place.origin
    assert place.origin[0] == pytest.approx(latitude, abs=1e-4)


def test_overlapping_extracts_have_one_place(tmp_path: Path) -> None:
    again = tmp_path / "again.osm"
    again.write_text((settings.CONFIGS / "extracts" / "streets.osm").read_text())
    assert laid(
        f"V1 was northbound on N Maple St. V2 was eastbound on East 5th Ave. {MET}", TOWN, read_street_map(again)
    )[0].found


# ------------------------------------------------------------------ any junction
COUNTS = st.integers(1, 3)


@st.composite
def crossings(draw: st.DrawFn) -> tuple[Sketch, str, dict[int, tuple[int, int]]]:
    """A junction of two streets at any headings, a report that drives along them, and heading -> lanes in, out."""
    first = draw(st.integers(0, 179))
    second = first + draw(st.integers(50, 130))
    made, legs = Sketch(), dict[int, tuple[int, int]]()
    ways = list[str]()
    stem = draw(st.booleans())
    for name, axis, whole in (("Alder Street", first, True), ("Birch Avenue", second, not stem)):
        ahead, back = draw(COUNTS), draw(COUNTS)
        points = [polar(axis + 180, 120), (0.0, 0.0), *([polar(axis, 120)] if whole else [])]
        made.street(name, points, lanes__forward=str(ahead), lanes__backward=str(back), lanes=str(ahead + back))
        legs[(axis + 180) % 360] = (ahead, back)
        if whole:
            legs[axis % 360] = (back, ahead)
        ways.append(COMPASS[round(axis / 45) % 8])
    assume(abs(COMPASS.index(ways[0]) - COMPASS.index(ways[1])) % 4)
    told = [
        f"V{n} was {NAMES[way]}bound on {street}."
        for n, (way, street) in enumerate(zip(ways, ("Alder St", "Birch Ave"), strict=True), 1)
    ]
    return made, " ".join([*told, "The front of V2 struck the right side of V1 in the intersection."]), legs


@rules(max_examples=many(40, 1000), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(crossings())
def test_any_junction_is_found_and_laid_as_it_lies(
    tmp_path: Path, drawn: tuple[Sketch, str, dict[int, tuple[int, int]]]
) -> None:
    made, text, legs = drawn
    place, layout = laid(text, made.written(tmp_path))
    assert place.found, place.reason
    assert len(layout.legs) == len(legs)
    for leg in layout.legs:
        heading = (45 * COMPASS.index(leg.bearing) + leg.skew_deg) % 360
        nearest = min(legs, key=lambda one: abs(math.remainder(one - heading, 360)))
        assert abs(math.remainder(nearest - heading, 360)) <= 1
        assert (leg.lanes_in, leg.lanes_out) == legs[nearest]
    assert all(Leg.model_validate(leg.model_dump()) for leg in layout.legs)
