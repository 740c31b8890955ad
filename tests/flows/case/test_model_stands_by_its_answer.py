"""A model that reads a report otherwise than the rules: asked once, then its answer stands; hard faults end at ten."""

import copy

import pytest
import yaml

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from sgcad_core import config as configs
from sgcad_core.settings import ROOT

TEXT = (
    "Vehicle 1 was traveling north on a road, approaching a signalized four-leg intersection. Vehicle 2 was traveling "
    "south on the same road. Vehicle 1 turned left at the intersection. The front of Vehicle 2 struck the right side "
    "of Vehicle 1."
)
RAW = yaml.safe_load((ROOT / "configs/scripted.yaml").read_text())
ROAD, RIGHT = (entry["answer"] for entry in RAW["backbone"]["answers"])


UNTOLD = {**RIGHT, "contacts": []}


@pytest.fixture
def answered(tmp_path):
    """Runs the text with these answers of the scenario stage, the last one again and again: result.json's content."""
    source = tmp_path / "c1"
    source.mkdir()

    def run(text, *scenarios):
        (source / "report.txt").write_text(text)
        entries = [{"stage": "road", "answer": ROAD}]
        entries += [{"stage": "scenario", "attempt": n, "answer": one} for n, one in enumerate(scenarios, 1)]
        entries.append({"stage": "scenario", "answer": scenarios[-1]})
        file = tmp_path / "answers.yaml"
        file.write_text(yaml.safe_dump(entries))
        backbone = {"name": "scripted", "file": str(file)}
        raw = configs.load(ROOT / "configs/scripted.yaml").raw | {"backbone": backbone, "tracker": {"name": "none"}}
        return run_case(configs.build(raw, "k", "here"), Case(source, "c1"), tmp_path / "out", "d").result

    return run


def disputed(result):
    return {one["field"]: (one["kept"], one["other"]) for one in result["disagreements"]}


def test_a_right_answer_is_asked_nothing(answered):
    result = answered(TEXT, RIGHT)
    assert (result["status"], result["attempts"]["scenario"]) == ("generated", 1)
    assert not any(field.startswith("vehicles") for field in disputed(result))


def test_an_answer_that_the_rules_read_otherwise_stands_after_one_question(answered):
    misread = TEXT.replace("turned left at", "turned right at")
    result = answered(misread, RIGHT)
    assert (result["status"], result["attempts"]["scenario"]) == ("generated", 2)
    assert disputed(result)["vehicles.V1.maneuver"] == ("turn_left", "turn_right")
    (told,) = [one for one in result["disagreements"] if one["field"] == "vehicles.V1.maneuver"]
    assert misread[told["start"] : told["end"]] == "Vehicle 1 turned right at the intersection."
    assert "vehicles.V1.maneuver" not in {i["field"] for i in result["account"]["items"] if i["kind"] == "lacks"}
    assert result["account"]["verdict"] != "whole"


def test_a_wrong_answer_is_asked_once_and_the_corrected_one_is_written(answered):
    wrong = copy.deepcopy(RIGHT)
    wrong["actors"][0] |= {"maneuver": "straight", "exit_road": "N"}
    result = answered(TEXT, wrong, RIGHT)
    assert (result["status"], result["attempts"]["scenario"]) == ("generated", 2)
    assert "vehicles.V1.maneuver" not in disputed(result)
    assert next(a for a in result["actors"] if a["id"] == "V1")["maneuver"] == "turn_left"


def test_a_told_contact_that_is_never_declared_exhausts_the_stage(answered):
    result = answered(TEXT, UNTOLD)
    assert (result["status"], result["attempts"]["scenario"]) == ("exhausted", 10)
