"""A report of named streets from text to folder: the crash stands on the real junction, and the result says so."""

import pytest

from flows.case.case_in_words import lines
from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from flows.study_file.arm_config import load_config
from sgcad_core import settings

TOWN = settings.CONFIGS / "extracts" / "streets.osm"
REPORT = (
    "Unit 1 was traveling northbound on N Maple Street, a four-lane, two-way road. Unit 2 was traveling eastbound on "
    "East 5th Avenue. The intersection is controlled by {control}. Unit 1 entered on a red light and its front struck "
    "the right side of Unit 2."
)


@pytest.fixture
def run(tmp_path):
    """Runs a report with the bundled town: `run(text)` gives result.json and the case's folder."""

    def go(text):
        source = tmp_path / "c1.txt"
        source.write_text(text)
        config = load_config("template.yaml", [f"road_writer.places={TOWN}", "tracker=none"])
        ending = run_case(config, Case(source, "c1"), tmp_path / "runs", "digest")
        return ending.result, tmp_path / "runs" / config.name / "c1"

    return go


def test_a_crash_at_a_named_junction_is_planned_on_its_real_roads(run):
    result, folder = run(REPORT.format(control="a traffic signal"))
    assert (result["status"], result["account"]["verdict"]) == ("generated", "whole")
    assert result["collision"]["realised"]
    place = result["place"]
    assert (place["found"], place["place"]["streets"]) == (True, ["North Maple Street", "East 5th Avenue"])
    drawn = {one["road"]: one["leg"]["heading_deg"] for one in place["legs"]}
    assert drawn == pytest.approx({"N": 12, "S": 192, "E": 102, "W": 282}, abs=0.5)
    agreed = {item["field"] for item in result["account"]["items"] if item["field"].startswith("place.")}
    assert agreed == {"place.on_map.lanes", "place.on_map.control", "place.on_map.one_way"}
    assert place["sentence"] in lines([result])
    assert any(note["kind"] == "place" for note in result["notes"])
    assert "+lat_0=40.0018" in (folder / "road.xodr").read_text()


def test_what_the_map_has_otherwise_is_told_and_costs_the_verdict(run):
    result, _ = run(REPORT.format(control="stop signs for all directions"))
    assert (result["status"], result["account"]["verdict"]) == ("generated", "contradicts")
    assert "the map has it otherwise (control: all_way_stop, on the map signal)" in result["account"]["sentence"]
    told = [line for line in lines([result]) if line.startswith("against the map: control")]
    assert told == [
        "against the map: control: all_way_stop, on the map signal (the scenario has it as the report tells)"
    ]
    item = next(item for item in result["account"]["items"] if item["field"] == "place.on_map.control")
    assert item["start"] == REPORT.index("The intersection is")


def test_a_place_that_is_not_found_is_a_note(run):
    result, _ = run(REPORT.format(control="a traffic signal").replace("Maple", "Walnut"))
    assert result["status"] == "generated"
    assert result["account"]["verdict"] == "whole"
    assert "streets.osm has East 5th Avenue but no N Walnut Street" in result["place"]["sentence"]


def test_without_maps_a_result_has_no_place(run, tmp_path):
    source = tmp_path / "c2.txt"
    source.write_text(REPORT.format(control="a traffic signal"))
    config = load_config("template.yaml", ["tracker=none"])
    assert "place" not in run_case(config, Case(source, "c2"), tmp_path / "runs", "digest").result
