"""Lanes that a work zone closes: read with their side, drawn in both files with cones, and left before them."""

import numpy as np
import pytest
from lxml import etree

from flows.player.road_shapes import drawing_of
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.planner.lines.actor_course import find_course
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Actor, Leg, RoadLayout
from sgcad_core.roads.areas.closures import cones, tapers
from sgcad_core.roads.layout import road_spec
from tests.sgcad_core.reading.place_cases import assert_passes_what_roads_pass, written

RIGHT = (
    "V1 was traveling north in the right lane of a divided highway with two northbound lanes. V2 was traveling north "
    "in the left lane. The right lane was closed ahead for construction. V1 merged to the left because of the lane "
    "closure, and the left side of V1 struck the right side of V2."
)
LEFT = (
    "V1 was traveling south on a divided interstate with three lanes in each direction. The two left lanes were closed "
    "due to road construction. V2 was stopped in the left lane. The front of V1, also in the left lane, struck the "
    "back of V2."
)
UNSAID = (
    "V1 was traveling east in the left lane of a four-lane divided road. V1 changed lanes to the right because of a "
    "lane closure, and its right side struck the left side of V2, which was traveling east in the right lane."
)


@pytest.mark.parametrize(("text", "leg", "closed"), [(RIGHT, "N", (1,)), (LEFT, "S", (2, 3)), (UNSAID, "E", (2,))])
def test_the_told_lanes_are_closed_ahead(text: str, leg: str, closed: tuple[int, ...]) -> None:
    layout = layout_of_facts(read(text).roads)
    assert {one.bearing: one.closed_out for one in layout.legs if one.closed_out} == {leg: closed}


@pytest.mark.parametrize(
    "text",
    [
        "V1 was traveling north in a construction zone on a two-lane, two-way road. The front of V1 struck V2.",
        "V1 was traveling north toward the intersection with Elm Street, where the right lane was closed. The front "
        "of V1 struck the back of V2.",
    ],
)
def test_a_work_zone_that_is_not_drawn_is_named(text: str) -> None:
    facts = read(text).roads
    assert "work_zone" in facts.junction.unsupported
    assert not any(leg.closed_out for leg in layout_of_facts(facts).legs)


def test_a_closed_lane_is_named_where_nobody_is_told_to_drive_any_way() -> None:
    facts = read("V1 saw too late that the lane was closed by cones. V1 hit V2 from behind.").roads
    assert facts.closed is not None or "work_zone" in facts.junction.unsupported


def test_a_lane_behind_a_stalled_truck_is_not_closed() -> None:
    text = (
        "V1 was traveling north on a four-lane road. The right lane was blocked by a truck. The front of V1 struck V2."
    )
    facts = read(text).roads
    assert facts.closed is None
    assert facts.junction.unsupported == ()


@pytest.mark.parametrize("text", [RIGHT, LEFT, UNSAID])
def test_work_zones_pass_what_roads_pass_and_the_crash_happens(text: str) -> None:
    net, made = written(text)
    assert_passes_what_roads_pass(net)
    assert "is not connected" not in net.log
    assert made.oddity < 1


def test_a_closed_lane_and_its_cones_are_in_both_files_and_in_the_drawing() -> None:
    net, _ = written(RIGHT)
    graph = parse_net(net.net_xml or "")
    (taper,) = tapers(graph)
    assert (taper.edge, taper.onward, taper.side) == ("S", "-N", -1)
    assert 20 < taper.length_m <= 75
    places = np.vstack([p for _, p in cones(graph)])
    root = etree.fromstring((net.xodr or "").encode())
    assert len(root.findall("road/objects/object[@subtype='cone']")) == len(places) > 10
    assert len(root.findall("road/lanes//lane[@type='roadWorks']")) == 1
    assert len(drawing_of(net.net_xml or "").cones) == len(places)
    x = places[places[:, 1] < 0][:, 0]
    assert (np.diff(x) < 0).all(), "cones lead from the right edge inwards"


def test_who_leaves_the_closed_lane_touches_the_other_before_the_cones_close_it() -> None:
    _, made = written(RIGHT)
    track = next(t for t in made.planned if t.actor == "V1")
    assert made.declared is not None
    contact = int(np.argmin(abs(track.t_s - 4.2)))
    assert track.y_m[contact] < 0
    assert track.x_m[contact] < track.x_m[0] - 1.0, "it moves to the left"


@pytest.mark.parametrize("closed", [(1,), (3,)])
def test_who_is_not_told_to_change_lanes_leaves_a_closed_lane_along_the_taper(closed: tuple[int, ...]) -> None:
    legs = (Leg(bearing="S", lanes_in=3, lanes_out=3), Leg(bearing="N", lanes_in=3, lanes_out=3, closed_out=closed))
    spec = road_spec(RoadLayout(legs=legs))
    graph = parse_net(compile_network(plain_xml(spec), spec).net_xml or "")
    actor = Actor.model_validate(
        {"id": "V1", "kind": "car", "road": "S", "direction": "forward", "lane": closed[0], "exit_road": "N",
         "maneuver": "straight"}
    )  # fmt: skip
    points = find_course(graph, actor).path.points
    beyond = points[points[:, 1] > 2]
    open_lane = next(lane for lane in graph.edges["-N"].lanes if lane.index == 1)
    assert len(beyond) > 10
    assert abs(beyond[:, 0] - open_lane.shape[0, 0]).max() < 0.3


def test_a_road_keeps_a_lane_open() -> None:
    legs = (Leg(bearing="S", lanes_in=1, lanes_out=1), Leg(bearing="N", lanes_in=1, lanes_out=1, closed_out=(1,)))
    with pytest.raises(InvalidOutput, match="no such lanes can be closed"):
        plain_xml(road_spec(RoadLayout(legs=legs)))
