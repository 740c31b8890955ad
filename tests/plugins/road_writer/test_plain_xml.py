"""The writer that lets a model write SUMO XML: forms of answers, faults that come back, hostile documents."""

from __future__ import annotations

import json

import pytest

from plugins.road_writer.plain_xml import PlainXmlRoad
from plugins.validator.netconvert import Netconvert
from plugins.validator.sumo_xsd import SumoXsd
from sgcad_core.case.records import Context, CrashReport, Evidence, Generation, Passage
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.formats.sumo.net_xml import network_figures, parse_net
from tests.transcripts import EDGES, NODES, REFUSAL, road_answer

CONTEXT = Context(narrative="V1 was northbound.")
EVIDENCE = Evidence(report=CrashReport(case="c", narrative="V1 was northbound."))
ENVELOPE = json.dumps({"nodes": NODES, "edges": EDGES, "connections": ""})


def write(answer, asked=None, **fields):
    def ask(context, query):
        if asked is not None:
            asked.append((context, query))
        return Generation(text=answer)

    return PlainXmlRoad(**fields).write(CONTEXT, (Passage(id="p", kind="xml", text="edge: one way"),), (), ask, 1)


@pytest.mark.parametrize("form", ["envelope", "fenced"])
@pytest.mark.parametrize("answer", [
    ENVELOPE,
    f"```json\n{ENVELOPE}\n```",
    road_answer(),
    NODES + EDGES,
    road_answer().removesuffix("```"),
])  # fmt: skip
def test_either_form_is_taken_whatever_was_asked(form, answer):
    network = write(answer, form=form)
    assert network.returncode == 0
    assert network_figures(parse_net(network.net_xml)).intersections == 1


def test_a_draft_before_the_answer_does_not_count():
    network = write(road_answer(nodes="<nodes></nodes>") + "\nBetter:\n" + road_answer())
    assert network.plain.nodes == NODES


def test_only_the_envelope_has_a_schema_and_passages_stand_in_the_query():
    asked = []
    write(ENVELOPE, asked)
    write(road_answer(), asked, form="fenced")
    (context, first), (_, second) = asked
    assert context == CONTEXT
    assert first.answer_schema["anyOf"][0]["required"] == ["nodes", "edges", "connections"]
    assert second.answer_schema is None
    assert "three fenced blocks" in second.task
    assert first.passages[0].id == "p"


def test_a_model_may_decline():
    with pytest.raises(Refused, match="names no road user"):
        write("I cannot. " + json.dumps(REFUSAL))


@pytest.mark.parametrize(("answer", "where"), [
    ("Three roads meet.", "$"),
    (NODES, "edges"),
    (json.dumps({"nodes": NODES}), "edges"),
    (json.dumps({"nodes": NODES, "edges": " "}), "edges"),
    ("x" * 300_000, "$"),
])  # fmt: skip
def test_an_unusable_answer_says_where(answer, where):
    with pytest.raises(InvalidOutput, match=r"\w") as caught:
        write(answer)
    assert where in [f.where for f in caught.value.findings]


@pytest.mark.parametrize(("answer", "words"), [
    (road_answer(edges=EDGES.replace('numLanes="2"', 'numLanes="-2"')), "numLanes"),
    (road_answer(nodes=NODES.replace("hub", "&x;", 1)), "Entity 'x' not defined"),
    (json.dumps({"nodes": '<!DOCTYPE a [<!ENTITY x "y">]>' + NODES, "edges": EDGES}), "document types"),
    (road_answer(nodes=NODES.replace('id="hub"', 'id="hub" color="red"')), "color"),
])  # fmt: skip
def test_the_schemas_words_come_back(answer, words):
    network = write(answer)
    assert network.net_xml is None
    assert words in "\n".join(f.line() for f in SumoXsd().findings(network, EVIDENCE))


def test_netconverts_words_come_back():
    network = write(road_answer(edges=EDGES.replace('from="E_end"', 'from="nowhere"')))
    assert network.net_xml is None
    assert SumoXsd().findings(network, EVIDENCE) == []
    assert "nowhere" in "\n".join(f.line() for f in Netconvert().findings(network, EVIDENCE))


def test_a_document_cannot_send_its_reader_to_a_schema_elsewhere():
    located = (
        '<nodes xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://a.b/c">'
    )
    network = write(road_answer(nodes=NODES.replace("<nodes>", located)))
    assert network.returncode == 0
    assert "a.b" not in network.plain.nodes


def test_an_unknown_prompt_is_a_configuration_error():
    with pytest.raises(ConfigError, match="prompt 'nope_envelope'"):
        write(ENVELOPE, prompt="nope")
