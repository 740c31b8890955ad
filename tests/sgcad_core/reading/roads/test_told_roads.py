"""What a report tells of drawn roads beyond their lanes."""

import pytest

from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.reading.layout.layout_facts import Defaults, layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.reading.roads.told_roads import told_roads
from sgcad_core.roads.layout import road_spec

HEAD = "V1 was traveling north on a two-lane {area}road with a posted speed limit of 72 kmph (45 mph). "
TAIL = "V2 was traveling east on a crossing two-lane road. The front of V1 struck the right side of V2."


def told(text):
    facts = read(text).roads
    spec = road_spec(layout_of_facts(facts, Defaults(1, 35)))
    return told_roads(facts, spec), spec


def test_a_told_limit_is_posted_and_a_usual_one_is_not():
    found, spec = told(HEAD.format(area="") + TAIL)
    posted = {name for name, road in found.items() if road.posted}
    assert posted == {"N", "S"}
    limits = {r.id: r.speed_limit_mph for r in spec.roads}
    assert limits["N"] == 45
    assert limits["E"] == 35  # assumed: a speed to drive by, no limit of the map
    plain = plain_xml(spec, found).edges
    assert plain.count("posted_mph 45") == 4
    assert plain.count('"assumed"') == 4


def test_a_rural_road_is_rural_and_silence_is_no_area():
    found, _ = told(HEAD.format(area="rural ") + TAIL)
    assert found["N"].area == "rural"
    assert {road.area for road in told(HEAD.format(area="") + TAIL)[0].values()} == {""}


def test_a_freeway_is_a_motorway():
    text = "V1 was northbound in lane one of a divided interstate highway. The front of V1 struck the back of V2."
    found, _ = told(text)
    assert "motorway" in {road.area for road in found.values()}


DEPARTS = (
    "V1 was traveling {heading} on a two-lane road. V1 departed the road to the {side}, went down an embankment and "
    "struck a tree."
)


@pytest.mark.parametrize(("heading", "side", "looks"), [
    ("north", "right", "E"), ("north", "left", "W"), ("southwest", "right", "NW"), ("east", "left", "N"),
])  # fmt: skip
def test_an_embankment_lies_where_the_road_is_left(heading, side, looks):
    found, _ = told(DEPARTS.format(heading=heading, side=side))
    assert {(road.ground, road.ground_side) for road in found.values()} == {(("embankment",), looks)}


def test_ground_without_a_told_side_lies_on_both():
    found, _ = told("V1 was traveling north on a two-lane road with ditches. The front of V1 struck a deer.")
    assert {(road.ground, road.ground_side) for road in found.values()} == {(("ditch",), "")}
