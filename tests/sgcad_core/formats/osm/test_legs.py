"""Junctions of two streets and their legs, drawn by hand: headings, lanes, carriageways, rings, signs."""

from pathlib import Path

import pytest

from sgcad_core.formats.osm.junctions import blocks_of, junction_at, junctions_of, nearest_point
from sgcad_core.formats.osm.legs import junction_place, street_place
from sgcad_core.formats.osm.names import street_name
from sgcad_core.formats.osm.street_map import StreetMap
from sgcad_core.geometry.globe import Plane
from sgcad_core.records.place import MapPlace
from tests.sgcad_core.formats.osm.sketches import LAT, LON, Sketch, polar


def ways(made: StreetMap, text: str) -> dict[int, int]:
    name = street_name(text)
    assert name
    return made.named(name)


def the_junction(made: StreetMap, one: str = "Alder Street", other: str = "Birch Avenue") -> MapPlace:
    (cluster,) = junctions_of(made, ways(made, one), ways(made, other))
    return junction_place(made, cluster, (one, other))


def told(place: MapPlace) -> list[tuple[int, int, int, str]]:
    return [(round(leg.heading_deg), leg.lanes_in, leg.lanes_out, leg.control) for leg in place.legs]


def crossing(first: float = 0.0, second: float = 90.0, **tags: str) -> Sketch:
    made = Sketch()
    made.street("Alder Street", [polar(first + 180, 100), (0, 0), polar(first, 100)], lanes="4")
    made.street("Birch Avenue", [polar(second + 180, 100), (0, 0), polar(second, 100)], lanes="2", **tags)
    return made


def test_a_skewed_crossing_has_four_legs_at_their_headings(tmp_path: Path) -> None:
    place = the_junction(crossing(20, 75).written(tmp_path))
    assert told(place) == [(20, 2, 2, "none"), (75, 1, 1, "none"), (200, 2, 2, "none"), (255, 1, 1, "none")]
    assert (place.latitude, place.longitude) == pytest.approx((LAT, LON), abs=1e-6)


def test_a_t_junction_has_three(tmp_path: Path) -> None:
    made = crossing()
    made.ways[1] = (made.ways[1][0][:2], made.ways[1][1])
    assert [leg[0] for leg in told(the_junction(made.written(tmp_path)))] == [0, 180, 270]


def test_a_one_way_street_has_lanes_in_its_direction_alone(tmp_path: Path) -> None:
    place = the_junction(crossing(oneway="yes").written(tmp_path))
    assert {leg[0]: leg[1:3] for leg in told(place)}[90] == (0, 2)
    assert {leg[0]: leg[1:3] for leg in told(place)}[270] == (2, 0)


def test_carriageways_of_a_divided_road_are_one_leg(tmp_path: Path) -> None:
    made = Sketch()
    made.street("Alder Street", [(0, -100), (0, -8), (0, 8), (0, 100)], lanes="2")
    made.street("Birch Avenue", [(-100, -8), (0, -8), (100, -8)], oneway="yes", lanes="3")
    made.street("Birch Avenue", [(100, 8), (0, 8), (-100, 8)], oneway="yes", lanes="2")
    place = the_junction(made.written(tmp_path))
    assert told(place) == [(0, 1, 1, "none"), (90, 2, 3, "none"), (180, 1, 1, "none"), (270, 3, 2, "none")]
    assert [leg.median for leg in place.legs] == ["none", "raised", "none", "raised"]


def test_a_roundabout_is_one_junction_whose_legs_yield(tmp_path: Path) -> None:
    made = Sketch()
    ring = [polar(a, 15) for a in range(0, 361, 30)]
    made.street("", ring, junction="roundabout", lanes="2")
    made.street("Alder Street", [polar(0, 15), polar(0, 90)])
    made.street("Alder Street", [polar(180, 15), polar(180, 90)])
    for a, b in ((60, 90), (120, 90)):  # the ends of a street that opens at the ring
        points = [polar(a, 15), polar(b, 50)]
        made.street("Birch Avenue", points if a == 60 else points[::-1], oneway="yes")
    place = the_junction(made.written(tmp_path))
    assert [leg[3] for leg in told(place)] == ["yield"] * 3
    assert (place.circle_lanes, round(place.legs[1].heading_deg / 5) * 5, place.legs[1].lanes_in) == (2, 90, 1)


