"""Alleys: narrow roads without paint, that vehicles come out of, back out of, or meet in."""

import pytest
from lxml import etree

from flows.player.road_shapes import drawing_of
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from tests.sgcad_core.reading.place_cases import assert_passes_what_roads_pass, written

COMES_OUT = (
    "V1 was traveling east on Oak Street, a two-lane street. V2 was traveling north in an alley on the south side of "
    "the street. V2 came out of the alley and began to turn left. The front of V1 struck the left side of V2."
)
BACKS_OUT = (
    "V1 was traveling west on Pine Street. V2 was backing out of an alley on the north side of Pine Street. The back "
    "of V2 struck the right side of V1."
)
WITHIN = (
    "V1 was stopped facing north in a narrow alley behind the shops. V2 was traveling south in the alley. The front of "
    "V2 struck the front of V1."
)
TURNED_IN = (
    "V1 was parked facing east in the alley behind a store. V2 turned into the alley. V2 was traveling west in the "
    "alley and passing V1 when its left side struck the left side of V1."
)


@pytest.mark.parametrize(
    ("text", "alleys", "legs"),
    [(COMES_OUT, {"S"}, 3), (BACKS_OUT, {"N"}, 3), (WITHIN, {"N", "S"}, 2), (TURNED_IN, {"E", "W"}, 2)],
)
def test_an_alley_is_the_stem_or_the_road_of_the_crash(text: str, alleys: set[str], legs: int) -> None:
    layout = layout_of_facts(read(text).roads)
    assert len(layout.legs) == legs
    assert {leg.bearing for leg in layout.legs if leg.alley} == alleys


def test_who_leaves_a_lot_and_who_drives_on_a_street_use_no_alley() -> None:
    text = "V1 was traveling east on a street near an alley. V2 came out of a driveway. The front of V1 struck V2."
    facts = read(text).roads
    assert facts.junction.kind == "driveway"
    assert not any(leg.alley for leg in layout_of_facts(facts).legs)


@pytest.mark.parametrize("text", [COMES_OUT, BACKS_OUT, WITHIN, TURNED_IN])
def test_alleys_pass_what_roads_pass_and_the_crash_happens(text: str) -> None:
    net, made = written(text)
    assert_passes_what_roads_pass(net)
    assert made.oddity < 1


def test_an_alley_is_narrow_and_without_paint_in_every_file_and_drawing() -> None:
    net, _ = written(WITHIN)
    assert net.net_xml
    edges = parse_net(net.net_xml).edges.values()
    assert {lane.width_m for edge in edges for lane in edge.lanes} == {2.7}
    root = etree.fromstring((net.xodr or "").encode())
    assert {e.get("type") for e in root.findall("road/type")} == {"townLocal"}
    assert {e.get("type") for e in root.findall("road/lanes//roadMark")} == {"none"}
    assert not drawing_of(net.net_xml).lines
