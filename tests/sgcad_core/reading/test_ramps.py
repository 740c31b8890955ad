"""Who merges comes by the ramp, and a ramp that leads off the road is drawn ahead."""

import pytest

from plugins.road_writer.template import Template
from plugins.scenario_writer.rules import Rules
from sgcad_core.case.records import Context, Scenario
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import read

MERGES = (
    "V1 was traveling on an entrance ramp and was merging onto a four-lane divided interstate highway heading east. "
    "V2 was eastbound in the right lane of the interstate. V1 merged into the right lane and the left side of V1 "
    "struck the right side of V2."
)
LEAVES = (
    "V1 was exiting an eastbound interstate onto an exit ramp. V2 was stopped on the exit ramp ahead. The front of V1 "
    "struck the back of V2."
)


def scenario(text: str) -> Scenario:
    context = Context(narrative=text)
    net = Template().write(context, (), (), None, 1)  # type: ignore[arg-type]
    return Rules().write(context, (), (), None, 1, net)  # type: ignore[arg-type]


def test_one_told_on_a_ramp_and_changing_lanes_merges_from_the_ramp() -> None:
    made = scenario(MERGES)
    assert made.behavior is not None
    v1, v2 = made.behavior.actors
    assert (v1.road, v1.maneuver, v2.road) == ("SW", "merge", "W")
    assert made.oddity < 0.3


def test_who_merges_stays_on_the_ramp_and_the_road() -> None:
    motion = next(t for t in scenario(MERGES).planned if t.actor == "V1")
    on_ramp = motion.x_m < -15.0
    assert on_ramp.any()
    across = motion.y_m[on_ramp] - motion.x_m[on_ramp] * 0.5317  # the ramp leans by 28 degrees
    assert float(across.max() - across.min()) < 1.0
    beyond = motion.x_m > 2.0
    assert motion.y_m[beyond].min() > -18.5  # four lanes of its half of the road


@pytest.mark.parametrize(("count", "each"), [("three", 3), ("two", 2), ("four", 2)])
def test_a_freeways_lanes_are_those_of_one_carriageway_where_they_cannot_be_of_both(count: str, each: int) -> None:
    text = f"V1 was eastbound on the interstate, which has {count} lanes. The front of V1 struck the back of V2."
    assert {(leg.lanes_in, leg.lanes_out) for leg in layout_of_facts(read(text).roads).legs} == {(each, each)}


def test_one_that_merges_from_a_ramp_heads_as_the_road_that_it_joins() -> None:
    text = (
        "V2 was on the entrance ramp merging onto the eastbound interstate. V1 was in the right lane. V2 merged into "
        "the path of V1 and the left side of V2 was struck by the right front of V1."
    )
    assert [v.heading for v in read(text).roads.crash.vehicles] == ["E", "E"]


def test_an_exit_ramp_leads_off_the_road_ahead() -> None:
    legs = {leg.bearing: leg for leg in layout_of_facts(read(LEAVES).roads).legs}
    assert (legs["SE"].kind, legs["SE"].lanes_in, legs["SE"].lanes_out) == ("ramp", 0, 1)
    assert scenario(LEAVES).oddity < 0.5


def test_an_entrance_ramp_leads_onto_it() -> None:
    legs = {leg.bearing: leg for leg in layout_of_facts(read(MERGES).roads).legs}
    assert (legs["SW"].kind, legs["SW"].lanes_in, legs["SW"].lanes_out) == ("ramp", 1, 0)
