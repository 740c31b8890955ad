"""Skewed and offset crossings are drawn as they are told."""

import math

import pytest

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.lane_graph import network_figures
from sgcad_core.roads.layout import road_spec

SKEWED = {
    "V1 was northbound at a four-leg intersection. The east/west road crosses at a 60-degree angle.": 30,
    "V1 was northbound. A side road joins from the east at a skewed angle at a T-intersection. V2 was westbound.": 30,
    "V1 was northbound and entered a skewed four-leg intersection. V2 was westbound.": 30,
    "V1 was northbound and entered a four-leg intersection. V2 was westbound. V1 struck V2 at an angle.": 0,
}


@pytest.mark.parametrize(("text", "skew_deg"), SKEWED.items())
def test_the_crossing_road_misses_the_right_angle_by_as_much_as_is_told(text: str, skew_deg: int) -> None:
    skew = {leg.bearing: leg.skew_deg for leg in layout_of_facts(read(text).roads).legs}
    axes = {tuple(skew[at] for at in axis if at in skew) for axis in (("N", "S"), ("E", "W"))}
    assert {angle for axis in axes for angle in axis} == {0, skew_deg}
    assert all(len(set(axis)) == 1 for axis in axes), "both legs of a road lie on one line"


@pytest.mark.parametrize("skew_deg", [-40, 25])
def test_a_skewed_leg_lies_that_far_clockwise_of_its_bearing(skew_deg: int) -> None:
    legs = [Leg(bearing=at, lanes_in=1, lanes_out=1) for at in ("N", "S")]
    side = Leg(bearing="E", lanes_in=1, lanes_out=1, skew_deg=skew_deg)
    spec = road_spec(RoadLayout(legs=(*legs, side)))
    end = next(node for node in spec.nodes if node.id == "E_end")
    assert math.degrees(math.atan2(-end.y_m, end.x_m)) == pytest.approx(skew_deg, abs=0.01)
    assert compile_network(plain_xml(spec), spec).xodr


def test_an_offset_crossing_is_two_t_junctions() -> None:
    text = "V1 was traveling north, approaching an offset intersection. V2 was traveling west on the crossing road."
    layout = layout_of_facts(read(text).roads)
    assert len(layout.legs) == 3
    assert [access.kind for access in layout.accesses] == ["road"]
    spec = road_spec(layout)
    figures = network_figures(parse_net(compile_network(plain_xml(spec), spec).net_xml or ""))
    assert figures.intersections == 2


def test_an_offset_impact_is_no_offset_crossing() -> None:
    facts = read("V1 was northbound and entered a four-leg intersection. The offset frontal impact was severe.").roads
    assert layout_of_facts(facts).accesses == ()
