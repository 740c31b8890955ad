"""The template writer compiles any narrative to a network; only a text without a crash is refused."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.road_writer.template import Template
from sgcad_core.case.records import Context, Generation, Query, RoadNetwork
from sgcad_core.errors import Refused
from sgcad_core.formats.sumo.net_xml import LaneGraph, network_figures, parse_net


def never(context: Context, query: Query) -> Generation:
    raise AssertionError("a template asks no model")


def write(text: str, **fields: object) -> RoadNetwork:
    return Template.model_validate(fields).write(Context(narrative=text), (), (), never, 1)


def graph(network: RoadNetwork) -> LaneGraph:
    assert network.net_xml, network.log
    return parse_net(network.net_xml)


def test_a_crossing_compiles_with_its_lanes() -> None:
    text = ("V1, a 2001 Ford Focus, was traveling north on a four-lane, two-way road and was approaching a four-leg "
            "intersection. V2, a 1999 Honda Civic, was traveling west on the intersecting two-lane road.")  # fmt: skip
    network = write(text)
    figures = network_figures(graph(network))
    assert (figures.intersections, figures.components, figures.mean_lanes) == (1, 1, 1.5)
    assert network.xodr
    assert network.spec


def test_a_plain_road_has_no_intersection() -> None:
    figures = network_figures(graph(write("V1 was traveling east on a two-lane road and struck the rear of V2.")))
    assert (figures.intersections, figures.mean_lanes) == (0, 1.0)


def test_fields_stand_in_for_what_the_report_leaves_out() -> None:
    spec = write("V1 struck V2 on a street.", lanes_each_way=3, leg_length_m=100, speed_limit_mph=25).spec
    assert spec
    assert {(r.lanes_forward, r.lanes_backward, r.speed_limit_mph) for r in spec.roads} == {(3, 3, 25)}
    assert {round(abs(n.x_m) + abs(n.y_m)) for n in spec.nodes} == {0, 100}


def test_the_log_begins_with_what_was_assumed() -> None:
    assert write("V1 struck V2 on a street.").log.startswith("template: the")


def test_units_in_a_parking_lot_are_vehicles_though_no_vehicle_is_named() -> None:
    spec = write("Unit 1 was backing out of a parking stall. The back of Unit 1 hit the right side of Unit 2.").spec
    assert spec is not None
    assert spec.roads


@pytest.mark.parametrize("text", ["", "   ", "The patient slept well and ate breakfast.", "12345"])
def test_a_text_without_vehicle_or_road_is_refused(text: str) -> None:
    with pytest.raises(Refused, match="neither a vehicle nor a road") as refusal:
        write(text)
    assert refusal.value.missing


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("El coche circulaba por la avenida y fue golpeado por otro que venía en sentido contrario.", "not in English"),
        ("Case 1: V1 hit V2 on a two-lane road.\nCase 2: V1 hit a tree.", "holds 2 reports"),
        ("Acme is filing this report under Standing General Order 7 about a vehicle.", "no account of the crash"),
    ],
)
def test_a_text_that_is_no_report_is_refused_before_a_road_is_drawn(text: str, reason: str) -> None:
    with pytest.raises(Refused, match=reason):
        write(text)


STORY = """
V1 V2 traveling north eastbound west a two-lane three-lane road intersection T-intersection driveway ramp freeway
stop sign left turned one-way divided median in each direction two lanes of struck . , from onto curve to the
"""


@given(st.lists(st.sampled_from(STORY.split()), max_size=40).map(" ".join))
@settings(max_examples=25, deadline=None)
def test_any_babble_of_a_crash_compiles_to_one_network(text: str) -> None:
    figures = network_figures(
        graph(write("There was a crash of the one and the other on the road. It was so: " + text))
    )
    assert figures.components == 1
    assert figures.intersections <= 1
