"""Sentences about the collision: what they say beside their slots is so."""

import re
from collections import Counter

import pytest

from research.generator import events, writer
from research.generator.clauses import contact_clauses, error_clauses, motion_clauses
from research.generator.crash.compass_ties import VAGUE
from research.generator.crash.world import WORDS
from research.generator.records import group
from research.generator.report import make_report
from tests.effort import many
from tests.research.reports import only, sentences, text_report


def test_one_that_keeps_its_lane_is_not_said_to_drift_into_a_parked_vehicle(monkeypatch: pytest.MonkeyPatch) -> None:
    only(monkeypatch, lambda crash: crash.config == "parked")
    seen = 0
    for seed in range(200):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        if any(a.maneuver.startswith("departing") for a in report.crash.actors):
            continue
        seen += 1
        drifts = r"(drifted|strayed|moved|went|crept) (over )?(to the )?right|right, toward"
        told = [text for text, facts in sentences(report) if re.search(drifts, text) and "~named0.V1" in facts]
        assert not [text for text in told if "parked" in text], told
    assert seen > 30


@pytest.mark.parametrize("slot", ["outdir", "outxb"])
def test_where_one_that_turns_goes_tells_where_it_came_from(slot: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(error_clauses, "ONWARD", group(f"QQ {{V}} {{turn}} {{{slot}}}"))
    monkeypatch.setattr(events, "BOUND", 1.0)
    monkeypatch.setattr(writer, "slips", lambda _, text, __: text)
    seen = 0
    for seed in range(400):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        for text, facts in sentences(report):
            if not text.startswith("QQ"):
                continue
            seen += 1
            (actor,) = (a for a in report.crash.actors if f"man.{a.id}" in facts)
            assert {f"heading.{actor.id}", f"exit.{actor.id}"} <= facts
            assert actor.maneuver in {f"turn_{word}" for word in text.split()}
            assert slot == "outxb" or text.rstrip(".").endswith(f" {WORDS[actor.out or 0]}")
    assert seen > 60


def test_who_comes_from_beside_the_road_comes_from_the_side_that_it_leaves(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(error_clauses, "STRAYS", group("QQ {turn} from {aside}"))
    monkeypatch.setattr(events, "STRAYING", 1.0)
    monkeypatch.setattr(writer, "slips", lambda _, text, __: text)
    only(monkeypatch, lambda crash: crash.config == "lane_change")
    told = [
        (text, report.crash)
        for report in (make_report(seed, length=0.0, modes={"text": 1.0}) for seed in range(150))
        for text, _ in sentences(report)
        if text.startswith("QQ")
    ]
    assert len(told) > 30
    for text, crash in told:
        side = next(a.maneuver for a in crash.actors if a.maneuver.startswith("lane_change")).rsplit("_", 1)[1]
        assert text.split()[1] == side
        assert {text.split()[1], text.rstrip(".").split()[3]} == {"left", "right"}


@pytest.mark.slow
def test_who_stands_for_a_light_or_a_sign_tells_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(motion_clauses.WHY, "light", group("QLIGHT<signal>"))
    monkeypatch.setitem(motion_clauses.WHY, "sign", group("QSIGN<sign>"))
    lights = signs = 0
    for seed in range(1200):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        controls = {leg.control for leg in report.crash.legs if leg.lanes_in}
        for text, facts in sentences(report):
            if "QLIGHT" in text:
                lights += 1
                assert ("control" in facts) == (controls == {"signal"})
            if "QSIGN" in text:
                signs += 1
                assert {"control", f"{VAGUE}.control"} <= facts
    assert lights > 20 < signs


def test_the_one_that_is_pushed_is_the_one_that_was_struck(monkeypatch: pytest.MonkeyPatch) -> None:
    moved = ["QQ {V} was pushed aside<moved_v>", "QQ the impact [pushed|moved] {W} back<moved_w>"]
    clauses = group(*moved, "RR {V} stopped", "~SS {V} rolled")
    monkeypatch.setattr(contact_clauses, "REST", clauses)
    said = Counter[str]()
    for seed in range(400):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        struck = report.crash.actors[report.crash.contacts[0].struck]
        for text, facts in sentences(report):
            said[text[:2]] += text[:2] in ("QQ", "RR", "SS")
            if text.startswith("QQ"):
                assert f"~named0.{struck.id}" in facts
                assert struck.vehicle
    assert said["QQ"] > 150 < said["RR"]
    assert not said["SS"]


def test_who_goes_along_a_bend_is_not_told_to_by_an_error() -> None:
    bends = 0
    for seed in range(many(1500, 3000)):
        report = text_report(seed, length=0.0)
        for actor in (a for a in report.crash.actors if a.maneuver == "negotiating_curve"):
            told = [text for text, facts in sentences(report) if f"man.{actor.id}" in facts]
            bends += len(told)
            assert all(re.search(r"curv|bend|bent|turn|round|arc|sweep|wind", text, re.IGNORECASE) for text in told), (
                told
            )
    assert bends > 20
