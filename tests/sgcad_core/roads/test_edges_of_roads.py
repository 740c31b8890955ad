"""What lies beside the lanes: bicycle and parking lanes, shoulders, sidewalks, and crosswalks that lead over them."""

from __future__ import annotations

import numpy as np
import pytest
from lxml import etree

from plugins.road_writer.template import Template
from plugins.scenario_writer.rules import Rules
from plugins.validator.sumo_load import SumoLoad
from plugins.validator.topology import Topology
from research.benchmarks.scenes.reimport import differences
from sgcad_core.case.records import Context, CrashReport, Evidence, RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.agreement import network_disagreements
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.sumo.net_xml import network_figures, parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.geometry.distances import distance_to
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.reading.roads.told_roads import told_roads
from sgcad_core.records.specs import Beside, Leg, RoadLayout
from sgcad_core.roads.layout import road_spec
from tests.effort import spread

ALL: tuple[Beside, ...] = ("sidewalk", "parking", "bike_lane")
CASES: list[tuple[tuple[Beside, ...], bool, int, int]] = [
    (("shoulder",), False, 2, 0), (ALL, False, 4, 0), (("bike_lane", "sidewalk"), True, 4, 0), (ALL, True, 3, 0),
    (("sidewalk",), True, 4, 1), (("parking", "sidewalk"), False, 2, 0),
]  # fmt: skip


def network(beside: tuple[Beside, ...], crosswalk: bool = False, legs: int = 4, circle: int = 0) -> RoadNetwork:
    made = tuple(
        Leg(bearing=at, lanes_in=2, lanes_out=1, beside=beside, crosswalk=crosswalk, control="signal")
        for at in ("N", "S", "E", "W")[:legs]  # type: ignore[arg-type]
    )
    spec = road_spec(RoadLayout(legs=made, circle_lanes=circle))
    return compile_network(plain_xml(spec), spec)


@pytest.mark.parametrize(("beside", "crosswalk", "legs", "circle"), spread(CASES, 2))
def test_roads_with_edges_pass_what_roads_pass(
    beside: tuple[Beside, ...], crosswalk: bool, legs: int, circle: int
) -> None:
    net = network(beside, crosswalk, legs, circle)
    assert net.net_xml, net.log
    assert net.xodr, net.log
    evidence = Evidence(report=CrashReport(case="c", narrative=""))
    assert not [f.line() for v in (SumoLoad(), Topology()) for f in v.findings(net, evidence)]
    assert xodr_findings(net.xodr) == []
    assert network_disagreements(parse_net(net.net_xml), net.xodr) == []
    assert [d for d in differences(net.net_xml, net.xodr, "sgcad") if d.aspect != "widths"] == []


def test_lanes_lie_outwards_in_one_order_and_count_for_no_figure() -> None:
    net = network(ALL, legs=2)
    graph = parse_net(net.net_xml or "")
    assert [lane.type for lane in graph.edges["N"].lanes] == ["sidewalk", "parking", "biking", "", ""]
    assert network_figures(graph).mean_lanes == network_figures(parse_net(network((), legs=2).net_xml or "")).mean_lanes
    root = etree.fromstring((net.xodr or "").encode())
    right = [lane.get("type") for lane in root.find("road/lanes/laneSection/right")]
    assert right == ["driving", "driving", "biking", "parking", "curb", "sidewalk"]


def test_cars_go_on_in_their_own_lanes() -> None:
    graph = parse_net(network(ALL, legs=4).net_xml or "")
    for link in graph.connections:
        kinds = {
            graph.edges[link.from_edge].lanes[link.from_lane].type,
            graph.edges[link.to_edge].lanes[link.to_lane].type,
        }
        assert kinds in ({""}, {"biking"})


def test_a_crosswalk_lies_in_the_xodr_where_it_lies_in_the_net() -> None:
    net = network(("sidewalk",), crosswalk=True)
    graph = parse_net(net.net_xml or "")
    assert len(graph.crossings) == 4
    root = etree.fromstring((net.xodr or "").encode())
    walks = root.findall("road/objects/object[@type='crosswalk']")
    assert len(walks) == 4
    for walk in walks:
        road = walk.getparent().getparent()
        start = road.find("planView/geometry")
        x, y, h = (float(start.get(k)) for k in ("x", "y", "hdg"))
        s = float(walk.get("s"))
        uv = np.array([(float(c.get("u")), float(c.get("v"))) for c in walk.iterfind("outlines/outline/cornerLocal")])
        ahead, left = np.array([np.cos(h), np.sin(h)]), np.array([-np.sin(h), np.cos(h)])
        middle = np.array([x, y]) + (s + uv[:, :1].mean()) * ahead + uv[:, 1:].mean() * left
        assert min(float(distance_to(c.shape, middle[None])[0]) for c in graph.crossings) < 0.01


