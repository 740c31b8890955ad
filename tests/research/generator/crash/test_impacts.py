"""Sentences of contacts: what they tell and of whom."""

import re
from collections import Counter
from collections.abc import Iterator
from itertools import product
from random import Random

import pytest

from research.generator import report as reports
from research.generator import writer
from research.generator.clauses import contact_clauses
from research.generator.crash import impacts
from research.generator.crash.crash import sample_crash
from research.generator.crash.impacts import ORDERS, order_of
from research.generator.records import Group, group
from research.generator.report import Report, make_report
from tests.effort import spread
from tests.research.reports import sentences


@pytest.mark.parametrize(
    ("kind", "strange"),
    [
        ("motorcycle", "door|hood|trunk|cab |window|quarter|trailer"),
        ("car", "saddlebag|fork|handlebar|foot peg|pannier"),
    ],
)
def test_no_vehicle_is_hit_on_a_part_that_it_has_not(kind: str, strange: str) -> None:
    crash = sample_crash(Random(3))
    own = writer.Writer(Random(0), crash, False, 0.0)
    for area in ("front", "left", "right", "back"):
        found = {own._area(area, kind) for _ in range(300)}
        assert len(found) > 30
        assert not [part for part in found if re.search(strange, part)]


def _chosen(held_out: bool, count: int, monkeypatch: pytest.MonkeyPatch) -> list[tuple[Group, bool, str]]:
    """Every clause of a contact in made reports, behind its list and whether sides leave open who strikes."""
    chosen = []
    contact = impacts.ImpactsMixin._contact

    def recorded(self: impacts.ImpactsMixin, options: Group, number: int, alike: bool) -> str:
        clause = contact(self, options, number, alike)
        chosen.append((options, alike, clause))
        return clause

    monkeypatch.setattr(impacts.ImpactsMixin, "_contact", recorded)
    for seed in range(count):
        make_report(seed, held_out, length=0.0, modes={"text": 1.0})
    return chosen


@pytest.mark.slow
def test_where_sides_do_not_tell_who_strikes_every_order_of_words_trains_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    made: dict[bool, Counter[str]] = {True: Counter(), False: Counter()}
    for options, open_, clause in _chosen(False, 900, monkeypatch):
        made[open_][order_of(clause)] += options is contact_clauses.IMPACT
    alike, apart = made[True], made[False]
    assert min(alike[order] for order in ORDERS) > 0.25 * alike.total()
    assert apart["striker"] > 0.5 * apart.total() > 0 < apart["place"] < 0.2 * apart.total()


def test_held_out_clauses_of_a_contact_stand_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = _chosen(True, 150, monkeypatch)
    assert set(contact_clauses.IMPACT.side(True)) < {clause for *_, clause in chosen}
    assert all(clause in options.side(True) for options, _, clause in chosen)


def test_what_is_chosen_in_a_clause_decides_whether_it_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_clauses, "IMPACT", group("QQ the {sa} of {S} [met<mutual>|hit] the {ta} of {T}"))
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


def _contacts(config: str, number: int, count: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[str, Report]]:
    """The sentences of contacts of a number in made reports of one kind of crash, slips apart."""
    monkeypatch.setattr(reports, "sample_crash", lambda rng: sample_crash(rng, config))
    monkeypatch.setattr(writer, "slips", lambda _, text, __: text)
    for seed in range(count):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        for text, facts in sentences(report):
            if f"areas.{number}" in facts:
                yield text, report


def test_nobody_sits_in_a_parked_vehicle_that_is_struck(monkeypatch: pytest.MonkeyPatch) -> None:
    clauses = [
        "QQ the {ta} of {T} was hit by the {sa} of {S}",
        "The [driver|man] in {T} felt the {sa} of {S} at the {ta}<manned>",
        "{T}'s driver saw {S} hit the {ta} with its {sa}<manned>",
    ]
    monkeypatch.setattr(contact_clauses, "IMPACT", group(*clauses))
    monkeypatch.setattr(contact_clauses, "LEADS", group("While both were still moving<both>"))
    told = [text for text, _ in _contacts("parked", 0, 200, monkeypatch)]
    assert len(told) > 100
    assert all(text.startswith("QQ") for text in told), told


@pytest.mark.slow
def test_a_third_vehicle_was_not_in_the_first_impact_and_the_other_was(monkeypatch: pytest.MonkeyPatch) -> None:
    clauses = [
        "{S} was [knocked|propelled] into {T}, {sa} to {ta}<again>",
        "{T} got involved when {S} hit its {ta} with the {sa}<fresh>",
    ]
    monkeypatch.setattr(contact_clauses, "THEN", group(*clauses, "QQ the {sa} of {S} hit the {ta} of {T}"))
    told = 0
    for text, report in _contacts("head_on", 1, 1500, monkeypatch):
        first, then = report.crash.contacts[:2]
        assert {then.striker, then.struck} & {first.striker, first.struck} == {then.struck}
        assert "qq the" in text.lower(), text
        told += 1
    assert told > 20


@pytest.mark.parametrize(
    ("words", "place"), spread(product(("both drivers agree", "before either could stop"), ("LEADS", "TAILS")), 4)
)
def test_nothing_is_said_of_both_where_one_strikes_a_thing(
    words: str, place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contact_clauses, place, group(f"{words}<both>"))
    assert not [text for text, _ in _contacts("departure", 0, 300, monkeypatch) if words in text.lower()]
    assert [text for text, _ in _contacts("crossing", 0, 300, monkeypatch) if words in text.lower()]


def test_only_who_strikes_crosswise_strikes_at_an_angle(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_clauses, "TAILS", group("at an angle<crosswise>"))
    monkeypatch.setattr(
        contact_clauses, "IMPACT", group("The {sa} of {S} hit the {ta} of {T}[ in a T-type crash<crosswise>|]")
    )
    angled = re.compile("at an angle|T-type")
    assert not [text for text, _ in _contacts("rear_end", 0, 200, monkeypatch) if angled.search(text)]
    assert len([text for text, _ in _contacts("crossing", 0, 200, monkeypatch) if angled.search(text)]) > 50
