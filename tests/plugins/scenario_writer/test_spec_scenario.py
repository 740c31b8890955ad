"""The scenario writer that asks a model: what it asks, and what it makes of answers."""

from __future__ import annotations

import json
import math

import pytest

from plugins.scenario_writer.spec import SpecScenario
from sgcad_core.case.records import Context, Generation, Passage, RoadNetwork
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from tests.sgcad_core.formats.xosc_samples import CROSSING, crossroads

CONTEXT = Context(narrative="V1 turned left in front of V2.")
PASSAGES = (Passage(id="p1", kind="rule", text="T-bone"),)


class Model:
    """A model that gives one answer and keeps what it was asked."""

    def __init__(self, answer):
        self.answer, self.asked = answer, []

    def __call__(self, context, query):
        self.asked.append((context, query))
        return Generation(text=self.answer if isinstance(self.answer, str) else json.dumps(self.answer))


def write(model, findings=(), network=None, attempt=1, **fields):
    writer = SpecScenario(**fields)
    return writer.write(CONTEXT, PASSAGES, findings, model, attempt, network or crossroads())


GOOD = CROSSING.model_dump()


def test_an_answer_becomes_a_scenario():
    model = Model(GOOD)
    scenario = write(model)
    assert scenario.behavior == CROSSING
    assert scenario.xosc.startswith("<?xml")
    assert len(model.asked) == 1


def test_roads_stand_in_the_query_and_evidence_in_the_context_only():
    model = Model(GOOD)
    write(model)
    context, query = model.asked[0]
    assert context == CONTEXT
    assert "road S:\n  - forward: traffic heads north, 2 lanes; at hub: left to W" in query.task
    assert "V1 turned left in front" not in query.task
    assert query.passages == PASSAGES
    assert query.repair == ""


def test_only_roads_of_the_network_can_be_answered():
    model = Model(GOOD)
    write(model)
    answer = model.asked[0][1].answer_schema["anyOf"][0]
    actor = answer["properties"]["actors"]["items"]
    assert actor["properties"]["road"]["enum"] == ["N", "E", "S", "W"]
    assert set(answer["required"]) == set(CROSSING.model_fields) - {"near_crash"}
    assert "null" in json.dumps(actor["properties"]["exit_road"])


NEAR = {
    "conflict": CROSSING.contacts[0].model_dump(), "clearance_m": 1.0,
    "evasions": [{"actor": CROSSING.contacts[0].striker, "maneuver": "braking"}],
}  # fmt: skip


def test_a_model_that_knows_near_crashes_is_asked_for_them():
    model = Model({**GOOD, "contacts": [], "near_crash": NEAR})
    scenario = write(model, acts=True)
    asked = model.asked[0][1].answer_schema["anyOf"][0]
    assert set(asked["required"]) == set(CROSSING.model_fields)
    assert "braking_and_steering_left" in json.dumps(asked["properties"]["near_crash"])
    assert (scenario.declared, scenario.near_crash.closest_m) == (None, 1.0)


def test_a_model_says_how_a_vehicle_comes_to_rest():
    first, *others = GOOD["actors"]
    facing = {}
    for deg in (0, 180):
        said = {"from_rest": None, "rest": {"where": None, "facing_deg": deg}}
        model = Model({**GOOD, "actors": [{**first, "acts": said}, *others]})
        scenario = write(model, acts=True)
        facing[deg] = math.degrees(float(scenario.planned[0].heading_rad[-1]))
    assert "facing_deg" in json.dumps(model.asked[0][1].answer_schema)
    assert abs((facing[0] - facing[180] + 180) % 360 - 180) > 90, facing


def test_of_a_model_that_does_not_know_acts_they_are_as_the_text_tells():
    told = Context(narrative="V1 turned left in front of V2. V2 struck V1. V1 came to rest facing south.")
    model = Model(GOOD)
    scenario = SpecScenario().write(told, PASSAGES, (), model, 1, crossroads())
    assert {name: acts.rest.facing_deg for name, acts in scenario.behavior.acts.items()} == {"V1": 180.0}
    assert "facing_deg" not in json.dumps(model.asked[0][1].answer_schema)


def test_of_a_model_that_does_not_know_near_crashes_the_first_contact_is_the_one_that_was_avoided():
    told = Context(narrative="V1 turned left in front of V2. V2 braked to avoid hitting V1.")
    scenario = SpecScenario().write(told, PASSAGES, (), Model(GOOD), 1, crossroads())
    assert scenario.declared is None
    assert scenario.near_crash.conflict == CROSSING.contacts[0]


def test_without_spec_the_roads_are_read_from_the_network():
    model = Model(GOOD)
    write(model, network=crossroads().model_copy(update={"spec": None}))
    assert "- road S:" in model.asked[0][1].task


def test_a_model_may_decline():
    with pytest.raises(Refused, match="no vehicles named") as caught:
        write(Model({"refuse": "no vehicles named", "missing": ["vehicles"]}))
    assert caught.value.missing == ("vehicles",)


@pytest.mark.parametrize(("answer", "where"), [
    ("I think that", "$"),
    ({**GOOD, "actors": []}, "actors"),
    ({**GOOD, "actors": [{**GOOD["actors"][0], "speed_mph": 400}, *GOOD["actors"][1:]]}, "actors[0].speed_mph"),
    ({**GOOD, "contacts": [{**GOOD["contacts"][0], "striker": "V7"}]}, "contacts[0].striker"),
])  # fmt: skip
def test_an_unusable_answer_says_where(answer, where):
    with pytest.raises(InvalidOutput) as caught:
        write(Model(answer))
    assert where in [f.where for f in caught.value.findings]


def test_an_unknown_prompt_is_a_configuration_error():
    with pytest.raises(ConfigError, match="prompt 'nope'"):
        write(Model(GOOD), prompt="nope")


def test_without_any_road_there_is_nothing_to_ask():
    with pytest.raises(InvalidOutput, match=r"neither spec nor net\.xml"):
        write(Model(GOOD), network=RoadNetwork())
