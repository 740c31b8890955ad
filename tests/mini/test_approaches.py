"""How vehicles come to the crash: what a sentence tells is what its words say."""

import re

import pytest

from mini.generator import clauses_motion
from mini.generator.report import make_report
from tests.mini.reports import sentences

LISTS = ("APPROACH", "APPROACH_STOPPED", "APPROACH_SLOWING", "APPROACH_WAITING")


@pytest.mark.parametrize("held_out", [False, True])
def test_what_a_clause_has_no_place_for_is_not_told(held_out: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in LISTS:
        monkeypatch.setattr(clauses_motion, name, ["{V} came {dir} QQ", "~{V} came {dir} QQ"])
    monkeypatch.setattr(clauses_motion, "PRESENTED", {key: ["{Vi} came {dir} QQ"] for key in clauses_motion.PRESENTED})
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
    monkeypatch.setattr(clauses_motion, "APPROACH", ["{V} came {dir} QQ{appr}"])
    monkeypatch.setattr(clauses_motion, "INTENT", {key: ["RR"] for key in clauses_motion.INTENT})
    told = plain = 0
    for seed in range(300):
        report = make_report(seed, False, 0.0, {"text": 1.0})
        for sentence, facts in sentences(report):
            if "QQ" in sentence:
                assert ("RR" in sentence) == any(fact.startswith("exit.") for fact in facts)
                told, plain = told + ("RR" in sentence), plain + ("RR" not in sentence)
    assert told > 20
    assert plain > 20


def test_the_same_intersection_is_one_that_was_named() -> None:
    seen = 0
    for seed in range(1500):
        text = make_report(seed, length=0.0, modes={"text": 1.0}).narrative
        if "the same intersection" in text:
            seen += 1
            before = text[: text.index("the same intersection")].lower()
            assert re.search(r"intersection|junction|cross(?:ing|roads)|corner", before), text
    assert seen > 30