def test_lights_at_the_junction_or_before_it_are_for_all(tmp_path: Path) -> None:
    at, before = crossing(), crossing()
    at.node(0, 0, highway="traffic_signals")
    before.ways[0][0].insert(1, before.node(0, -12, highway="traffic_signals"))
    for made in (at, before):
        assert {leg[3] for leg in told(the_junction(made.written(tmp_path)))} == {"signal"}


@pytest.mark.parametrize(("direction", "sign"), [("forward", "stop"), ("backward", "none"), ("", "stop")])
def test_a_stop_sign_is_for_those_who_drive_in(tmp_path: Path, direction: str, sign: str) -> None:
    made = crossing()
    tags = {"direction": direction} if direction else {}
    made.ways[1][0].insert(1, made.node(-15, 0, highway="stop", **tags))
    assert {leg[0]: leg[3] for leg in told(the_junction(made.written(tmp_path)))} == {
        0: "none",
        90: "none",
        180: "none",
        270: sign,
    }


def test_a_sign_behind_the_next_junction_is_of_that_one(tmp_path: Path) -> None:
    made = crossing()
    made.ways[1][0][0:1] = [made.node(-35, 0, highway="stop"), made.node(-25, 0)]
    made.street("Cedar Lane", [(-25, 0), (-25, 80)])
    cluster = junctions_of(
        written := made.written(tmp_path), ways(written, "Alder Street"), ways(written, "Birch Avenue")
    )
    assert {leg.control for leg in junction_place(written, cluster[0], ()).legs} == {"none"}


def test_slip_lanes_are_no_legs(tmp_path: Path) -> None:
    made = crossing()
    made.street("", [(0, -40), (40, 0)], highway="tertiary_link", oneway="yes")
    made.ways[0][0].insert(1, made.node(0, -40))
    made.ways[1][0].insert(2, made.node(40, 0))
    assert len(the_junction(made.written(tmp_path)).legs) == 4


def test_streets_that_cross_twice_have_two_junctions(tmp_path: Path) -> None:
    made = crossing()
    made.street("Birch Avenue", [(-100, 80), (0, 80), (100, 80)])
    made.ways[0][0].insert(2, made.node(0, 80))
    written = made.written(tmp_path)
    assert len(junctions_of(written, ways(written, "Alder Street"), ways(written, "Birch Avenue"))) == 2


def test_a_bridge_is_no_junction(tmp_path: Path) -> None:
    made = Sketch()
    made.street("Alder Street", [(0, -100), (0, 100)])
    made.street("Birch Avenue", [(-100, 0), (100, 0)])
    written = made.written(tmp_path)
    assert junctions_of(written, ways(written, "Alder Street"), ways(written, "Birch Avenue")) == []


def test_a_junction_is_found_by_coordinates(tmp_path: Path) -> None:
    made = crossing().written(tmp_path)
    assert junction_at(made, Plane(LAT, LON).spot(20, 20), 60)
    assert junction_at(made, Plane(LAT, LON).spot(90, 90), 60) is None


def test_a_point_of_a_street_has_two_legs(tmp_path: Path) -> None:
    made = Sketch()
    made.street(
        "Alder Street", [(0, 0), polar(30, 400)], lanes="3", lanes__forward="2", lanes__backward="1", maxspeed="40 mph"
    )
    written = made.written(tmp_path)
    near = nearest_point(written, [0], Plane(LAT, LON).spot(*polar(30, 200)))
    assert near
    place = street_place(written, near[0], ("Alder Street",), "")
    assert told(place) == [(30, 1, 2, "none"), (210, 2, 1, "none")]
    assert near[1] < 0.01


def test_the_other_carriageway_belongs_to_a_point(tmp_path: Path) -> None:
    made = Sketch()
    made.street("Alder Street", [(0, 0), (400, 0)], oneway="yes", lanes="2")
    made.street("Alder Street", [(400, 15), (0, 15)], oneway="yes", lanes="2")
    written = made.written(tmp_path)
    near = nearest_point(written, [0], Plane(LAT, LON).spot(200, 0))
    assert near
    assert told(street_place(written, near[0], (), "")) == [(90, 2, 2, "none"), (270, 2, 2, "none")]


def test_blocks_end_at_junctions_longest_first(tmp_path: Path) -> None:
    made = crossing()
    made.ways[0] = ([*made.ways[0][0], made.node(0, 300)], made.ways[0][1])
    assert [round(length) for _, length in blocks_of(made.written(tmp_path), [0])] == [300, 100]
