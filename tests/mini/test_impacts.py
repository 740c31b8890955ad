"""Sentences of contacts: what they tell and of whom."""

import re
from collections import Counter
from random import Random

import pytest

from mini.generator import clauses_contact, impacts, writer
from mini.generator.crash import sample_crash
from mini.generator.impacts import MUTUAL, ORDERS, order_of
from mini.generator.report import make_report
from tests.mini.reports import sentences


@pytest.mark.parametrize(
    ("kind", "strange"), [("motorcycle", "door|hood|trunk|cab "), ("car", "saddlebag|fork|handlebar")]
)
def test_no_vehicle_is_hit_on_a_part_that_it_has_not(kind: str, strange: str) -> None:
    crash = sample_crash(Random(3))
    own = writer.Writer(Random(0), crash, False, 0.0)
    for area in ("front", "left", "right", "back"):
        found = {own._area(area, kind) for _ in range(300)}
        assert len(found) > 30
        assert not [part for part in found if re.search(strange, part)]


@pytest.mark.parametrize(
    ("clause", "order"),
    [
        ("The {sa} of {S} struck the {ta} of {T}", "striker"),
        ("With its {sa}, {S} damaged the {ta} of {T}", "striker"),
        ("By {S} was struck the {ta} of {T}", "striker"),
        ("The {ta} of {T} was struck by the {sa} of {S}", "struck"),
        ("{T} caught the {sa} of {S} on its {ta}", "struck"),
        ("{T}'s {ta} was struck by {S}", "struck"),
        ("Up the {ta} of {T} rode the {sa} of {S}", "place"),
        ("On its {ta} {T} was struck by {S}", "place"),
        ("The vehicles collided", "striker"),
    ],
)
def test_a_clause_of_a_contact_names_somebody_first(clause: str, order: str) -> None:
    assert order_of(clause) == order


def test_where_sides_do_not_tell_who_strikes_every_order_of_words_trains_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    made: dict[bool, Counter[str]] = {True: Counter(), False: Counter()}
    contact = impacts.ImpactsMixin._contact

    def recorded(self: impacts.ImpactsMixin, options: list[str], number: int, alike: bool) -> str:
        clause = contact(self, options, number, alike)
        made[alike][order_of(clause)] += options is clauses_contact.IMPACT
        return clause

    monkeypatch.setattr(impacts.ImpactsMixin, "_contact", recorded)
    for seed in range(900):
        make_report(seed, length=0.0, modes={"text": 1.0})
    alike, apart = made[True], made[False]
    assert min(alike[order] for order in ORDERS) > 0.25 * alike.total()
    assert apart["striker"] > 0.5 * apart.total() > 0 < apart["place"] < 0.2 * apart.total()


def test_held_out_clauses_of_a_contact_are_drawn_as_they_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(impacts, "order_of", lambda clause: pytest.fail(f"asked for the order of {clause}"))
    found = {text for seed in range(60) for text, facts in sentences(make_report(seed, True)) if "contact.0" in facts}
    assert len(found) > 30


@pytest.mark.parametrize(
    "clause",
    [
        "{S} and {T} hit each other",
        "The {sa} of {S} met the {ta} of {T}",
        "Contact was the {sa} of {S} to the {ta} of {T}",
        "{S} had a collision with {T}",
        "{S} came into contact with {T}",
        "{S} vs. {T}",
        "Both vehicles collided, {sa} of {S} against {ta} of {T}",
    ],
)
def test_clauses_of_both_tell_nobody_who_strikes(clause: str) -> None:
    assert MUTUAL.search(clause)


@pytest.mark.parametrize(
    "clause",
    [
        "The {sa} of {S} met and hit the {ta} of {T}",
        "{S} and {T} collided; {T} was struck by the {sa} of {S}",
        "Both vehicles met, the {ta} of {T} receiving the {sa} of {S}",
        "{S} crashed into {T}",
        "Through the {ta} of {T} broke the {sa} of {S}",
    ],
)
def test_clauses_that_say_who_runs_into_whom_tell_it(clause: str) -> None:
    assert not MUTUAL.search(clause)


def test_what_is_chosen_in_a_clause_decides_whether_it_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clauses_contact, "IMPACT", ["QQ the {sa} of {S} [met|hit] the {ta} of {T}"])
    told = {"met": 0, "hit": 0}
    for seed in range(500):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        first = report.crash.contacts[0]
        for text, facts in sentences(report):
            if text.startswith("QQ") and first.striker_area == first.struck_area:
                word = "met" if " met " in text else "hit"
                told[word] += 1
                assert ("contact.0" in facts) == (word == "hit")
    assert min(told.values()) > 10


def test_nobody_sits_in_a_parked_vehicle_that_is_struck() -> None:
    parked = 0
    for seed in range(4000):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        struck = report.crash.actors[report.crash.contacts[0].struck]
        if struck.maneuver == "parked":
            told = [text for text, facts in sentences(report) if "areas.0" in facts and f"~named0.{struck.id}" in facts]
            parked += len(told)
            assert not [text for text in told if re.match(r"The (driver|operator|occupants|passengers?) ", text)]
    assert parked > 30


def test_a_third_vehicle_is_not_said_to_have_been_in_the_first_impact() -> None:
    thirds = 0
    for seed in range(6000):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        contacts = report.crash.contacts
        if len(contacts) < 2 or contacts[1].striker in (contacts[0].striker, contacts[0].struck):
            continue
        for text, facts in sentences(report):
            if "contact.1" in facts:
                thirds += 1
                assert not re.search(r"forced into|was pushed|rebound|from the impact", text, re.IGNORECASE), text
    assert thirds > 20


@pytest.mark.parametrize("words", ["LEADS", "TAILS"])
def test_nothing_is_said_of_both_where_one_strikes_a_thing(words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clauses_contact, words, ["both drivers agree"])
    seen = 0
    for seed in range(600):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        for text, facts in sentences(report):
            if "areas.0" in facts and "both drivers agree" in text.lower():
                seen += 1
                assert report.crash.actors[report.crash.contacts[0].struck].vehicle
    assert seen > 20
