"""Sentences on the place: they speak of the road, and only of what there is."""

import re
from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from research.generator.clauses import scene_clauses
from research.generator.crash.compass_ties import AXIS
from research.generator.crash.crash import sample_crash
from research.generator.crash.scene import TIMES
from research.generator.phrase_labels import has, plain
from research.generator.records import group
from research.generator.report import Report, make_report
from research.generator.writer import Writer
from tests.effort import many
from tests.research.reports import sentences, text_report

seeds = st.integers(0, 10**6)


def _said(word: str, count: int, held_out: bool = False) -> list[tuple[str, frozenset[str], Report]]:
    """Sentences with a word, what they tell, and their reports."""
    found = []
    for seed in range(count):
        report = make_report(seed, held_out, 0.0, {"text": 1.0})
        found += [(text, facts, report) for text, facts in sentences(report) if word in text]
    return found


def test_the_direction_of_a_roads_traffic_is_no_vehicles_heading(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene_clauses, "ROAD", group("QQ for {xb} traffic"))
    monkeypatch.setattr(scene_clauses, "CURVE", group("QQ {curve} for those who drive {dir}"))
    found = _said("QQ", 120)
    assert len(found) > 60
    for _, facts, _ in found:
        assert not any(fact.startswith("heading.") for fact in facts)
        assert any(fact.startswith(AXIS) for fact in facts)


@pytest.mark.parametrize("slot", ["lim", "lim2"])
def test_no_limit_is_told_of_a_road_without_one(slot: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROAD", "ROAD2"):
        monkeypatch.setattr(scene_clauses, name, group(f"QQ {{{slot}}}", "RR"))
    found = _said("QQ", 300)
    assert len(found) > 40
    assert all(any(fact.startswith("limit.") for fact in facts) for _, facts, _ in found)


@given(seed=seeds)
def test_roads_that_bend_are_not_called_straight(seed: int) -> None:
    writer = Writer(Random(seed), sample_crash(Random(seed)), False, 1.0)
    bends = any(leg.curve != "none" for leg in writer.crash.legs)
    assert ("unbent" in writer._untrue()) == bends
    straight = [clause for clause in scene_clauses.ROAD.side(False) if has(clause, "unbent")]
    assert straight
    assert not any("{curve}" in clause for clause in straight)


def test_openings_speak_of_two_vehicles_where_there_are_two() -> None:
    found = 0
    for report in (text_report(seed, length=0.0) for seed in range(900)):
        opening = report.narrative[: report.sentences[0][0]]
        if "two cars" in opening or "wo-vehicle" in opening:
            found += 1
            assert report.crash.actors[1].id.startswith("V"), opening
    assert found > 10


def test_no_lane_is_named_for_a_crash_on_the_wrong_side_of_the_road() -> None:
    seen = 0
    for seed in range(4000):
        crash = sample_crash(Random(seed))
        if crash.config in ("head_on", "overtaking"):
            seen += 1
            assert "own_lanes" in Writer(Random(seed), crash, False, 1.0)._untrue()
    assert seen > 100
    lanes = "The crash [occurred|took place] in the {xb} lane[s|] of {road} [at|near] {jn}"
    (clause,) = {one for one in scene_clauses.OPENING_JUNCTION.side(False) if plain(one) == lanes}
    assert has(clause, "own_lanes")


@pytest.mark.parametrize("held_out", [False, True])
def test_times_of_day_agree_with_the_light(held_out: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [key for key in vars(scene_clauses) if key.startswith("OPENING")]:
        monkeypatch.setattr(scene_clauses, name, group("QQ {tod} RR {jn}", "~QQ {tod} RR {jn}"))
    monkeypatch.setattr("research.generator.writer.slips", lambda rng, text, rate: text)
    found = _said("QQ", 150, held_out)
    assert len(found) > 40
    for sentence, _, report in found:
        assert re.search("QQ (.*) RR", sentence)[1] in TIMES[report.crash.light]  # type: ignore[index]


@settings(max_examples=200)
@given(seed=seeds, order=st.lists(st.booleans(), min_size=2, max_size=6))
def test_the_same_road_is_the_one_that_was_named_last(seed: int, order: list[bool]) -> None:
    crash = sample_crash(Random(seed))
    assume(crash.layout in ("four", "t"))
    writer = Writer(Random(seed), crash, True, 1.0)
    last = None
    for main in order:
        axis = (crash.main + 2 * (not main)) % 4
        if "same" in writer._road(axis):
            assert last == axis
        last = axis


def test_the_sun_does_not_shine_at_night() -> None:
    suns = dict.fromkeys(("day", "dark", "dark_lit", "dusk", "dawn"), 0)
    for seed in range(many(1500, 4000)):
        report = text_report(seed, length=0.0)
        for sentence, facts in sentences(report):
            suns[report.crash.light] += "weather" in facts and bool(
                re.search(r"(?<!not )\b(sunny|sunshine)\b", sentence)
            )
    assert suns.pop("day") > 50
    assert not any(suns.values())


@pytest.mark.slow
def test_sun_tells_daylight_and_a_clear_sky(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene_clauses, "CONDITIONS", group("QQ {wx}", "RR {light}"))
    for name, key in (("LIGHT", "day"), ("WEATHER", "clear")):
        monkeypatch.setitem(
            getattr(scene_clauses, name), key, group("in bright sunshine<sunny><bright><sunlit>", "plain")
        )
    sunny = 0
    for text, facts, report in [*_said("QQ", 300), *_said("RR", 300)]:
        assert ("sunshine" in text) == ({"light", "weather"} <= facts)
        sunny += "sunshine" in text
        assert "sunshine" not in text or (report.crash.light, report.crash.weather) == ("day", "clear")
    assert sunny > 40


def test_legs_that_nobody_comes_by_have_no_control() -> None:
    crashes = [sample_crash(Random(seed)) for seed in range(600)]
    legs = [leg for crash in crashes for leg in crash.legs if crash.layout in ("four", "t")]
    assert {leg.control for leg in legs if not leg.lanes_in} == {"none"}
    assert len({leg.control for leg in legs if leg.lanes_in}) > 3


def test_who_merges_meets_the_lane_at_the_ramp() -> None:
    crashes = [sample_crash(Random(seed), "merge") for seed in range(60)]
    assert {actor.lane for crash in crashes for actor in crash.actors} == {1}
