"""Lanes as the player drives them, against SUMO's own lane centers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.opendrive.checks.road_index import lane_index
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.playing.positions import shifted
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.distances import distance_to
from sgcad_core.geometry.plane import wrap_angle
from tests.sgcad_core.formats.xosc_samples import at, bent_road, crossroads, event, lane, lane_change, row, scenario, v1


@pytest.mark.parametrize("network", [crossroads, bent_road])
def test_lanes_lie_where_sumo_has_them(network):
    graph, roads = parse_net(network().net_xml), XodrRoads(network().xodr)
    index = lane_index(network().xodr)
    for edge in graph.edges.values():
        for sumo in edge.lanes:
            road, number = index.lane(edge.id, sumo.index)
            length = index.roads[road].length_m
            assert distance_to(roads.lane_center(road, number), sumo.shape).max() < 0.25
            pose = roads.lane_pose(road, number, length / 2, 0.0)
            found = roads.nearest(pose)
            assert found[:2] == (road, number)
            assert found.s_m == pytest.approx(length / 2, abs=0.3)


def test_the_straightest_way_leads_over_a_junction():
    graph, roads = parse_net(crossroads().net_xml), XodrRoads(crossroads().xodr)
    first, last = graph.edges["W"].lanes[1].shape[0], graph.edges["-E"].lanes[1].shape[-1]
    start = roads.nearest(Pose(*first, 0.0))
    way = roads.way(start.road, start.lane, 0.0)
    assert way[0] == pytest.approx(first, abs=1e-6)
    assert way[-1] == pytest.approx(last, abs=0.01)
    assert np.ptp(way[:, 1]) < 0.01


def test_a_pose_off_the_road_or_across_has_no_lane():
    roads = XodrRoads(crossroads().xodr)
    assert roads.nearest(Pose(60, 60, 0)) is None
    assert roads.nearest(Pose(-60, -5.4, math.pi / 2)) is None


def test_who_faces_against_the_traffic_is_in_its_lane_and_drives_on_that_way():
    roads = XodrRoads(crossroads().xodr)
    place = roads.nearest(Pose(-60, -5.4, math.pi))
    assert roads.lane_pose(*place)[:2] == pytest.approx((-60, -5.4), abs=0.01)
    sense = roads.sense(place, math.pi)
    assert sense == -roads.road(place.road).sense(place.lane)
    assert roads.drive(place, sense).points[-1] == pytest.approx((-120, -5.4), abs=0.1)


@pytest.mark.parametrize(("lane_id", "by", "expected"), [(-1, 1, 1), (-1, -1, -2), (-2, 1, -1), (1, -1, -1), (1, 1, 2)])
def test_there_is_no_lane_zero(lane_id, by, expected):
    assert shifted(lane_id, by) == expected


# ------------------------------------------------------------------ by hand: lines, arcs, spirals, several sections
def xodr(geometry, length, lanes="", offset=""):
    section = (
        '<laneSection s="0"><center><lane id="0" type="none"/></center><left><lane id="1" type="driving">'
        '<width sOffset="0" a="3" b="0" c="0" d="0"/></lane></left><right><lane id="-1" type="driving">'
        '<link><successor id="-1"/></link><width sOffset="0" a="4" b="0" c="0" d="0"/></lane></right></laneSection>'
    )
    return (
        f'<OpenDRIVE><road id="7" length="{length}" junction="-1"><planView>{geometry}</planView>'
        f"<lanes>{offset}{section}{lanes}</lanes></road></OpenDRIVE>"
    )


def piece(shape, s, x, y, hdg, length):
    return f'<geometry s="{s}" x="{x}" y="{y}" hdg="{hdg}" length="{length}">{shape}</geometry>'


ARC = piece('<arc curvature="0.1"/>', 0, 0, 0, 0, 10 * math.pi / 2)


def test_an_arc_is_met_to_the_millimetre():
    roads = XodrRoads(xodr(ARC, 10 * math.pi / 2))
    for share in (0.0, 0.21, 0.5, 1.0):
        angle = share * math.pi / 2
        pose = roads.road_pose("7", angle * 10, 2.0)
        expected = (8 * math.sin(angle), 10 - 8 * math.cos(angle))
        assert pose[:2] == pytest.approx(expected, abs=1e-3)
        assert pose.heading_rad == pytest.approx(angle, abs=1e-9)


def test_a_spiral_ends_where_fresnel_says():
    # clothoid from 0 to curvature 0.02 over 50 m: x = L (1 - a²/10), y = L (a/3 - a³/42), a = L k / 2
    turn = 50 * 0.02 / 2
    x = 50 * (1 - turn**2 / 10 + turn**4 / 216)
    y = 50 * (turn / 3 - turn**3 / 42 + turn**5 / 1320)
    spiral = piece('<spiral curvStart="0" curvEnd="0.02"/>', 0, 5, 5, 0, 50)
    assert XodrRoads(xodr(spiral, 50)).road_pose("7", 50, 0) == pytest.approx((5 + x, 5 + y, turn), abs=1e-3)


def test_lane_widths_offsets_and_sides_count():
    line = piece("<line/>", 0, 0, 0, 0, 100)
    roads = XodrRoads(xodr(line, 100, offset='<laneOffset s="50" a="1" b="0.02" c="0" d="0"/>'))
    assert roads.lane_pose("7", -1, 10, 0.0) == pytest.approx((10, -2, 0))
    assert roads.lane_pose("7", 1, 10, 0.25) == pytest.approx((10, 1.75, -math.pi)), "drives against s"
    assert roads.lane_pose("7", -1, 60, 0.0)[:2] == pytest.approx((60, -2 + 1.2))


def test_a_way_runs_through_lane_sections():
    line = piece("<line/>", 0, 0, 0, 0, 100)
    wide = '<lane id="-1" type="driving"><width sOffset="0" a="4" b="0.1" c="0" d="0"/></lane>'
    second = f'<laneSection s="40"><right>{wide}</right></laneSection>'
    way = XodrRoads(xodr(line, 100, second)).way("7", -1, 10)
    assert way[0] == pytest.approx((10, -2))
    assert way[-1] == pytest.approx((100, -5), abs=1e-3)


@pytest.mark.parametrize(("position", "message"), [
    (lane("99", -1, 5), r"no road '99' in the .xodr; roads: 7"),
    (lane("7", -3, 5), r"road '7' has no lane -3 at s = 5 m; lanes there: 1, -1"),
    (lane("7", -1, 500), r"s = 500 m lies beyond road '7'"),
    (lane("7", "x", 5), "'laneId' is no whole number"),
    ('<Position><RoadPosition roadId="7" s="-3" t="0"/></Position>', r"s = -3 m lies beyond road '7'"),
])  # fmt: skip
def test_a_place_that_the_network_does_not_have_is_named(position, message):
    with pytest.raises(InvalidOutput, match=message) as caught:
        play(scenario({"V1": position}), xodr(piece("<line/>", 0, 0, 0, 0, 100), 100))
    assert "in line 2" in str(caught.value)


@pytest.mark.parametrize(("text", "message"), [
    ("<OpenDRIVE/>", "no road '7'"), ("<net/>", "no OpenDRIVE file"), ("", "no well-formed XML"),
    (xodr("", 10), "has no geometry"), (xodr(piece("<poly3/>", 0, 0, 0, 0, 9), 9), "'a' is missing at <poly3>"),
    (xodr(ARC, 1e9), "longer than 20000 m"), (xodr(piece("<line/>", 0, 0, 0, 0, 1e9), 9), "length must lie within"),
])  # fmt: skip
def test_a_bad_network_is_a_clear_error(text, message):
    with pytest.raises(InvalidOutput, match=message):
        play(scenario({"V1": lane("7", -1, 5)}), text)


# ------------------------------------------------------------------ driving
def eastbound(s_m=5.0, number=-1):
    road = lane_index(crossroads().xodr).by_edge("W")
    return {"V1": lane(road.id, number, s_m)}


def test_an_actor_keeps_its_lane():
    motion = v1(scenario(eastbound(), speeds={"V1": 10}, end=at(20)), crossroads().xodr)
    assert row(motion, 0) == pytest.approx((-115, -1.8, 0, 10), abs=0.1)
    np.testing.assert_allclose(motion.y_m, -1.8, atol=0.01)
    np.testing.assert_allclose(np.diff(motion.x_m), 0.5, atol=1e-6)


def test_a_bend_is_driven_on_the_lane_center():
    road = lane_index(bent_road().xodr).by_edge("N")
    motion = v1(scenario({"V1": lane(road.id, -2, 2)}, speeds={"V1": 10}, end=at(8)), bent_road().xodr)
    center = parse_net(bent_road().net_xml).edges["N"].lanes[0].shape
    points = np.column_stack((motion.x_m, motion.y_m))
    assert distance_to(center, points[: round(road.length_m / 0.5) - 8]).max() < 0.3
    travel = np.arctan2(np.diff(motion.y_m), np.diff(motion.x_m))
    assert np.abs(wrap_angle(travel - motion.heading_rad[1:])).max() < 0.05


@pytest.mark.parametrize(("over", "dimension", "arrives"), [
    (3, "time", 4.0), (30, "distance", 4.0), (1.2, "rate", None),
])  # fmt: skip
def test_a_lane_change_ends_on_the_next_lane(over, dimension, arrives):
    change = event("e", lane_change(-1, over, dimension), at(1))
    motion = v1(scenario(eastbound(), change, {"V1": 10}, end=at(8)), crossroads().xodr)
    assert row(motion, 1.0)[1] == pytest.approx(-1.8, abs=0.01)
    assert motion.y_m[-1] == pytest.approx(-5.4, abs=0.01)
    assert np.diff(motion.y_m).max() < 1e-3, "never back"
    if arrives:
        assert row(motion, arrives - 1.5)[1] == pytest.approx(-3.6, abs=0.1)
        assert row(motion, arrives)[1] == pytest.approx(-5.4, abs=0.01)
    else:
        assert -np.diff(motion.y_m).min() / 0.05 == pytest.approx(1.2, rel=0.02)


def test_a_lane_change_into_nowhere_is_named():
    with pytest.raises(InvalidOutput, match="has no lane -3"):
        play(scenario(eastbound(number=-2), event("e", lane_change(-1, 3), at(1))), crossroads().xodr)


def test_a_neighbor_lane_is_relative_to_an_entity():
    beside = '<Position><RelativeLanePosition entityRef="V1" dLane="-1" ds="10" offset="0.5"/></Position>'
    _, second = play(scenario({**eastbound(), "V2": beside}), crossroads().xodr)
    assert (second.x_m[0], second.y_m[0]) == pytest.approx((-105, -4.9), abs=0.2)
