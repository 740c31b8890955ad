"""Gores at ramps: drawn in the .xodr and the player, crossed or stood in by whom the report puts there."""

import numpy as np
import pytest
from lxml import etree
from matplotlib.path import Path as Outline

from flows.player.road_shapes import drawing_of
from sgcad_core.case.records import RoadNetwork, Scenario
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.reading.reading import read
from sgcad_core.roads.areas.gores import WIDEST_M, gores
from tests.sgcad_core.reading.place_cases import assert_passes_what_roads_pass, written

BACK = (
    "V1 was traveling north in the right lane of a freeway with two northbound lanes. V2 was traveling north on the "
    "exit ramp. V2 crossed the gore area back onto the freeway, and the left side of V2 struck the right side of V1."
)
STANDS = (
    "V1 was traveling east in the right lane of a freeway with two eastbound lanes. V2 was stopped in the gore area of "
    "the exit ramp. The front of V1 struck the back of V2."
)


def inside(net: RoadNetwork, made: Scenario, actor: str) -> np.ndarray:
    (gore,) = gores(parse_net(net.net_xml or ""))
    track = next(t for t in made.planned if t.actor == actor)
    outline = np.vstack((gore.corners, gore.corners[:1]))
    return Outline(outline).contains_points(np.column_stack((track.x_m, track.y_m)))


@pytest.mark.parametrize("text", [BACK, STANDS])
def test_a_ramp_has_its_gore_and_passes_what_roads_pass(text: str) -> None:
    net, made = written(text)
    assert net.net_xml
    assert net.xodr
    (gore,) = gores(parse_net(net.net_xml))
    half = len(gore.corners) // 2
    widths = np.hypot(*(gore.corners[:half] - gore.corners[half:][::-1]).T)
    assert widths[0] < 2.5
    assert WIDEST_M - 1 < widths[-1] < WIDEST_M + 1
    root = etree.fromstring(net.xodr.encode())
    (painted,) = root.findall("road/objects/object[@subtype='gore']")
    assert len(painted.findall("outlines/outline/cornerLocal")) == len(gore.corners)
    assert len(drawing_of(net.net_xml).gores) == 1
    assert_passes_what_roads_pass(net)
    assert made.oddity < 1


def test_who_crosses_the_gore_is_in_it_before_the_contact() -> None:
    net, made = written(BACK)
    assert inside(net, made, "V2").any()
    assert not inside(net, made, "V1").any()
    assert made.behavior is not None
    assert [(a.id, a.road, a.exit_road, a.gore) for a in made.behavior.actors] == [
        ("V1", "S", "N", False), ("V2", "S", "N", True),
    ]  # fmt: skip


def test_who_stands_in_the_gore_stands_there() -> None:
    net, made = written(STANDS)
    assert inside(net, made, "V2")[0]


def test_who_strikes_an_attenuator_in_the_gore_drives_through_the_gore() -> None:
    text = (
        "V1 was traveling south on an interstate with three southbound lanes, left its lane near the exit ramp and "
        "struck an attenuator in the gore area."
    )
    net, made = written(text)
    assert inside(net, made, "V1").any()
    assert made.declared is not None


def test_a_gore_that_nobody_is_in_is_named() -> None:
    text = "V1 was traveling north on a freeway and was near the gore point. The front of V1 struck the back of V2."
    assert "gore" in read(text).roads.junction.unsupported
    assert "gore" not in read(BACK).roads.junction.unsupported
