"""Answer schemas, answers and prompt files."""

from __future__ import annotations

import json

import llguidance
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.asking import prompts
from sgcad_core.asking.prompts import answer_schema, load_prompt, parse_answer
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.records.specs import BehaviorSpec, Refusal, RoadLayout, RoadSpec

ROAD = {
    "nodes": [{"id": "a", "x_m": 0, "y_m": 0}, {"id": "b", "x_m": 100, "y_m": 0}],
    "roads": [{"id": "r", "from_node": "a", "to_node": "b", "lanes_forward": 1, "lanes_backward": 1}],
}


def walk(schema):
    yield schema
    for branch in [*schema.get("anyOf", []), *schema.get("properties", {}).values(), schema.get("items", {})]:
        if branch:
            yield from walk(branch)


@pytest.mark.parametrize("model", [RoadSpec, RoadLayout, BehaviorSpec])
def test_every_object_is_closed_and_requires_all_its_keys_in_field_order(model):
    schema = answer_schema(model, places=True)
    assert [list(b["properties"]) for b in schema["anyOf"]] == [list(model.model_fields), list(Refusal.model_fields)]
    for part in walk(schema):
        assert "$ref" not in part
        assert "default" not in part
        if part.get("type") == "object":
            assert part["additionalProperties"] is False
            assert part["required"] == list(part["properties"])
        if part.get("type") == "array":
            assert part["maxItems"] <= 60


@pytest.mark.parametrize("model", [RoadSpec, RoadLayout, BehaviorSpec])
@pytest.mark.parametrize("refusal", [True, False])
def test_the_grammar_engine_compiles_every_answer_schema(model, refusal):
    grammar = llguidance.LLMatcher.grammar_from_json_schema(json.dumps(answer_schema(model, refusal=refusal)))
    error, warnings = llguidance.LLMatcher.validate_grammar_with_warnings(grammar)
    assert not error
    assert warnings == []


def test_the_grammar_bounds_the_digits_of_a_number():
    tokenizer = llguidance.LLTokenizer("byte")
    schema = answer_schema(RoadSpec, refusal=False)["properties"]["nodes"]["items"]["properties"]["x_m"]
    for text, allowed in (("-3000", True), ("12.5", True), ("12.125", False), ("3000.01", False), ("0.00000", False)):
        matcher = llguidance.LLMatcher(tokenizer, llguidance.LLMatcher.grammar_from_json_schema(json.dumps(schema)))
        taken = matcher.try_consume_tokens(tokenizer.tokenize_str(text)) == len(text)
        assert (taken and matcher.is_accepting()) is allowed, text


def test_enums_narrow_string_fields_and_keep_null():
    schema = answer_schema(BehaviorSpec, enums={"road": ["N", "S", "N"], "exit_road": ["N"]}, refusal=False)
    actor = schema["properties"]["actors"]["items"]["properties"]
    assert actor["road"]["enum"] == ["N", "S"]
    assert "pattern" not in actor["road"]
    assert {"type": "null"} in actor["exit_road"]["anyOf"]
    assert actor["exit_road"]["anyOf"][0]["enum"] == ["N"]


def test_an_empty_enum_narrows_nothing():
    assert answer_schema(BehaviorSpec, enums={"road": []}) == answer_schema(BehaviorSpec)


@pytest.mark.parametrize(
    "text",
    [
        json.dumps(ROAD),
        f"```json\n{json.dumps(ROAD, indent=2)}\n```",
        f"Frame {{x, y}}; the scene {{}} shows a road.\n{json.dumps(ROAD)}\nDone.",
    ],
)
def test_an_answer_is_found_among_fences_and_words(text):
    assert parse_answer(text, RoadSpec).roads[0].id == "r"


def test_a_refusal_is_raised_with_what_is_missing():
    with pytest.raises(Refused, match="no road is described") as caught:
        parse_answer('{"refuse": "no road is described", "missing": ["lanes", "junction"]}', RoadSpec)
    assert caught.value.missing == ("lanes", "junction")


def test_every_fault_becomes_a_finding_with_its_json_path():
    bad = json.loads(json.dumps(ROAD))
    bad["roads"][0]["lanes_forward"] = 99
    bad["roads"][0]["colour"] = "red"
    del bad["nodes"][1]["x_m"]
    with pytest.raises(InvalidOutput, match="lanes_forward") as caught:
        parse_answer(json.dumps(bad), RoadSpec)
    found = {f.where: f for f in caught.value.findings}
    assert set(found) == {"roads[0].lanes_forward", "roads[0].colour", "nodes[1].x_m"}
    assert found["roads[0].lanes_forward"].value == "99"
    assert "8" in found["roads[0].lanes_forward"].remedy
    assert "leave" in found["roads[0].colour"].remedy


@pytest.mark.parametrize("text", ["", "no", "{", '{"nodes": [', "{" * 5000, '{"a":' * 5000, "[1, 2]"])
def test_text_without_an_object_is_invalid_output(text):
    with pytest.raises(InvalidOutput, match="no complete JSON object"):
        parse_answer(text, RoadSpec)


def test_an_endless_answer_is_not_read():
    with pytest.raises(InvalidOutput, match="at most"):
        parse_answer("{" * (prompts.MAX_ANSWER + 1), RoadSpec)


@given(st.text(max_size=200))
@settings(max_examples=200, deadline=None)
def test_any_text_is_an_answer_a_refusal_or_invalid_output(text):
    with pytest.raises((InvalidOutput, Refused), match=r"(?s)."):
        parse_answer(text + "{}", RoadSpec)


def test_a_prompt_needs_exactly_its_slots(tmp_path, monkeypatch):
    monkeypatch.setattr(prompts.settings, "PROMPTS", tmp_path)
    (tmp_path / "road.md").write_text('Write {what}, such as {"id": "N"}.\n', encoding="utf-8")
    assert load_prompt("road", what="roads") == 'Write roads, such as {"id": "N"}.'
    with pytest.raises(ConfigError, match="has slots"):
        load_prompt("road")
    with pytest.raises(ConfigError, match="has slots"):
        load_prompt("road", what="roads", more="x")
    with pytest.raises(ConfigError, match="there are: road"):
        load_prompt("rod")
    with pytest.raises(ConfigError, match="no such file"):
        load_prompt("../road", what="x")