def test_a_crosswalk_where_the_road_does_not_end_is_a_fault() -> None:
    spec = road_spec(
        RoadLayout(legs=(Leg(bearing="N", lanes_in=1, lanes_out=1), Leg(bearing="S", lanes_in=1, lanes_out=1)))
    )
    odd = spec.model_copy(
        update={"roads": (spec.roads[0].model_copy(update={"crosswalks": ("S_end",)}), *spec.roads[1:])}
    )
    with pytest.raises(InvalidOutput, match="the road does not end there"):
        plain_xml(odd)


# ------------------------------------------------------------------ in reports
TOLD = {
    "V1 was northbound on a two-lane street. B1 was in the bike lane. V1 struck the bicyclist.": {"bike_lane"},
    "V1 was northbound on a street with on-street parking and struck the rear of V2.": {"parking"},
    "V1 was northbound on a two-lane street. V2 was parked along the right curb. V1 struck the back of V2.": {
        "parking"
    },
    "V1 was northbound on a two-lane road with paved shoulders and struck the rear of V2.": {"shoulder"},
    "V1 was northbound on a two-lane road with no shoulder and struck the rear of V2.": set(),
    "V1 was northbound on a two-lane road and struck the rear of V2. There is no bike lane.": set(),
}


@pytest.mark.parametrize(("text", "beside"), TOLD.items())
def test_edges_of_roads_are_drawn_where_told(text: str, beside: set[str]) -> None:
    for leg in layout_of_facts(read(text).roads).legs:
        assert set(leg.beside) == beside


WALKS = "V1 was northbound on a residential street, turning left at a four-leg intersection. V1 struck a pedestrian"


@pytest.mark.parametrize("end", [" in the crosswalk.", " with its front."])
def test_a_pedestrian_at_a_junction_crosses_on_a_crosswalk(end: str) -> None:
    legs = layout_of_facts(read(WALKS + end).roads).legs
    assert all(leg.crosswalk and "sidewalk" in leg.beside for leg in legs)


def test_a_crosswalk_between_junctions_leads_over_the_road_once() -> None:
    facts = read("V1 was northbound on a two-lane street and struck a pedestrian in a marked crosswalk.").roads
    assert [leg.crosswalk for leg in layout_of_facts(facts).legs] == [True, False]


@pytest.mark.parametrize(
    ("text", "area"),
    [
        ("V1 was northbound on a residential street and struck the rear of V2.", "town"),
        ("V1 was northbound on a street with a sidewalk and struck the rear of V2.", "town"),
        ("V1 was northbound on a rural road with a bike lane and struck the rear of V2.", "rural"),
        ("V1 was northbound on a two-lane road with paved shoulders and struck the rear of V2.", ""),
    ],
)
def test_the_type_of_a_road_follows_from_what_is_told(text: str, area: str) -> None:
    facts = read(text).roads
    told = told_roads(facts, road_spec(layout_of_facts(facts)))
    assert {road.area for road in told.values()} == {area}


def scenario(text: str) -> tuple[Scenario, RoadNetwork]:
    context = Context(narrative=text)
    net = Template().write(context, (), (), None, 1)  # type: ignore[arg-type]
    return Rules().write(context, (), (), None, 1, net), net  # type: ignore[arg-type]


def test_a_pedestrian_is_struck_on_the_crosswalk() -> None:
    made, net = scenario(
        "V1 was northbound on a four-lane street and struck a pedestrian who was in a marked crosswalk. The front of "
        "V1 struck the pedestrian."
    )
    walk = parse_net(net.net_xml or "").crossings[0]
    walker = next(t for t in made.planned if t.actor == "P1")
    start = np.array([[walker.x_m[0], walker.y_m[0]]])
    assert float(distance_to(walk.shape, start)[0]) < 0.5 * walk.width_m + 8.0
    assert abs(walker.y_m[0] - walk.shape[0, 1]) < walk.width_m / 2


def test_a_parked_car_stands_in_the_parking_lane_where_nobody_must_hit_it_elsewhere() -> None:
    made, _ = scenario(
        "V1 was northbound on a two-lane street. V2 was parked along the right curb, facing north. V3 was southbound. "
        "The front of V1 struck the front of V3."
    )
    parked = next(t for t in made.planned if t.actor == "V2")
    assert parked.x_m[0] == pytest.approx(4.8, abs=0.01)
