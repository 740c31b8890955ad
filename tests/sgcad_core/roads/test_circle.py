"""Roundabouts: one circle around which one drives counterclockwise, in both files, in routes and in words."""

from __future__ import annotations

import math

import pytest
from lxml import etree

from plugins.road_writer.template import Template
from plugins.scenario_writer.rules import Rules
from plugins.validator.sumo_load import SumoLoad
from plugins.validator.topology import Topology
from research.benchmarks.scenes.reimport import differences
from sgcad_core.case.records import Context, CrashReport, Evidence, RoadNetwork
from sgcad_core.formats.agreement import network_disagreements
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.sumo.net_xml import network_figures, parse_net, segments
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.planner.lines.route import find_route
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Access, Actor, Compass, Leg, RoadLayout, centers
from sgcad_core.roads.describe import describe_network, road_ids
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.layout import road_spec

Legs = list[tuple[Compass, int, int]]
FOUR: Legs = [("N", 1, 1), ("E", 1, 1), ("S", 1, 1), ("W", 1, 1)]
WIDE: Legs = [("N", 2, 2), ("E", 3, 2), ("S", 2, 2), ("W", 1, 1)]
CASES = [(FOUR, 1), (WIDE, 2), (FOUR[:3], 1), ([("N", 1, 1), ("S", 1, 1)], 1), ([*FOUR, ("NE", 1, 1), ("SE", 1, 0)], 2)]


def layout(legs: Legs, lanes: int = 1) -> RoadLayout:
    made = tuple(Leg(bearing=at, lanes_in=inward, lanes_out=out) for at, inward, out in legs)
    return RoadLayout(legs=made, circle_lanes=lanes)


def network(legs: Legs, lanes: int = 1) -> RoadNetwork:
    spec = road_spec(layout(legs, lanes))
    return compile_network(plain_xml(spec), spec)


def graph(legs: Legs, lanes: int = 1) -> LaneGraph:
    return parse_net(network(legs, lanes).net_xml or "")


@pytest.mark.parametrize(("legs", "lanes"), CASES)
def test_a_roundabout_passes_what_roads_pass(legs: Legs, lanes: int) -> None:
    net = network(legs, lanes)
    assert net.net_xml, net.log
    assert net.xodr, net.log
    evidence = Evidence(report=CrashReport(case="c", narrative=""))
    assert not [f.line() for v in (SumoLoad(), Topology()) for f in v.findings(net, evidence)]
    assert xodr_findings(net.xodr) == []
    assert network_disagreements(parse_net(net.net_xml), net.xodr) == []
    assert differences(net.net_xml, net.xodr, "sgcad") == []


@pytest.mark.parametrize(("legs", "lanes"), CASES)
def test_every_leg_leads_to_every_other_and_back_to_itself(legs: Legs, lanes: int) -> None:
    net = graph(legs, lanes)
    for start, inward, _ in legs:
        for end, _, out in legs:
            if inward and out:
                maneuver = "u_turn" if start == end else "straight"
                actor = Actor(id="V1", kind="car", road=start, direction="forward", exit_road=end, maneuver=maneuver)
                route = find_route(net, actor)
                assert not route.astray
                assert f"-{end}" in [way.id for way in route.ways]
                around = [way.id for way in route.ways[route.start :] if way.id.startswith("circle")]
                assert around, "one drives around"
                linked = [
                    (a, b) for a, b in zip(route.ways[route.start :], route.ways[route.start + 1 :], strict=False)
                ]
                assert all(any(c.to_edge == b.id for c in net.leaving(a.id)) for a, b in linked)


def test_one_drives_around_counterclockwise() -> None:
    for edge in graph(FOUR).edges.values():
        if edge.id.startswith("circle"):
            (x, y), (u, v) = edge.lanes[0].shape[0], edge.lanes[0].shape[-1]
            assert x * v - y * u > 0


@pytest.mark.parametrize(("lanes", "across"), [(1, 41.0), (2, 61.8)])
def test_the_inscribed_circle_has_the_usual_size(lanes: int, across: float) -> None:
    net = graph(WIDE if lanes == 2 else FOUR, lanes)
    outer = max(
        math.hypot(*p) + lane.width_m / 2
        for edge in net.edges.values() if net.is_around(edge) for lane in edge.lanes for p in lane.shape
    )  # fmt: skip
    assert 2 * outer == pytest.approx(across, abs=1.0)


