"""The paper's rivals from report to folder: OmniTester, Text2Scenario and OSM-Direct, through real netconvert and SUMO,
answered by transcripts (good, flawed, hostile, refusing), and over HTTP by a server that stumbles."""

from __future__ import annotations

import json
import threading
from pathlib import Path

import pytest

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from flows.study_file.arm_config import load_config
from flows.study_file.spec import load_study
from plugins.retriever.lancedb import LanceDB
from sgcad_core import settings
from sgcad_core.config import build
from sgcad_core.errors import ConfigError, MissingTool
from tests import transcripts_rivals as said
from tests.effort import spread
from tests.plugins.backbone.test_openai_chat import Server, chat

NARRATIVE = "Vehicle 1 stood northbound before a T-intersection. Vehicle 2 struck its back with its front."
OMNI = {"road_writer": "omnitester", "scenario_writer": "omnitester",
        "validators": ["sumo_xsd", "netconvert", "sumo_load", "routes"]}  # fmt: skip
T2S = {"road_writer": "text2scenario", "scenario_writer": "text2scenario",
       "validators": ["sumo_xsd", "netconvert", "sumo_load", "opendrive", "openscenario", "agreement"]}  # fmt: skip


@pytest.fixture
def run(tmp_path):
    """Runs one case: `run(fields, answers)` gives result.json and the case's folder."""
    report = tmp_path / "c1"
    report.mkdir()
    (report / "report.txt").write_text(NARRATIVE)

    def go(fields, answers=None):
        raw = {
            "report_reader": "auto", "retriever": "none", "simulator": "libsumo",
            "tracker": "none", "max_attempts": 7, **fields,
        }  # fmt: skip
        if answers is not None:
            raw["backbone"] = {"name": "scripted", "answers": answers}
        if "backbone" in raw:
            raw["decoder"] = "greedy"
        config = build(raw, "kit", "kit")
        ending = run_case(config, Case(report, "c1"), tmp_path / "runs", "digest")
        return ending.result, tmp_path / "runs" / "kit" / "c1"

    return go


@pytest.fixture
def server():
    made = Server()
    threading.Thread(target=made.serve_forever, daemon=True).start()
    yield made
    made.shutdown()
    made.server_close()


def sources(folder: Path, attempt: str) -> set[str]:
    findings = json.loads((folder / "attempts" / attempt / "findings.json").read_text())
    return {f["source"] for f in findings if f["severity"] == "repair"}


# ------------------------------------------------------------------ OmniTester
@pytest.mark.slow
def test_omnitester_writes_routes_that_sumos_drivers_crash_on(run):
    result, folder = run(OMNI, said.OMNI_GOOD)
    assert result["status"] == "generated", result["reason"]
    assert result["attempts"] == {"road": 1, "scenario": 1}
    assert result["collision"]["realised"] is True
    assert (folder / "scenario.rou.xml").is_file()
    assert not (folder / "scenario.xosc").exists()


def test_its_generators_see_the_interpretation_and_not_the_report(run, server):
    script = [said.SCENE, said.road_answer(), said.ROLES, said.routes_answer()]
    server.script = [chat(text) for text in script]
    result, _ = run(OMNI | {"backbone": {"name": "openai_chat", "base_url": server.url, "model": "m"}})
    assert result["status"] == "generated", result["reason"]
    texts = ["".join(c["text"] for c in m["messages"][0]["content"]) for m in server.seen]
    assert [NARRATIVE in text for text in texts] == [True, False, True, False]
    assert json.loads(said.SCENE)["roads"] in texts[1]
    assert json.loads(said.ROLES)["vehicles"] in texts[3]


def test_its_faults_come_back_and_the_interpreter_is_asked_once_a_stage(run):
    result, folder = run(OMNI, said.OMNI_FLAWED)
    assert result["status"] == "generated", result["reason"]
    assert result["attempts"] == {"road": 4, "scenario": 6}
    assert [sources(folder, f"road-0{n}") for n in (1, 2, 3)] == [{"answer"}, {"answer"}, {"netconvert"}]
    assert [sources(folder, f"scenario-0{n}") for n in range(1, 6)] == [
        {"answer"}, {"answer"}, {"sumo_xsd"}, {"sumo_routes"}, {"sumo_routes"},
    ]  # fmt: skip
    asked = [(folder / f"attempts/road-0{n}/prompt.txt").read_text().count("You interpret") for n in (1, 2, 3, 4)]
    assert asked == [1, 0, 0, 0]
    assert "S leads to -E, -N" in (folder / "attempts/scenario-05/prompt.txt").read_text()


def test_a_hostile_route_file_ends_exhausted(run):
    result, folder = run(OMNI, said.OMNI_HOSTILE)
    assert (result["status"], result["attempts"]["scenario"]) == ("exhausted", 7)
    assert "root:" not in (folder / "attempts/scenario-01/findings.json").read_text()


@pytest.mark.parametrize(("fields", "answers", "stage"), [
    (OMNI, said.OMNI_REFUSING_ROAD, "road"), (OMNI, said.OMNI_REFUSING, "scenario"),
    (T2S, said.T2S_REFUSING_ROAD, "road"), (T2S, said.T2S_REFUSING, "scenario"),
])  # fmt: skip
def test_a_refusing_transcript_is_a_refusal(run, fields, answers, stage):
    result, _ = run(fields, answers)
    assert (result["status"], result["missing"]) == ("refused", ["the road users"])
    assert result["reason"].startswith(f"{stage}: ")


