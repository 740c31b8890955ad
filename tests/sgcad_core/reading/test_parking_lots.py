"""Parking lots: aisles with stalls in both files, cars parked square to them, and the way out of a stall."""

import math
from itertools import pairwise

import pytest
from lxml import etree

from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.layout.layout_places import parking_lot
from sgcad_core.reading.reading import read
from tests.sgcad_core.reading.place_cases import assert_passes_what_roads_pass, written

PARKED = (
    "V1 was traveling north in a parking lot. V2 was parked in a parking space in the parking lot. The front of V1 "
    "struck the back of V2."
)
BACKS = (
    "V1 was traveling north through a parking lot. V2 was backing out of a parking space. The back of V2 struck the "
    "right side of V1."
)
CROSS = (
    "The crash occurred in a parking lot. V1 was traveling eastbound in an aisle. V2 was traveling northbound in the "
    "parking lot. The front of V1 struck the left side of V2."
)
LEAVES = (
    "V1 was northbound on a two-lane street. V2 was exiting a parking lot on the east side, turning left. The front of "
    "V1 struck the left side of V2."
)


@pytest.mark.parametrize(("text", "legs"), [(PARKED, 2), (BACKS, 2), (CROSS, 4)])
def test_a_crash_inside_a_parking_lot_gets_its_aisles(text: str, legs: int) -> None:
    layout = layout_of_facts(read(text).roads)
    assert len(layout.legs) == legs
    assert {(leg.kind, leg.beside) for leg in layout.legs} == {("driveway", ("parking",))}


def test_who_comes_out_of_a_parking_lot_crashes_on_the_street() -> None:
    facts = read(LEAVES).roads
    assert facts.junction.kind == "driveway"
    assert all("parking" not in leg.beside for leg in layout_of_facts(facts).legs)


@pytest.mark.parametrize("text", [PARKED, BACKS, CROSS])
def test_aisles_pass_what_roads_pass(text: str) -> None:
    net, _ = written(text)
    assert_passes_what_roads_pass(net)


def test_stalls_lie_square_to_the_aisle_and_do_not_overlap() -> None:
    net, _ = written(PARKED)
    root = etree.fromstring((net.xodr or "").encode())
    stalls = root.findall("road/objects/object[@type='parkingSpace']")
    assert len(stalls) == 4 * 29  # on both sides of two legs of 80 m
    for stall in stalls:
        assert abs(float(stall.get("hdg"))) == pytest.approx(math.pi / 2)
        assert (float(stall.get("width")), float(stall.get("length"))) == (2.7, 5.5)
        assert abs(float(stall.get("t"))) == pytest.approx(3.6 + 5.5 / 2)
    places = sorted(float(stall.get("s")) for stall in stalls[:29])
    assert min(b - a for a, b in pairwise(places)) == pytest.approx(2.7)


def test_a_parked_car_stands_square_to_the_aisle_in_a_stall() -> None:
    net, made = written(PARKED)
    parked = next(t for t in made.planned if t.actor == "V2")
    assert math.sin(parked.heading_rad[0]) == pytest.approx(0.0, abs=1e-6)
    assert parked.x_m[0] == pytest.approx(3.6 + 5.5 / 2, abs=0.05)
    assert made.declared is not None
    assert net.layout is not None
    assert {leg.beside for leg in net.layout.legs} == {("parking",)}


@pytest.mark.parametrize(("facing", "way"), [("north", (0.0, 1.0)), ("east", (1.0, 0.0)), ("south", (0.0, -1.0))])
def test_who_is_parked_in_a_stall_faces_as_told_and_the_aisle_lies_square_to_it(facing: str, way: tuple) -> None:
    text = (f"The crash occurred in a parking lot. V1 was parked in a parking space, facing {facing}. V2 was driving "
            "through the parking lot. The right side of V2 struck the back of V1.")  # fmt: skip
    net, made = written(text)
    parked = next(t for t in made.planned if t.actor == "V1")
    assert (math.cos(parked.heading_rad[0]), math.sin(parked.heading_rad[0])) == pytest.approx(way, abs=1e-3)
    aisles = {"N", "S"} if facing == "east" else {"E", "W"}
    assert net.layout is not None
    assert {leg.bearing for leg in net.layout.legs} == aisles


def test_a_told_aisle_stays_beside_one_along_which_nobody_is_told_to_drive() -> None:
    facts = read("The crash occurred in a parking lot. V1 was northbound. The front of V1 struck V2.").roads
    assert {leg.bearing for leg in parking_lot(facts, "E").legs} == set("NESW")


def test_who_backs_out_tells_the_aisle_in_which_another_is_parked() -> None:
    text = ("The crash occurred in a parking lot. V1 was parked, facing northwest. V2, facing northeast, was "
            "backing out of a parking stall. The rear of V2 struck the right side of V1.")  # fmt: skip
    net, made = written(text)
    assert net.layout is not None
    assert {leg.bearing for leg in net.layout.legs} == {"NW", "SE"}
    first = {t.actor: math.degrees(t.heading_rad[0]) % 360 for t in made.planned}
    assert first == {"V1": pytest.approx(135, abs=1), "V2": pytest.approx(45, abs=25)}


def test_one_who_backs_out_stands_in_his_stall_first_and_strikes_with_his_back() -> None:
    _, made = written(BACKS)
    backing = next(t for t in made.planned if t.actor == "V2")
    assert made.oddity < 0.5
    assert backing.speed_mps[0] == 0.0
    assert math.cos(backing.heading_rad[0]) == pytest.approx(1.0, abs=0.05)  # nose east, away from the aisle
    nose, tail = (backing.x_m[0] + side * 2.35 for side in (1, -1))
    assert 3.6 < tail < nose < 9.2, "it stands in its stall"
    assert not [note for note in made.notes if "cannot" in note]