def test_who_enters_yields_and_who_is_around_goes_first() -> None:
    net = network(FOUR)
    states = {c.from_edge: c.state for c in parse_net(net.net_xml or "").connections}
    assert {at: states[at] for at in "NESW"} == dict.fromkeys("NESW", "m")
    assert all(state == "M" for edge, state in states.items() if edge.startswith("circle"))
    root = etree.fromstring((net.xodr or "").encode())
    assert [s.get("type") for s in root.iterfind("road/signals/signal")] == ["R1-2"] * 4
    group = root.find("junctionGroup")
    assert group.get("type") == "roundabout"
    assert len(group.findall("junctionReference")) == 4


def test_a_roundabout_is_one_intersection_and_its_pieces_are_no_roads() -> None:
    net = graph(WIDE, 2)
    assert network_figures(net).intersections == 1
    assert network_figures(net).segments == 4
    assert sorted(str(s["id"]) for s in segments(net)) == ["E", "N", "S", "W"]


def test_inner_lanes_go_out_where_the_exit_has_room_and_go_on_where_it_has_not() -> None:
    net = graph(WIDE, 2)
    out = {(c.from_lane, c.to_edge, c.to_lane) for c in net.connections if c.to_edge in ("-W", "-S")}
    assert out == {(0, "-W", 0), (0, "-S", 0), (1, "-S", 1)}


def test_a_driveway_keeps_clear_of_the_splitter_island() -> None:
    spec = road_spec(layout(FOUR).model_copy(update={"accesses": (Access(leg="S", side="left", distance_m=15),)}))
    joint = next(node for node in spec.nodes if node.id == "S_joint")
    assert joint.y_m == pytest.approx(-63.0)
    assert compile_network(plain_xml(spec), spec).xodr


def test_words_for_a_model_name_the_roundabout_and_not_its_pieces() -> None:
    spec = road_spec(layout(FOUR))
    assert road_ids(spec) == ["N", "E", "S", "W"]
    text = describe_network(spec)
    assert "circle" not in text
    assert "roundabout, who enters yields): left to W, straight to S, right to E" not in text.split("road S")[0]
    assert "(roundabout, who enters yields): left to E, straight to S, right to W" in text.split("road E")[0]
    assert len(set(centers(spec).values())) == 1


# ------------------------------------------------------------------ in reports
TOLD = {
    "V1 was northbound and entered a roundabout. V1 struck the rear of V2.": 1,
    "The crash occurred in a two-lane rotary. V1 was circulating and struck the right side of V2.": 2,
    "V1 was traveling north, approaching a single-lane traffic circle, and struck the rear of V2.": 1,
    "V1 was northbound in the inner lane of a roundabout. V2 was in the outer lane. V1 struck the left side of V2.": 2,
    "V1 was traveling on a four-lane, two-way road and was yielding at the roundabout. V2 struck the rear of V1.": 2,
}
PASSED = (
    "V1 was northbound on a two-lane street. It had passed a roundabout a mile before. V1 struck the rear of V2.",
    "V1 was northbound and struck the rear of V2. The driver of V1 said he knew the rotary well.",
)


@pytest.mark.parametrize(("text", "lanes"), TOLD.items())
def test_a_report_of_a_crash_in_a_roundabout_gets_one(text: str, lanes: int) -> None:
    facts = read(text).roads
    assert facts.junction.kind == "roundabout"
    assert facts.junction.stated
    assert layout_of_facts(facts).circle_lanes == lanes


@pytest.mark.parametrize("text", PASSED)
def test_a_roundabout_in_passing_makes_none(text: str) -> None:
    assert layout_of_facts(read(text).roads).circle_lanes == 0


def test_the_lanes_around_are_those_of_no_road() -> None:
    facts = read("V1 was traveling north and entered a single-lane roundabout. V1 struck the rear of V2.").roads
    assert [road.lanes.total for road in facts.roads] in ([], [None])


CRASHES = (
    "The crash occurred at a single-lane roundabout. V1 was traveling north and was entering the roundabout. V2 was "
    "traveling east and was circulating in the roundabout. The front of V1 struck the right side of V2.",
    "V1 was northbound approaching a roundabout. V2 was also northbound, ahead of V1, and was stopped at the entrance "
    "to the roundabout, yielding to traffic. The front of V1 struck the back of V2.",
    "V1 entered a traffic circle heading south and turned left. V2 was entering the traffic circle from the south, "
    "heading north. The front of V2 struck the right side of V1.",
)


@pytest.mark.parametrize("text", CRASHES)
def test_the_contact_that_is_told_happens(text: str) -> None:
    context = Context(narrative=text)
    net = Template().write(context, (), (), None, 1)  # type: ignore[arg-type]
    scenario = Rules().write(context, (), (), None, 1, net)  # type: ignore[arg-type]
    assert scenario.oddity < 0.5
    assert scenario.declared is not None
    assert not [note for note in scenario.notes if "cannot" in note]
