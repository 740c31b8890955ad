"""The writer that lets a model write Python: forms of answers, what it is told, what comes back of faults."""

from __future__ import annotations

import json

import numpy as np
import pytest

from plugins.scenario_writer._api_hint import nearest_entry
from plugins.scenario_writer._network_words import lane_lines
from plugins.scenario_writer.code import Code
from plugins.simulator.kinematic import Kinematic
from plugins.validator.openscenario import OpenScenario
from sgcad_core.case.records import Context, CrashReport, Evidence, Generation, Passage, RoadNetwork
from sgcad_core.errors import InvalidOutput, Refused
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.sumo.net_xml import parse_net
from tests.sgcad_core.formats.xosc_samples import crossroads
from tests.transcripts import DECLARED, REFUSAL, SCRIPT, code_answer

CONTEXT = Context(narrative="V1 stood still.")
ENVELOPE = json.dumps({**DECLARED, "code": SCRIPT})


def write(answer, asked=None, network=None, **fields):
    def ask(context, query):
        if asked is not None:
            asked.append((context, query))
        return Generation(text=answer)

    passages = (Passage(id="p", kind="api", text="xosc.Event(name, priority)"),)
    return Code(**fields).write(CONTEXT, passages, (), ask, 1, network or crossroads())


@pytest.mark.parametrize("form", ["fenced", "envelope"])
@pytest.mark.parametrize("answer", [code_answer(), ENVELOPE, code_answer().removesuffix("```\nDone.")])
def test_either_form_becomes_a_scenario_whose_contact_can_be_compared(form, answer):
    scenario = write(answer, form=form)
    assert [(a.id, a.type, a.length_m, a.maneuver) for a in scenario.actors] == [
        ("V1", "car", 4.7, "stopped"), ("V2", "car", 4.7, "straight"),
    ]  # fmt: skip
    assert scenario.declared.striker == "V2"
    report = CrashReport(case="c", narrative="V1 stood still.")
    assert OpenScenario().findings(scenario, Evidence(report=report, network=crossroads())) == []
    contact = Kinematic().execute(scenario, crossroads()).contact
    assert {contact.actor: contact.actor_area, contact.other: contact.other_area} == {"V1": "back", "V2": "front"}


def test_roads_lanes_and_passages_stand_in_the_query_and_evidence_in_the_context():
    asked = []
    write(code_answer(), asked)
    write(ENVELOPE, asked, form="envelope")
    (context, fenced), (_, enveloped) = asked
    assert context == CONTEXT
    assert "- S lane 0 (0 = rightmost): road " in fenced.task
    assert "- road S:" in fenced.task
    assert fenced.passages[0].id == "p"
    assert fenced.answer_schema is None
    assert "code" in enveloped.answer_schema["anyOf"][0]["required"]


def test_a_model_may_decline():
    with pytest.raises(Refused, match="names no road user"):
        write(json.dumps(REFUSAL))


@pytest.mark.parametrize(("answer", "where"), [
    ("V2 strikes V1.", "$"),
    (json.dumps(DECLARED), "code"),
    (code_answer(declared={**DECLARED, "actors": []}), "actors"),
    (f"```python\n{SCRIPT}```", "$"),
])  # fmt: skip
def test_an_unusable_answer_says_where(answer, where):
    with pytest.raises(InvalidOutput, match=r"\w") as caught:
        write(answer)
    assert where in [f.where for f in caught.value.findings]


@pytest.mark.parametrize(("before", "after", "source", "words"), [
    ("xosc.Priority.override", "xosc.Priority.overide", "python", ("line 22", "xosc.Priority: override")),
    ("event.add_trigger", "event.add_triger", "python", ("line 23", "xosc.Event.add_trigger(trigger)")),
    ("xosc.Entities()", "xosc.Entitys()", "python", ("has no attribute 'Entitys'", "xosc.Entities()")),
    ("70, 12, 12)", "70, 12)", "python", ("missing 1 required", "xosc.Vehicle(name, vehicle_type, boundingbox")),
    ("import math", "import numpy", "python_rules", ("line 1: import numpy", "use math and lists")),
    ("def car(name):", "def car(name:", "python_syntax", ("line 8", "whole Python script")),
    ("scenario = xosc", "result = xosc", "python", ("`scenario` must be bound", "found nothing")),
])  # fmt: skip
def test_a_fault_comes_back_with_its_line_and_the_nearest_entry(before, after, source, words):
    assert before in SCRIPT
    with pytest.raises(InvalidOutput, match=r"\w") as caught:
        write(code_answer(SCRIPT.replace(before, after)))
    finding = caught.value.findings[0]
    assert finding.source == source
    for word in words:
        assert word in finding.line()


def test_a_script_that_does_not_end_is_stopped_and_told_so():
    with pytest.raises(InvalidOutput, match=r"python_limit.*more than 1 s.*few statements"):
        write(code_answer("while True:\n    pass\n"), cpu_s=1)


def test_without_a_network_there_is_nothing_to_ask():
    with pytest.raises(InvalidOutput, match=r"no net\.xml"):
        write(code_answer(), network=RoadNetwork())


def test_an_entity_that_is_declared_but_not_written_keeps_the_usual_size():
    declared = {**DECLARED, "actors": [*DECLARED["actors"], {"id": "P1", "kind": "pedestrian", "maneuver": "straight"}]}
    scenario = write(code_answer(declared=declared))
    assert (scenario.actors[2].length_m, scenario.actors[2].width_m) == (0.5, 0.6)


def test_the_opendrive_lanes_in_the_query_are_those_of_the_file():
    """An actor put on a listed road and lane by LanePosition stands on the listed center line."""
    network = crossroads()
    listed = lane_lines(parse_net(network.net_xml), network.xodr).splitlines()
    line = next(x for x in listed if x.startswith("- S lane 1"))
    road, lane = line.split("road '")[1].split("'")[0], line.split("' lane ")[1].split(",")[0]
    head = SCRIPT.index("    init.add_init_action")
    put = f'    init.add_init_action(name, xosc.TeleportAction(xosc.LanePosition(20, 0, {lane}, "{road}")))\n'
    script = SCRIPT[:head] + put + SCRIPT[SCRIPT.index("    act.add_maneuver_group") :]
    script = script.replace("    act.add_maneuver_group(drive(name, times, points))\n", "").replace(
        "story.add_act(act)\nboard", "board"
    ).replace("board.add_story(story)\n", "")  # fmt: skip
    placed = play(write(code_answer(script)).xosc, network.xodr)[0]
    shape = parse_net(network.net_xml).edges["S"].lanes[1].shape
    assert np.allclose([placed.x_m[0], placed.y_m[0]], shape[0] + [0, 20 + 1.36], atol=0.05)  # its rear axle is there


@pytest.mark.parametrize(("kind", "message", "line", "entry"), [
    ("NameError", "name 'WorldPosition' is not defined", "", "xosc.WorldPosition(x=0, y=0"),
    ("ValueError", "wrong", "a = xosc.TransitionDynamics(1, 2, 3)", "xosc.TransitionDynamics(shape, dimension, value"),
    ("AttributeError", "type object 'DynamicsShapes' has no attribute 'linea'", "", "xosc.DynamicsShapes: linear"),
    ("ValueError", "wrong", "x = 1", ""),
    ("AttributeError", "'Nobody' object has no attribute 'x'", "", ""),
])  # fmt: skip
def test_the_nearest_entry_carries_its_signature(kind, message, line, entry):
    found = nearest_entry(kind, message, line)
    assert found.startswith(entry) if entry else found == ""
