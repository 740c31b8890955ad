"""Three narratives from end to end: each is drawn as told, or its account says what lacks."""

import json

import pytest

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from sgcad_core.config import load
from sgcad_core.settings import ROOT

PEDESTRIAN = (
    "Vehicle 1, a 2004 Honda Accord, was traveling north on a two-lane road and approached a T-intersection controlled "
    "by a stop sign. Vehicle 1 stopped at the stop sign and then turned left onto the east/west road. While turning "
    "left, the front of Vehicle 1 struck a pedestrian who was crossing the west leg of the intersection."
)
ROUNDABOUT = (
    "Vehicle 1, a 2010 Ford Focus, was traveling eastbound and entered a two-lane roundabout in the right lane. "
    "Vehicle 2, a 2012 Toyota Camry, was circulating in the inner lane of the roundabout. Vehicle 2 exited the "
    "roundabout across the path of Vehicle 1 and the right side of Vehicle 2 was struck by the front of Vehicle 1."
)
CHAIN = (
    "Vehicle 1, Vehicle 2 and Vehicle 3 were traveling westbound on a three-lane road in the same lane. Vehicle 3 "
    "stopped for traffic. Vehicle 2 stopped behind Vehicle 3. Vehicle 1 did not stop and struck the back of Vehicle 2 "
    "with its front. Vehicle 2 was pushed forward and its front struck the back of Vehicle 3."
)


@pytest.fixture
def result(tmp_path):
    """Runs a narrative with the template: the content of its result.json, and its folder."""

    def run(text):
        source = tmp_path / "c1"
        source.mkdir()
        (source / "report.txt").write_text(text)
        config = load(ROOT / "configs/template.yaml", ("tracker=none",))
        ending = run_case(config, Case(source, "c1"), tmp_path / "out", "d")
        return ending.result, tmp_path / "out" / "template" / "c1"

    return run


def lacking(result):
    return {item["field"]: item for item in result["account"]["items"] if item["kind"] == "lacks"}


def has(result):
    return {item["field"] for item in result["account"]["items"] if item["kind"] == "has"}


def honest(result, field):
    """Whether a thing that is told is there or said to be lacking, and the verdict agrees with the items."""
    account = result["account"]
    beside = [item["kind"] for item in account["items"] if item["kind"] in ("unread", "contradicts", "guessed")]
    assert (account["verdict"] == "lacking") == bool(account["lacking"])
    assert account["verdict"] != "whole" or not beside
    assert account["told"] == account["has"] + account["lacking"]
    return field in has(result) or field in lacking(result)


def test_a_turn_from_a_stop_sign_that_hits_a_pedestrian_tells_where_the_sign_lacks(result):
    told, _ = result(PEDESTRIAN)
    assert {"others.P1.word", "contacts.0.striker", "vehicles.V1.maneuver"} <= has(told)
    assert honest(told, "text.sign")
    assert honest(told, "text.leg")


def test_in_a_roundabout_who_circulates_is_on_the_circle_in_the_told_lane_or_that_lacks(result):
    told, _ = result(ROUNDABOUT)
    assert "junction.kind" in has(told)
    assert honest(told, "text.around")
    assert honest(told, "contacts.0.struck_area")


def test_a_third_car_that_is_not_reached_is_told_as_lacking(result):
    told, _ = result(CHAIN)
    assert honest(told, "contacts.1.striker")
    touched = {frozenset((t["actor"], t["other"])) for t in [told["collision"]["observed"]]}
    assert frozenset(("V1", "V2")) in touched
    if "contacts.1.striker" in lacking(told):
        assert lacking(told)["contacts.1.striker"]["start"] == CHAIN.index("Vehicle 2 was pushed")


def test_a_case_that_lacks_something_is_green_nowhere(result):
    told, folder = result(CHAIN + " Vehicle 4 was then struck in the rear by Vehicle 3.")
    account = told["account"]
    assert account["verdict"] == "lacking"
    data = json.loads((folder / "player.html").read_text().split('id="data">')[1].split("</script>")[0])
    assert data["account"]["verdict"] == "lacking"
    assert [i["text"] for i in data["account"]["items"]] == [i["text"] for i in account["items"]]


def test_rule_based_attempts_show_what_was_read_and_written(result):
    _, folder = result(CHAIN)
    for stage, word in (("road", "roads.main.lanes_total = 3"), ("scenario", "vehicles.V2.maneuver = stopped")):
        attempt = folder / "attempts" / f"{stage}-01"
        assert word in (attempt / "prompt.txt").read_text()
        assert (attempt / "answer.txt").read_text().strip()


def test_facts_hold_start_road_lane_speed_and_exit_of_every_actor(result):
    told, _ = result(PEDESTRIAN)
    fields = {f["field"]: f for f in told["facts"]}
    for at in ("vehicles.V1", "others.P1"):
        assert {f"{at}.{name}" for name in ("start_road", "start_lane", "start_speed_mph", "exit_road")} <= set(fields)
    speed = fields["vehicles.V1.start_speed_mph"]  # it starts from rest at the sign, as told
    assert (speed["value"], speed["basis"]) == (0, "text")


def test_replaced_words_are_marked_and_report_and_badge_numbers_go(result):
    told, folder = result(CHAIN + " A 34-year-old male drove Vehicle 2 north, badge number 4711.")
    text = (folder / "report.txt").read_text()
    assert "4711" not in text
    assert told["redactions"]
    assert all(0 <= r["start"] <= r["end"] <= len(text) and r["removed"] for r in told["redactions"])
    assert any(text[r["start"] : r["end"]].strip().lower() in "a person" for r in told["redactions"])
