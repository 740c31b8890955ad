"""What the project brings: everything shown to a model is true, runs, or is accepted by its schema."""

import importlib.util
import json
import re
from functools import partial

import numpy as np
import pytest
from lxml import etree

from plugins.retriever.knowledge.api import api_chunks
from plugins.retriever.knowledge.embedders import MINILM_PACKAGE, check_digest, make, minilm_folder
from plugins.retriever.knowledge.examples import examples, snippet_chunks
from plugins.retriever.knowledge.sources import builtin_chunks
from plugins.retriever.knowledge.sumo_schema import examples as xml_examples
from plugins.retriever.knowledge.sumo_schema import xml_chunks
from plugins.simulator.kinematic import Kinematic
from sgcad_core import settings as paths
from sgcad_core.errors import MissingTool
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.roads.layout import road_spec
from tests.effort import spread

SNIPPETS = {chunk.id.removeprefix("snippet/"): chunk.text for chunk in snippet_chunks()}
needs_minilm = pytest.mark.skipif(importlib.util.find_spec(MINILM_PACKAGE) is None, reason="needs the extra 'minilm'")


def test_names_are_unique_and_texts_are_clean():
    chunks = list(builtin_chunks())
    assert len({c.id for c in chunks}) == len(chunks) > 500
    for chunk in chunks:
        assert chunk.text.strip()
        assert not re.search(r"0x[0-9a-f]{6,}|ForwardRef|scenariogeneration\.\w+\.\w+", chunk.text), chunk.id


def test_the_api_is_that_of_the_installed_package():
    found = {c.id: c for c in api_chunks()}
    text = found["api/xosc.TimeToCollisionCondition"].text
    assert text.startswith("class xosc.TimeToCollisionCondition(value: float, rule: Rule, alongroute: bool = True")
    assert "xosc.Rule.lessThan" in found["api/xosc.Rule"].text
    assert ".add_event(event: Event) -> Maneuver" in found["api/xosc.Maneuver"].text


@pytest.mark.parametrize("name", SNIPPETS)
def test_a_snippet_runs_as_it_is_shown(name):
    assert etree.tostring(etree.fromstring(xml_of(result_of(name))))


def result_of(name):
    """What a snippet leaves in `result`; snippets that it calls by name are run the same way."""
    scope = {other: partial(result_of, other) for other in SNIPPETS}
    exec(SNIPPETS[name], scope)  # noqa: S102 - the project's own text
    return scope["result"]


def xml_of(item):
    import xml.etree.ElementTree as ET

    return ET.tostring(item.get_element())


@pytest.mark.parametrize("example", spread(examples(), 3), ids=lambda e: e.name)
def test_a_worked_scenario_compiles_and_its_contact_comes_about(example):
    spec = road_spec(example.layout)
    network = compile_network(plain_xml(spec), spec)
    scenario = compile_scenario(example.behavior, network)
    seen, declared = Kinematic().execute(scenario, network).contact, scenario.declared
    sides = {declared.striker: declared.striker_area, declared.struck: declared.struck_area}
    assert {seen.actor: seen.actor_area, seen.other: seen.other_area} == sides


def test_the_schema_tells_types_limits_and_values():
    found = {c.id: c.text for c in xml_chunks()}
    assert "numLanes (integer >= 1)" in found["xml/edges/edge"]
    assert "spreadType (one of center, roadCenter, right)" in found["xml/edges/edge"]
    assert re.search(r"from \(text, required\)", found["xml/edges/edge"])
    assert "allway_stop" in found["xml/nodes/node@type"]
    assert "<lane>" in found["xml/edges/edge"]


@pytest.mark.parametrize(("name", "example"), xml_examples().items())
def test_an_xml_example_is_accepted_by_its_schema(name, example):
    file, element = name.split("/")
    root = {"nodes": "nodes", "edges": "edges", "connections": "connections", "types": "types",
            "tllogic": "tlLogics", "routes": "routes", "additional": "additional"}[file]  # fmt: skip
    inside = {"phase": '<tlLogic id="t" type="static" programID="0" offset="0">{}</tlLogic>',
              "stop": '<vehicle id="v" depart="0"><route edges="a"/>{}</vehicle>',
              "walk": '<person id="p" depart="0">{}</person>'}.get(element, "{}")  # fmt: skip
    text = example if example.startswith(f"<{root}>") else f"<{root}>{inside.format(example)}</{root}>"
    schema = etree.XMLSchema(etree.parse(paths.sumo_home() / "data" / "xsd" / f"{file}_file.xsd"))
    schema.assertValid(etree.fromstring(text))


@needs_minilm
def test_minilm_knows_meanings():
    texts = ["the car hit a tree", "an automobile struck a trunk", "quarterly tax return"]
    vectors = make("minilm").embed(texts)
    assert vectors.shape == (3, 384)
    assert np.allclose(np.linalg.norm(vectors, axis=1), 1, atol=1e-5)
    near = vectors @ vectors.T
    assert near[0, 1] > near[0, 2] + 0.2


@needs_minilm
def test_other_weights_are_refused(tmp_path):
    (tmp_path / "model.safetensors").write_bytes(b"something else")
    with pytest.raises(MissingTool, match=r"SHA-256 is .*, expected 53aa51.*not the published weights"):
        check_digest(tmp_path / "model.safetensors", "53aa51")
    assert minilm_folder().name == "model"


def test_no_embedder_is_full_text_alone():
    assert make("none") is None


def test_worked_scenarios_keep_to_their_stage():
    for chunk in builtin_chunks():
        if chunk.kind == "example":
            assert chunk.tasks == (("road",) if chunk.id.endswith("layout") else ("scenario",))
            json.loads(chunk.text.split(": ", 2)[2])


def test_writers_of_a_language_are_given_what_any_crash_needs(tmp_path):
    from plugins.retriever.lancedb import LanceDB

    index = LanceDB(folder=tmp_path / "kb", road_kinds=("xml",), scenario_kinds=("api", "snippet"), per_kind=5)
    index.build(index.chunks([], True, lambda *_: None), lambda _: None)
    told = "V1 was traveling north in the left lane. V2 turned left across its path and was struck on the right side."
    road = {p.id for p in index.retrieve(told, "road")}
    assert road >= {"xml/edges/edge", "xml/nodes/node", "xml/connections/connection"}
    scenario = {p.id for p in index.retrieve(told, "scenario")}
    assert scenario >= {"api/xosc.FollowTrajectoryAction", "api/xosc.Polyline", "snippet/timed_trajectory"}
    assert {name.split("/")[0] for name in scenario} == {"api", "snippet"}
