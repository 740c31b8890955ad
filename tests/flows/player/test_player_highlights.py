"""What lights up with what in the player."""

import math

import numpy as np
import pytest

from flows.player.player_highlights import facts_by_thing, road_along, road_axes, sentences_of, thing_of
from flows.player.road_shapes import Strip
from sgcad_core.case.records import CrashReport
from sgcad_core.reading.text.privacy import redacted
from sgcad_core.reading.text.traced_text import TracedText, runs

WRITTEN = "The driver of V1, a 45-year-old male, was northbound. V1 struck V2."


def rows(report):
    return [fact.model_dump(mode="json") for fact in report.reading.facts]


@pytest.mark.parametrize(
    ("field", "thing"),
    [("vehicles.V1.heading", "V1"), ("others.P1.kind", "P1"), ("contacts.0.striker", "contact"),
     ("roads.main.axis", "road main"), ("roads.N.lanes_forward", ""), ("conditions.light", "")],
)  # fmt: skip
def test_a_fact_is_about_one_thing(field, thing):
    assert thing_of(field) == thing


def test_sentences_are_found_in_the_redacted_text_that_is_shown():
    bare = redacted(TracedText.of(WRITTEN))
    report = CrashReport(case="c", narrative=bare.text, places=runs(bare))
    found = sentences_of(report, rows(report))
    assert [report.narrative[s["start"] : s["end"]] for s in found][-1] == "V1 struck V2."
    assert "contact" in found[-1]["things"]
    assert WRITTEN[found[-1]["of"] :] == "V1 struck V2."


def test_an_assumed_value_is_marked_and_has_no_sentence():
    report = CrashReport(case="c", narrative="V1 was behind V2. V1 struck the rear of V2.")
    kind = next(f for f in facts_by_thing(rows(report))["V1"] if f["name"] == "kind")
    assert (kind["status"], kind["of"]) == ("default", None)


def test_a_lane_belongs_to_the_road_that_it_runs_along_either_way():
    axes = {"road main": math.pi / 2, "road cross": 0.0}
    assert road_along(Strip(np.array([[0.0, 0.0], [1.0, -90.0]]), 3.5, True), axes) == "road main"
    assert road_along(Strip(np.array([[0.0, 0.0], [-90.0, 1.0]]), 3.5, True), axes) == "road cross"
    assert road_along(Strip(np.array([[0.0, 0.0], [9.0, 9.0]]), 3.5, True), axes) == ""


def test_a_lane_around_a_circle_belongs_to_no_road():
    quarter = np.linspace(-3 * math.pi / 4, -math.pi / 4, 9)
    around = Strip(20 * np.column_stack((np.cos(quarter), np.sin(quarter))), 3.5, True)
    assert road_along(around, {"road cross": 0.0}) == ""


def test_roads_run_as_their_axis_facts_say():
    report = CrashReport(case="c", narrative="V1 was traveling north on the north/south road.")
    assert road_axes(rows(report)) == {"road main": pytest.approx(math.pi / 2)}


def test_sentences_carry_the_gravest_thing_that_the_account_says_of_them():
    text = "V1 was northbound. A purple balloon hovered. V1 struck V2."
    report = CrashReport(case="c", narrative=text)
    facts = [{"field": "vehicles.V1.heading", "start": 0, "end": 18, "status": "stated"}]
    items = [
        {"kind": "unread", "start": 19, "end": 44}, {"kind": "lacks", "start": 0, "end": 18},
        {"kind": "contradicts", "start": 0, "end": 18}, {"kind": "assumed", "start": None, "end": None},
    ]  # fmt: skip
    found = {text[s["start"] : s["end"]]: s["mark"] for s in sentences_of(report, facts, items)}
    assert found == {"V1 was northbound.": "contradicts", "A purple balloon hovered.": "unread"}
    assert [s["mark"] for s in sentences_of(report, facts)] == ["read"]
