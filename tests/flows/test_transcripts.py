"""Writers of XML and Python from report to folder, through real netconvert, scenariogeneration and SUMO, answered by
transcripts: good, flawed, hostile, refusing; and once over HTTP."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from flows.study_file.arm_config import load_config
from flows.study_file.spec import load_study
from sgcad_core import settings
from sgcad_core.config import build
from tests import transcripts
from tests.effort import spread
from tests.plugins.backbone.test_openai_chat import Server, chat

NARRATIVE = "Vehicle 1 stood northbound before a T-intersection. Vehicle 2 struck its back with its front."
VALIDATORS = ["sumo_xsd", "netconvert", "sumo_load", "opendrive", "openscenario", "agreement"]


@pytest.fixture
def run(tmp_path):
    """Runs one case: `run(answers, road_writer={...})` gives result.json and the case's folder."""
    report = tmp_path / "c1"
    report.mkdir()
    (report / "report.txt").write_text(NARRATIVE)

    def go(answers, **fields):
        raw = {
            "report_reader": "auto", "retriever": "none", "decoder": "greedy", "simulator": "libsumo",
            "tracker": "none", "validators": VALIDATORS, "max_attempts": 6,
            "backbone": {"name": "scripted", "answers": answers},
            "road_writer": {"name": "plain_xml", "form": "fenced"}, "scenario_writer": {"name": "code", "cpu_s": 1},
            **fields,
        }  # fmt: skip
        config = build(raw, "kit", "kit")
        ending = run_case(config, Case(report, "c1"), tmp_path / "runs", "digest")
        return ending.result, tmp_path / "runs" / "kit" / "c1"

    return go


def sources(folder: Path, attempt: str) -> set[str]:
    findings = json.loads((folder / "attempts" / attempt / "findings.json").read_text())
    return {f["source"] for f in findings if f["severity"] == "repair"}


def test_a_good_transcript_becomes_the_crash_that_it_declares(run):
    result, folder = run(transcripts.GOOD)
    assert result["status"] == "generated", result["reason"]
    assert result["attempts"] == {"road": 1, "scenario": 1}
    assert result["network"]["intersections"] == 1
    assert result["collision"]["realised"] is True
    assert (folder / "scenario.xosc").is_file()
    assert (folder / "player.html").is_file()


def test_a_flawed_transcript_is_mended_fault_by_fault(run):
    result, folder = run(transcripts.FLAWED)
    assert result["status"] == "generated", result["reason"]
    assert result["attempts"] == {"road": 5, "scenario": 5}
    assert [sources(folder, f"road-0{n}") for n in (1, 2, 3, 4)] == [
        {"answer"}, {"answer"}, {"sumo_xsd", "netconvert"}, {"netconvert"},
    ]  # fmt: skip
    assert [sources(folder, f"scenario-0{n}") for n in (1, 2, 3, 4)] == [
        {"python_syntax"}, {"python_rules"}, {"python"}, {"openscenario"},
    ]  # fmt: skip
    prompt = (folder / "attempts/scenario-04/prompt.txt").read_text()
    assert "nearest in the API: xosc.Priority: override" in prompt


def test_a_hostile_road_ends_exhausted(run):
    result, folder = run(transcripts.HOSTILE)
    assert (result["status"], result["attempts"]["road"]) == ("exhausted", 6)
    assert "root:" not in (folder / "attempts/road-01/findings.json").read_text()


def test_a_hostile_script_ends_exhausted_and_does_nothing(run):
    result, folder = run(transcripts.HOSTILE_CODE)
    assert (result["status"], result["attempts"]["scenario"]) == ("exhausted", 6)
    assert sources(folder, "scenario-02") == {"python_limit"}
    assert not Path("/tmp/out").exists()  # noqa: S108 - the place that the script names


@pytest.mark.parametrize(("answers", "stage"), [
    (transcripts.REFUSING_ROAD, "road"), (transcripts.REFUSING, "scenario"),
])  # fmt: skip
def test_a_refusing_transcript_is_a_refusal(run, answers, stage):
    result, _ = run(answers)
    assert result["status"] == "refused"
    assert result["reason"].startswith(f"{stage}: ")
    assert result["missing"] == ["the road users"]


def test_the_same_over_http_with_a_server_that_ignores_the_schema_and_stumbles(run):
    server = Server()
    threading.Thread(target=server.serve_forever, daemon=True).start()
    server.script = [
        (500, "busy", {}), chat("Let me think."), chat(transcripts.road_answer()), (429, "wait", {}),
        chat(transcripts.code_answer(transcripts.SCRIPT.replace("xosc.Act(", "xosc.Actt("))),
        chat(transcripts.code_answer()),
    ]  # fmt: skip
    backbone = {"name": "openai_chat", "base_url": server.url, "model": "m", "backoff_s": 0.01}
    writers = {"road_writer": "plain_xml", "scenario_writer": {"name": "code", "form": "envelope"}}
    try:
        result, _ = run([], backbone=backbone, **writers)
    finally:
        server.shutdown()
        server.server_close()
    assert result["status"] == "generated", result["reason"]
    assert result["attempts"] == {"road": 2, "scenario": 2}
    assert "Actt" in json.dumps(server.seen[-1]["messages"])


def test_the_table_of_a_runs_folder_tells_where_files_failed(run):
    _, folder = run(transcripts.FLAWED)
    command = [sys.executable, "-m", "research.benchmarks.services.generation", str(folder.parent.parent)]
    done = subprocess.run(command, cwd=settings.ROOT, capture_output=True, text=True, check=True)
    row = done.stdout.splitlines()[-1]
    assert row == "| kit | 1 | 0 | 0.0 % | 100.0 % | 100.0 % | 0.0 % | 100.0 % | 0.0 % | 10.0 | parse 3 | - |"


STUDIES = ("components_qwen72b", "components_llama90b", "rag_qwen72b", "rag_llama90b")
PAPER = [f"{study.name}/{arm.name}" for study in map(load_study, STUDIES) for arm in study.arms]


@pytest.mark.parametrize("name", spread(PAPER, 3))
def test_every_arm_of_the_paper_runs_with_a_script_in_the_models_place(run, name):
    raw = load_config(name).raw
    assert raw["road_writer"]["name"] == "plain_xml"
    kept = {k: raw[k] for k in ("report_reader", "road_writer", "scenario_writer", "validators", "max_attempts")}
    result, _ = run(transcripts.GOOD, **kept)
    assert result["status"] == "generated", result["reason"]
