"""Openings in medians: read, drawn with ways round in both files, and driven through by who turns round."""

import numpy as np
import pytest
from lxml import etree

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read
from tests.sgcad_core.reading.place_cases import assert_passes_what_roads_pass, written

ACROSS = (
    "V1 was traveling north in the left lane of a divided highway with two lanes in each direction and a grass median. "
    "V2 was traveling south. V2 made a U-turn through a median opening into the northbound lanes. The front of V1 "
    "struck the right side of V2."
)
WAITS = (
    "V1 was traveling west in the inside lane of a four-lane highway with a raised median. V2 was stopped westbound in "
    "the inside lane, waiting to make a U-turn at a break in the median. The front of V1 struck the back of V2."
)
BARE = (
    "V2 was traveling east in the left lane of a six-lane boulevard and attempted a U-turn at the median crossover. V1 "
    "was traveling east behind V2 in the left lane. The front of V1 struck the left side of V2."
)


@pytest.mark.parametrize(("text", "median"), [(ACROSS, "grass"), (WAITS, "raised"), (BARE, "raised")])
def test_a_told_opening_is_no_junction_and_parts_a_median(text: str, median: str) -> None:
    facts = read(text).roads
    layout = layout_of_facts(facts)
    assert facts.junction.kind == "none"
    assert facts.junction.unsupported == ()
    assert layout.opening
    assert {leg.median for leg in layout.legs} == {median}


def test_an_opening_at_a_junction_is_named_and_not_drawn() -> None:
    text = (
        "V1 was traveling north on a divided highway. V2 was traveling south, entered a median opening and turned left "
        "into a driveway on the east side. The front of V1 struck the right side of V2."
    )
    facts = read(text).roads
    assert facts.junction.unsupported == ("median_opening",)
    assert not layout_of_facts(facts).opening


def test_who_only_crosses_the_median_needs_no_opening() -> None:
    text = "V1 was traveling north on a divided highway and crossed the grass median. The front of V1 struck V2."
    assert read(text).roads.opening is None


def test_of_two_streets_the_one_of_the_vehicle_that_enters_a_median_has_it() -> None:
    text = (
        "V1 was traveling north toward an intersection and V2 was traveling east toward it. The front "
        "of V2 struck the left side of V1. V1 departed the roadway onto a raised median."
    )
    assert {road.axis: road.lanes.median for road in read(text).roads.roads} == {"N": "raised", "E": None}


@pytest.mark.parametrize("text", [ACROSS, WAITS, BARE])
def test_openings_pass_what_roads_pass_and_the_crash_happens(text: str) -> None:
    net, made = written(text)
    assert_passes_what_roads_pass(net)
    assert parse_net(net.net_xml).openings == ("hub",)
    assert made.oddity < 1


def test_both_files_lead_round_from_the_inner_lane_into_the_inner_lane() -> None:
    net, _ = written(ACROSS)
    round_ = [c for c in parse_net(net.net_xml or "").connections if c.direction == "u_turn"]
    assert {(c.from_edge, c.from_lane, c.to_edge, c.to_lane) for c in round_} == {("S", 1, "-S", 1), ("N", 1, "-N", 1)}
    root = etree.fromstring((net.xodr or "").encode())
    ends = [
        (road.find("link/predecessor").get("elementId"), road.find("link/successor").get("elementId"))
        for road in root.findall("road")
        if road.get("junction") != "-1"
    ]
    assert sum(a == b for a, b in ends) == 2


def test_who_turns_round_drives_through_the_opening() -> None:
    _, made = written(ACROSS)
    track = next(t for t in made.planned if t.actor == "V2")
    median = (np.abs(track.x_m) < 3.0) & (track.t_s < 6.0)
    assert median.any()
    assert np.abs(track.y_m[median]).max() < 7.5
