"""Curbs, ditches and embankments that a report tells lie beside the roads, in the files and on the pictures."""

from __future__ import annotations

import numpy as np
import pytest
from lxml import etree

from flows.player.road_shapes import drawing_of
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.records.specs import ToldRoad
from sgcad_core.roads.areas.roadside import WITHIN_M, ground_beside, roadsides
from sgcad_core.roads.surface import road_surface
from tests.sgcad_core.reading.place_cases import assert_passes_what_roads_pass, written

DEPARTS = (
    "V1 was traveling north on a two-lane road. V1 departed the road to the {side}, struck the curb, went down an "
    "embankment and struck a tree with its front."
)
MEDIAN = (
    "V1 was traveling west on a four-lane divided road. V2 was traveling east. V1 departed the road to the left, "
    "struck the curb and crossed the median. The front of V2 struck the right side of V1."
)


@pytest.mark.parametrize(("side", "east"), [("right", True), ("left", False)])
def test_ground_lies_on_the_told_side_and_passes_what_roads_pass(side: str, east: bool) -> None:
    net, _ = written(DEPARTS.format(side=side))
    assert net.net_xml
    assert net.xodr
    graph = parse_net(net.net_xml)
    strips = roadsides(graph)
    slopes = [strip for strip in strips if strip.kind == "embankment"]
    assert slopes
    assert all((strip.corners[:, 0] > 0).all() == east for strip in slopes)
    assert {bool(strip.corners[0, 0] > 0) for strip in strips if strip.kind == "curb"} == {True, False}
    for strip in strips:
        off = road_surface(graph).off(strip.inner)[0]
        assert np.allclose(off, WITHIN_M[strip.kind][0], atol=0.02)
    objects = etree.fromstring(net.xodr.encode()).findall("road/objects/object[@type='none']")
    assert sorted(o.get("name") or "" for o in objects) == sorted(strip.kind for strip in strips)
    assert [kind for kind, _ in drawing_of(net.net_xml).grounds] == [strip.kind for strip in strips]
    assert_passes_what_roads_pass(net)


def test_a_median_has_curbs_too() -> None:
    net, _ = written(MEDIAN)
    assert net.net_xml
    assert {(strip.edge[:1] == "-", strip.side) for strip in roadsides(parse_net(net.net_xml))} >= {
        (False, 1),
        (False, -1),
    }


def test_a_box_reaches_ground_only_beside_it() -> None:
    net, _ = written(DEPARTS.format(side="right"))
    strip = next(s for s in roadsides(parse_net(net.net_xml or "")) if s.kind == "embankment" and s.side < 0)
    x, y = strip.inner[len(strip.inner) // 2]
    on_it, on_the_road, beyond_its_end = (x, y, 1.57), (x - 6.0, y, 1.57), (x, y + 500.0, 1.57)
    assert strip.is_reached(np.array([on_it]), (4.7, 1.8))
    assert not strip.is_reached(np.array([on_the_road, beyond_its_end]), (4.7, 1.8))


@pytest.mark.parametrize(("told", "apart", "words"), [
    (ToldRoad(ground=("ditch",)), False, "right:ditch"),
    (ToldRoad(ground=("ditch",)), True, "right:ditch left:ditch"),
    (ToldRoad(ground=("ditch",), ground_side="E"), False, "right:ditch"),
    (ToldRoad(ground=("ditch",), ground_side="NE"), False, "right:ditch"),
    (ToldRoad(ground=("ditch",), ground_side="W"), False, ""),
    (ToldRoad(ground=("ditch", "curb"), ground_side="W"), True, "right:curb left:ditch left:curb"),
    (ToldRoad(), True, ""),
])  # fmt: skip
def test_an_edge_names_what_lies_beside_it(told: ToldRoad, apart: bool, words: str) -> None:
    assert ground_beside(told, np.array([[0.0, 0.0], [0.0, 50.0]]), apart=apart) == words