def test_the_net_generator_is_shown_real_junctions_with_their_xml(run, tmp_path, server):
    index = LanceDB(folder=tmp_path / "kb")
    index.build(index.chunks([settings.CONFIGS / "extracts" / "town.osm"], False, lambda *_: None), lambda _: None)
    server.script = [chat(t) for t in (said.SCENE, said.road_answer(), said.ROLES, said.routes_answer())]
    road = {"name": "omnitester", "folder": str(tmp_path / "kb"), "junctions": 1}
    backbone = {"name": "openai_chat", "base_url": server.url, "model": "m"}
    result, _ = run(OMNI | {"road_writer": road, "backbone": backbone})
    assert result["status"] == "generated", result["reason"]
    shown = server.seen[1]["messages"][0]["content"][0]["text"]
    assert "A real junction: three-leg junction (T-intersection" in shown
    assert '<edge id="R1"' in shown


# ------------------------------------------------------------------ Text2Scenario
def test_text2scenario_takes_a_map_and_its_planner_brings_the_crash_about(run):
    result, folder = run(T2S, said.T2S_GOOD)
    assert result["status"] == "generated", result["reason"]
    assert result["network"]["source"] == "map_library"
    assert result["network"]["intersections"] == 1
    assert result["collision"]["realised"] is True
    assert (folder / "scenario.xosc").is_file()
    assert any("map_library: t_four_lanes_stop" in note["text"] for note in result["notes"])


def test_flawed_forms_are_mended_fault_by_fault(run):
    result, folder = run(T2S, said.T2S_FLAWED)
    assert result["status"] == "generated", result["reason"]
    assert result["attempts"] == {"road": 4, "scenario": 5}
    assert [sources(folder, f"scenario-0{n}") for n in (1, 2, 3, 4)] == [
        {"answer"}, {"scenario"}, {"scenario"}, {"scenario"},
    ]  # fmt: skip


def test_hostile_forms_end_exhausted(run):
    result, _ = run(T2S, said.T2S_HOSTILE)
    assert (result["status"], result["attempts"]["scenario"]) == ("exhausted", 7)


# ------------------------------------------------------------------ over HTTP
def test_a_server_that_stumbles_costs_attempts_and_no_case(run, server):
    good = [json.dumps(said.FORM), json.dumps(said.PARSED)]
    server.script = [
        (500, "busy", {}), (429, "wait", {"Retry-After": "0"}), chat('{"place": "t_jun', "length"), chat("Sure!"),
        chat(good[0]), (503, "loading", {}), chat(""), chat('{"roles": ['), chat(good[1]),
    ]  # fmt: skip
    backbone = {"name": "openai_chat", "base_url": server.url, "model": "m", "backoff_s": 0.01}
    result, _ = run(T2S | {"backbone": backbone})
    assert result["status"] == "generated", result["reason"]
    assert result["attempts"] == {"road": 3, "scenario": 3}
    assert "cut off" in json.dumps(server.seen[3]["messages"])


def test_a_model_that_declines_over_http_is_a_refusal(run, server):
    server.script = [chat(None, refusal="I cannot help with crashes")]
    result, _ = run(OMNI | {"backbone": {"name": "openai_chat", "base_url": server.url, "model": "m"}})
    assert (result["status"], result["attempts"]["road"]) == ("refused", 1)


def test_a_server_that_never_answers_in_time_stops_the_run_and_says_so(run, server):
    server.script, server.delay_s = [chat("{}")], 1.0
    backbone = {"name": "openai_chat", "base_url": server.url, "model": "m", "timeout_s": 0.1, "retries": 0}
    with pytest.raises(MissingTool, match="gave no answer in 1 tries, at last ReadTimeout"):
        run(T2S | {"backbone": backbone})


# ------------------------------------------------------------------ the configs themselves
RIVALS = [
    f"{study.name}/{arm.name}"
    for study in map(load_study, ("baselines", "baselines_qwen72b", "baselines_llama90b"))
    for arm in study.arms
    if any(word in arm.name for word in ("omnitester", "text2scenario", "osm_direct"))
]


@pytest.mark.parametrize("name", spread(RIVALS, 3))
def test_every_rivals_config_runs_with_a_script_in_the_models_place(run, name, tmp_path):
    config = load_config(name)
    raw = config.raw
    kept = {k: raw[k] for k in ("report_reader", "road_writer", "scenario_writer", "validators", "max_attempts")}
    if folder := raw["road_writer"].get("folder"):
        extract = {"knowledge-town": "town.osm", "knowledge-far": "far_city.osm"}[folder]
        index = LanceDB(folder=tmp_path / folder)
        index.build(index.chunks([settings.CONFIGS / "extracts" / extract], False, lambda *_: None), lambda _: None)
        kept["road_writer"] = {**raw["road_writer"], "folder": str(tmp_path / folder)}
    if raw["road_writer"].get("form") == "layout":
        pytest.skip("the embedded model answers specs")
    answers = said.OMNI_GOOD if "omnitester" in name else said.T2S_GOOD
    result, _ = run(kept, answers if config.road_writer.asks_model else None)
    assert result["status"] == "generated", result["reason"]


def test_an_index_that_is_missing_is_named_before_anything_starts(tmp_path):
    writer = load_config("baselines/osm_direct", (f"road_writer.folder={tmp_path / 'nowhere'}",)).road_writer
    with pytest.raises(ConfigError, match=r"no knowledge base in .*nowhere: build it with `sgcad index build"):
        _ = writer.stamp
