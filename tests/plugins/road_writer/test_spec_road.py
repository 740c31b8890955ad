"""The writer that asks a model for the roads."""

from __future__ import annotations

import json
import re

import llguidance
import pytest

from plugins.road_writer.spec import SpecRoad
from sgcad_core.asking.prompts import answer_schema, load_prompt
from sgcad_core.case.records import Context, Generation, Passage
from sgcad_core.config import load
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.formats.sumo.net_xml import network_figures, parse_net, segments
from sgcad_core.records.answer_schema import added_fields
from sgcad_core.records.specs import Access, Leg, Node, Road, RoadLayout, RoadSpec

EVIDENCE = Context(narrative="V1 was northbound on a two-lane road.")
LAYOUT = {
    "legs": [
        {"bearing": b, "lanes_in": 1, "lanes_out": 1, "turns_in": [], "center_turn_lane": False, "median": "none",
         "kind": "road", "control": "stop" if b == "E" else "none", "curve": "none", "speed_limit_mph": None}
        for b in ("N", "S", "E")
    ],
    "accesses": [],
}  # fmt: skip


class Model:
    """Answers with one text and keeps what it was asked."""

    def __init__(self, answer):
        self.answer = answer if isinstance(answer, str) else json.dumps(answer)
        self.asked = []

    def __call__(self, context, query):
        self.asked.append((context, query))
        return Generation(text=self.answer)


def example():
    """The example answer of the prompt."""
    return re.search(r"^\{.*\}$", load_prompt("road"), re.M)[0]


def write(answer, findings=(), **fields):
    model = Model(answer)
    network = SpecRoad(**fields).write(EVIDENCE, [Passage(id="p", kind="note", text="t")], findings, model, 1)
    return network, model


def test_the_prompts_example_compiles_to_what_it_describes():
    network, _ = write(example())
    graph = parse_net(network.net_xml)
    assert network_figures(graph).intersections == 1
    lanes = {s["id"]: (s["lanes_forward"], s["lanes_backward"]) for s in segments(graph)}
    assert lanes == {"W": (3, 2), "E": (2, 2), "S": (1, 1)}


def test_the_prompts_example_answers_the_schema_exactly():
    tokenizer = llguidance.LLTokenizer("byte")
    grammar = llguidance.LLMatcher.grammar_from_json_schema(json.dumps(answer_schema(RoadSpec)))
    matcher = llguidance.LLMatcher(tokenizer, grammar)
    assert not matcher.is_error()
    assert matcher.consume_tokens(tokenizer.tokenize_str(example()))
    assert matcher.is_accepting()


@pytest.mark.parametrize(("name", "models"), [("road", (Node, Road)), ("layout", (Leg, RoadLayout))])
def test_the_prompt_explains_every_field(name, models):
    text, places = load_prompt(name), load_prompt(f"{name}_places")
    for model in models:
        later = added_fields(model)
        assert [f for f in model.model_fields if f not in later and f not in text] == []
        assert [f for f in later if f"- {f}:" not in places] == []


def test_places_are_asked_for_where_the_model_may_know_them():
    _, model = write(LAYOUT, form="layout", places=True)
    query = model.asked[0][1]
    assert "circle_lanes" in query.answer_schema["anyOf"][0]["properties"]
    assert query.task == f"{load_prompt('layout')}\n\n{load_prompt('layout_places')}"


def test_the_layout_form_asks_for_a_layout_and_compiles_it():
    network, model = write(LAYOUT, form="layout")
    query = model.asked[0][1]
    assert list(query.answer_schema["anyOf"][0]["properties"]) == ["legs", "accesses"]
    assert query.task == load_prompt("layout")
    assert network_figures(parse_net(network.net_xml)).intersections == 1


def test_evidence_stands_in_the_context_only():
    _, model = write(example())
    context, query = model.asked[0]
    assert context is EVIDENCE
    assert EVIDENCE.narrative not in query.task + query.repair
    assert query.repair == ""
    assert query.passages[0].id == "p"


def test_a_declining_model_refuses_the_stage():
    with pytest.raises(Refused, match="no road named"):
        write('{"refuse": "no road named", "missing": ["road"]}')


def test_references_that_do_not_hold_are_findings():
    answer = json.loads(example())
    answer["roads"][0]["to_node"] = "nowhere"
    with pytest.raises(InvalidOutput, match="no such node") as caught:
        write(answer)
    assert caught.value.findings[0].where == "roads[0].to_node"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda a: a["legs"].append(a["legs"][0]), "one bearing"),
        (lambda a: a["legs"][0].update(lanes_in=0, lanes_out=0), "no lanes"),
        (lambda a: a["legs"][0].update(turns_in=["left", "through"]), "2 turns, 1 lanes"),
        (lambda a: a["accesses"].append(Access(leg="W", side="left").model_dump()), "no leg of this bearing"),
    ],
)
def test_layouts_that_contradict_themselves_are_findings(change, message):
    answer = json.loads(json.dumps(LAYOUT))
    change(answer)
    with pytest.raises(InvalidOutput, match=message):
        write(answer, form="layout")


def test_a_leg_that_repeats_a_bearing_is_held_to_another():
    answer = json.loads(json.dumps(LAYOUT))
    answer["legs"].append(answer["legs"][0])
    with pytest.raises(InvalidOutput, match="one bearing") as fault:
        write(json.dumps(answer), form="layout")
    (hold,) = fault.value.findings[0].holds
    assert hold.at == len(answer["legs"]) - 1
    assert not {leg["bearing"] for leg in answer["legs"]} & set(hold.either[0]["bearing"])
    answer["legs"] += answer["legs"][:2]
    with pytest.raises(InvalidOutput) as fault:
        write(json.dumps(answer), form="layout")
    assert not any(finding.holds for finding in fault.value.findings)


@pytest.mark.parametrize("told", ["county.osm.bz2", "maps/"])
def test_a_map_is_refused_with_the_writer_that_takes_one(told):
    with pytest.raises(ConfigError, match=r"asks a model and takes no maps .*road_writer: template"):
        load("mini.yaml", (f"road_writer.places={told}", "tracker=none"))
