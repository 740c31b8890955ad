"""Turning a network: lengths stay, legs come to lie as wanted."""

import math
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.case.records import PlainXml
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.sumo.turning import best_turn, turned_network, with_longer_ends
from sgcad_core.roads.junction_words import JunctionLeg

ANGLES = st.floats(-math.pi, math.pi, allow_nan=False)
LEGS = st.lists(st.tuples(st.integers(0, 7), st.integers(0, 4), st.integers(0, 4)), min_size=1, max_size=5,
                unique_by=lambda leg: leg[0])  # fmt: skip
PLAIN = PlainXml(
    nodes='<nodes><node id="a" x="3" y="4"/><node id="b" x="-5.5" y="12"/></nodes>',
    edges='<edges><edge id="R" from="a" to="b" shape="3,4 1.5,8 -5.5,12"/></edges>',
    connections="<connections/>",
)


def legs_of(drawn: list[tuple[int, int, int]], turn: float = 0.0) -> list[JunctionLeg]:
    return [JunctionLeg(math.remainder(i * math.pi / 4 + turn, math.tau), a, b) for i, a, b in drawn]


@given(LEGS, ANGLES)
@settings(max_examples=60, deadline=None)
def test_a_junction_that_was_turned_is_turned_back(drawn: list[tuple[int, int, int]], turn: float) -> None:
    found, off = best_turn(legs_of(drawn, turn), legs_of(drawn))
    assert off == pytest.approx(0, abs=1e-6)
    wanted = [leg.angle_rad for leg in legs_of(drawn)]
    for leg in legs_of(drawn, turn):  # a symmetric junction may lie otherwise, but never between its bearings
        assert min(abs(math.remainder(leg.angle_rad + found - w, math.tau)) for w in wanted) < 1e-6


def test_lanes_decide_between_turns_that_lie_equally_well() -> None:
    found = [JunctionLeg(0.0, 1, 1), JunctionLeg(math.pi, 3, 3)]
    wanted = [JunctionLeg(0.0, 3, 3), JunctionLeg(math.pi, 1, 1)]
    turn, off = best_turn(found, wanted)
    assert abs(turn) == pytest.approx(math.pi)
    assert off == pytest.approx(0, abs=1e-9)


def test_only_multiples_of_a_step_are_taken_where_one_is_given() -> None:
    turn, off = best_turn([JunctionLeg(math.radians(10), 1, 1)], [JunctionLeg(math.radians(50), 1, 1)], math.pi / 4)
    assert turn == pytest.approx(math.pi / 4)
    assert off == pytest.approx(math.radians(5))


def test_a_leg_that_is_not_there_costs_half_a_turn() -> None:
    one, two = [JunctionLeg(0.0, 1, 1)], [JunctionLeg(0.0, 1, 1), JunctionLeg(math.pi, 1, 1)]
    assert best_turn(one, two) == (0.0, pytest.approx(math.pi / 2))


def test_nothing_to_compare_is_not_turned() -> None:
    assert best_turn([], [JunctionLeg(0.0, 1, 1)]) == (0.0, 0.0)


@given(ANGLES)
@settings(max_examples=30, deadline=None)
def test_a_turn_keeps_every_distance(turn: float) -> None:
    def points(plain: PlainXml) -> list[tuple[float, float]]:
        shape = re.findall(r'shape="([^"]*)"', plain.edges)[0]
        named = re.findall(r'x="([^"]*)" y="([^"]*)"', plain.nodes)
        return [(float(x), float(y)) for x, y in [*named, *(p.split(",") for p in shape.split())]]

    before, after = points(PLAIN), points(turned_network(PLAIN, turn))
    for i in range(len(before)):
        for k in range(i):
            assert math.dist(after[i], after[k]) == pytest.approx(math.dist(before[i], before[k]), abs=0.01)


def test_no_turn_changes_no_byte() -> None:
    assert turned_network(PLAIN, 0.0) is PLAIN


def test_what_is_no_xml_is_invalid_output() -> None:
    with pytest.raises(InvalidOutput, match="plain_xml nodes"):
        turned_network(PlainXml(nodes="<nodes>", edges="<edges/>"), 1.0)


def test_a_road_that_ends_too_soon_runs_straight_on_and_others_stay() -> None:
    nodes = '<nodes><node id="hub" x="0" y="0"/><node id="a" x="0" y="30" type="dead_end"/>' \
            '<node id="b" x="90" y="0" type="dead_end"/></nodes>'  # fmt: skip
    there, back = (
        '<edge id="A" from="a" to="hub" shape="0,30 0,0"/>',
        '<edge id="-A" from="hub" to="a" shape="2,0 2,30"/>',
    )
    edges = f'<edges>{there}{back}<edge id="B" from="b" to="hub" shape="90,0 0,0"/></edges>'
    longer = with_longer_ends(PlainXml(nodes=nodes, edges=edges), 80)
    assert 'id="a" x="0.000" y="80.000"' in longer.nodes
    assert 'id="b" x="90" y="0"' in longer.nodes
    assert 'shape="0.000,80.000 0.000,30.000 0.000,0.000"' in longer.edges
    assert 'shape="2.000,0.000 2.000,30.000 2.000,80.000"' in longer.edges
    assert 'shape="90,0 0,0"' in longer.edges
