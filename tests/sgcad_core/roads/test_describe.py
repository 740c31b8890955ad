"""Road networks in words: what a model must know to place actors on them."""

from __future__ import annotations

import math

import pytest

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.records.specs import Access, Leg, RoadLayout
from sgcad_core.roads.describe import compass, describe_network, road_ids
from sgcad_core.roads.layout import road_spec
from tests.sgcad_core.formats.xosc_samples import crossroads

RICH = road_spec(
    RoadLayout(
        legs=(
            Leg(bearing="N", lanes_in=2, lanes_out=1, turns_in=("right", "left_through"), control="signal",
                median="grass", curve="left"),
            Leg(bearing="S", lanes_in=1, lanes_out=1, control="signal", center_turn_lane=True, speed_limit_mph=45),
            Leg(bearing="E", lanes_in=1, lanes_out=0),
        ),
        accesses=(Access(leg="S", side="left"),),
    )
)  # fmt: skip


@pytest.mark.parametrize("source", [crossroads().spec, parse_net(crossroads().net_xml)], ids=["spec", "graph"])
def test_a_crossroads_reads_alike_from_spec_and_graph(source):
    words = describe_network(source)
    assert sorted(road_ids(source)) == ["E", "N", "S", "W"]
    assert "- road S:\n  - forward: traffic heads north, 2 lanes; at hub: left to W, straight to N, right to E" in words
    assert "  - backward: traffic heads east, 2 lanes; ends at E_end" in words
    assert words.count("\n  - ") == 8


def test_a_spec_says_control_medians_limits_lane_use_and_curves():
    words = describe_network(RICH)
    assert "- road N (grass median):" in words
    assert "curving left to south, 2 lanes (lane 1 right; lane 2 left or through); at hub (traffic signal)" in words
    assert "- road S (two-way left-turn lane in the middle, 45 mph limit):" in words
    assert "- road S_access_left (driveway, minor):" in words
    assert "at S_joint: straight to S_outer, right to S_access_left" in words


def test_a_one_way_road_is_no_way_back():
    words = describe_network(RICH)
    one_way = words.split("- road E (one-way")[1].split("\n- road")[0]
    assert "forward: traffic heads west, 1 lane; at hub (traffic signal): left to S, right to N" in one_way
    assert "backward" not in one_way
    assert "to E" not in words


@pytest.mark.parametrize(("degrees", "word"), [
    (0, "east"), (44, "northeast"), (91, "north"), (180, "west"), (-180, "west"), (-90, "south"), (315, "southeast"),
])  # fmt: skip
def test_headings_have_eight_names(degrees, word):
    assert compass(math.radians(degrees)) == word
