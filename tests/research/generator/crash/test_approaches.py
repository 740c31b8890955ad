"""How vehicles come to the crash: what a sentence tells is what its words say."""

import re
from random import Random

import pytest

from research.generator import words, writer
from research.generator.clauses import motion_clauses
from research.generator.crash import approaches
from research.generator.crash.compass_ties import STEM
from research.generator.crash.crash import sample_crash
from research.generator.crash.world import Leg
from research.generator.records import group
from research.generator.report import make_report
from tests.research.reports import only, sentences, text_report

LISTS = ("APPROACH", "APPROACH_STOPPED", "APPROACH_SLOWING", "APPROACH_WAITING")


@pytest.mark.parametrize("held_out", [False, True])
def test_what_a_clause_has_no_place_for_is_not_told(held_out: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in LISTS:
        monkeypatch.setattr(motion_clauses, name, group("{V} came {dir} QQ", "~{V} came {dir} QQ"))
    monkeypatch.setattr(
        motion_clauses, "PRESENTED", {key: group("{Vi} came {dir} QQ") for key in motion_clauses.PRESENTED}
    )
    seen = 0
    for seed in range(300):
        report = make_report(seed, held_out, 0.0, {"text": 1.0})
        meant = {actor.id for actor in report.crash.actors if actor.meant}
        for sentence, facts in sentences(report):
            if "QQ" in sentence:
                seen += 1
                keys = {fact.partition(".")[0] for fact in facts}
                assert not keys & {"layout", "control", "lanes"}
                assert not facts & {f"exit.{name}" for name in meant}
    assert seen > 200


def test_what_a_clause_has_a_place_for_is_told_where_words_stand_in_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion_clauses, "APPROACH", group("{V} came {dir} QQ{appr}"))
    monkeypatch.setattr(motion_clauses, "INTENT", {key: group("RR") for key in motion_clauses.INTENT})
    told = plain = 0
    for seed in range(300):
        report = make_report(seed, False, 0.0, {"text": 1.0})
        for sentence, facts in sentences(report):
            if "QQ" in sentence:
                assert ("RR" in sentence) == any(fact.startswith("exit.") for fact in facts)
                told, plain = told + ("RR" in sentence), plain + ("RR" not in sentence)
    assert told > 20
    assert plain > 20


@pytest.mark.slow
def test_the_same_intersection_is_one_that_was_named() -> None:
    seen = 0
    for seed in range(1500):
        text = text_report(seed, length=0.0).narrative
        if "the same intersection" in text:
            seen += 1
            before = text[: text.index("the same intersection")].lower()
            assert re.search(r"intersection|junction|cross(?:ing|roads)|corner", before), text
    assert seen > 30


@pytest.mark.slow
def test_who_came_up_the_leg_that_ends_came_from_where_that_lies(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion_clauses, "FROM_STEM", {"t": group("QQ {V}"), "driveway": group("QQ {V}")})
    monkeypatch.setattr(approaches, "UNSAID", 1.0)
    only(monkeypatch, lambda crash: len(crash.stems) == 1)
    known = open_ = 0
    for seed in range(600):
        report = make_report(seed, False, 0.0, {"text": 1.0})
        before: set[str] = set()
        for text, facts in sentences(report):
            if text.startswith("QQ"):
                headed = {fact for fact in facts if fact.startswith("heading.")}
                assert bool(headed) == (STEM in before)
                assert all(actor.leg == report.crash.stems[0].bearing for actor in report.crash.actors
                           if f"heading.{actor.id}" in headed)  # fmt: skip
                known, open_ = known + bool(headed), open_ + (not headed)
            before |= facts
    assert known > 10 < open_


def test_the_only_lane_may_be_called_the_first_but_not_on_the_held_out_side() -> None:
    leg = Leg(0, 1, 1)
    counted = r"(first|right|one|1)\b"
    found = [
        words.lane(Random(seed), leg, 1, "southbound", held_out).text
        for held_out in (False, True)
        for seed in range(400)
    ]
    assert 60 < sum(bool(re.search(counted, name)) for name in found[:400]) < 220
    assert not [name for name in found[400:] if re.search(counted, name)]


def test_a_lane_that_is_named_by_its_direction_tells_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion_clauses, "APPROACH", group("QQ {V} in the {lane}"))
    monkeypatch.setattr(writer, "slips", lambda _, text, __: text)
    named = other = 0
    for seed in range(300):
        report = make_report(seed, False, 0.0, {"text": 1.0})
        for text, facts in sentences(report):
            if not text.startswith("QQ"):
                continue
            bound = re.search(r"bound\b|\b[NSEW]/B", text)
            assert bool(bound) == any(fact.startswith("heading.") for fact in facts), text
            named, other = named + bool(bound), other + (not bound)
    assert named > 30 < other


def test_who_has_the_way_does_not_stop_where_the_others_have_a_sign() -> None:
    paused = {True: 0, False: 0}
    for seed in range(400):
        own = writer.Writer(Random(seed), sample_crash(Random(seed), "crossing"), False, 1.0)
        controls = {leg.bearing: leg.control for leg in own.crash.legs}
        free = controls[own.crash.actors[own.who[0]].leg] == "none" and {"stop", "yield"} & set(controls.values())
        paused[bool(free)] += bool(own._pauses(own.who[0]))
    assert paused[True] == 0
    assert paused[False] > 30
