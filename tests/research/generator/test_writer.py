"""Narratives: families held out, forms, and what sentences tell of the crash."""

import re

import pytest

from research.generator.clauses import contact_clauses, motion_clauses, noise_clauses, scene_clauses
from research.generator.crash.world import WORDS
from research.generator.records import Group
from tests.effort import many
from tests.research.reports import sentences, text_report


@pytest.mark.slow
def test_held_out_families_never_train() -> None:
    marks = (
        "A wrecker removed",
        "was the site of this crash",
        "wandered into oncoming traffic",
        "Hard braking by",
        "No ticket was written",
    )
    trained = [text_report(seed).narrative for seed in range(1500)]
    tested = [text_report(seed, held_out=True).narrative for seed in range(500)]
    for mark in marks:
        assert not any(mark in text for text in trained)
    assert sum(any(mark in text for mark in marks) for text in tested) > 100


@pytest.mark.parametrize(
    "options", [motion_clauses.APPROACH, contact_clauses.IMPACT, scene_clauses.CONDITIONS, noise_clauses.INTERVIEW]
)
def test_both_sides_of_the_split_have_clauses(options: Group) -> None:
    train, test = options.side(held_out=False), options.side(held_out=True)
    assert train
    assert test
    assert not set(train) & set(test)


@pytest.mark.slow
def test_texts_are_thousands_of_forms() -> None:
    shapes = {re.sub(r"\d+|[A-Z][\w-]*", "#", text_report(seed).narrative) for seed in range(1500)}
    assert len(shapes) > 1450


@pytest.mark.slow
@pytest.mark.parametrize("base", range(0, many(1, 8000), 4000))
def test_who_is_told_to_be_behind_is_the_striker(base: int) -> None:
    told = 0
    for seed in range(base, base + 1500):
        report = text_report(seed, length=0.0)
        found = re.search(r"\bV(\d)\b(?![^.]* rest)[^.]* (?:behind|(?<!the )following) V(\d)\b", report.narrative)
        if report.crash.config != "rear_end" or not found:
            continue
        pairs = {(report.crash.actors[c.striker].id, report.crash.actors[c.struck].id) for c in report.crash.contacts}
        assert (f"V{found[1]}", f"V{found[2]}") in pairs
        told += 1
    assert told > 1


def test_no_sign_is_told_of_traffic_that_cannot_come() -> None:
    signed = 0
    for seed in range(many(1500, 2500)):
        report = text_report(seed, length=0.0)
        closed = {leg.flow for leg in report.crash.legs if not leg.lanes_in}
        for end, facts in report.sentences:
            if "control" in facts and closed and "top sign" in report.narrative[:end].rpartition(". ")[2]:
                said = report.narrative[:end].rpartition(". ")[2].lower()
                signed += 1
                wrong = [f"{WORDS[way]}bound" for way in ((flow + 4) % 8 for flow in closed)]
                assert not any(f"for {word}" in said or f"controls {word}" in said for word in wrong)
    assert signed > 3


def test_driveways_are_spoken_of_where_there_is_one() -> None:
    """What one turns into or comes out of tells a driveway, and only a crash that has one speaks so of it."""
    alone = 0
    for seed in range(many(1500, 4500)):
        report = text_report(seed, length=0.0)
        turning = re.search(
            r"turn(?:ed|ing)? (?:left|right) (?:into|out of) (?:a|the) (?:driveway|parking lot)", report.narrative
        )
        if turning is None or report.behavior is None:
            continue
        assert report.crash.layout == "driveway"
        assert "layout" in report.stated
        alone += "driveway" not in report.narrative.split(".")[0]
    assert alone > many(2, 10)


def test_impacts_that_name_nobody_tell_no_striker() -> None:
    seen = 0
    for seed in range(many(1500, 2500)):
        for sentence, facts in sentences(text_report(seed, length=0.0)):
            if "contact.0" in facts:
                assert any(fact.startswith("~named") for fact in facts), sentence
            seen += bool(re.match(r"(This led to|This ended in|There was an impact|An impact occurred)", sentence))
    assert seen > 1
