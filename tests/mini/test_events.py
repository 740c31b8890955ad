"""Sentences about the collision: what they say beside their slots is so."""

import re
from collections import Counter
from random import Random

import pytest

from mini.generator import clauses_contact, clauses_motion, events, impacts, writer
from mini.generator.crash import sample_crash
from mini.generator.events import DRIFTS
from mini.generator.impacts import ORDERS, order_of
from mini.generator.report import make_report
from mini.generator.settled import VAGUE
from mini.generator.world import WORDS
from tests.mini.reports import sentences


@pytest.mark.parametrize(
    "clause",
    [
        "{V} drifted to the right",
        "Easing to the right, {V} headed toward {W}",
        "A deviation to the right brought {V} toward {W}",
        "The course of {V} bent to the right",
        "{V} got over against the line of parked cars",
        "{V} was guided too far right by its driver",
        "Over to the right went {V}, where {W} was parked",
        "The driver of {V} let the wheel slip rightward",
    ],
)
def test_clauses_of_one_that_leaves_its_lane_are_known(clause: str) -> None:
    assert DRIFTS.search(clause)


@pytest.mark.parametrize(
    "clause",
    [
        "The driver of {V} did not see {W} parked ahead",
        "{V} was too far to the right",
        "{V} did not leave enough room to pass {W}",
        "The driver of {V} was attending to a child and did not see the parked {W}",
        "On a slippery road {V} passed too close to {W}",
    ],
)
def test_clauses_of_one_that_may_have_kept_its_lane_are_not_taken_for_a_drift(clause: str) -> None:
    assert not DRIFTS.search(clause)


def test_one_that_keeps_its_lane_is_not_said_to_drift_into_a_parked_vehicle() -> None:
    seen = 0
    for seed in range(6000):
        report = make_report(seed, length=0.0, modes={"text": 1.0})
        if report.crash.config != "parked" or any(a.maneuver.startswith("departing") for a in report.crash.actors):
            continue
        seen += 1
        drifts = r"(drifted|strayed|moved|went|crept) (over )?(to the )?right|right, toward"
        told = [text for text, facts in sentences(report) if re.search(drifts, text) and "~named0.V1" in facts]
        assert not [text for text in told if "parked" in text], told
    assert seen > 30


@pytest.mark.parametrize("slot", ["outdir", "outxb"])
def test_where_one_that_turns_goes_tells_where_it_came_from(slot: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "ONWARD", [f"QQ {{V}} {{turn}} {{{slot}}}"])
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
    monkeypatch.setattr(events, "STRAYS", ["QQ {turn} from {aside}"])
    monkeypatch.setattr(events, "STRAYING", 1.0)
    monkeypatch.setattr(writer, "slips", lambda _, text, __: text)
    told = [
        (text, report.crash)
        for report in (make_report(seed, length=0.0, modes={"text": 1.0}) for seed in range(1500))
        for text, _ in sentences(report)
        if text.startswith("QQ")
    ]
    assert len(told) > 30
    for text, crash in told:
        side = next(a.maneuver for a in crash.actors if a.maneuver.startswith("lane_change")).rsplit("_", 1)[1]
        assert text.split()[1] == side
        assert {text.split()[1], text.rstrip(".").split()[3]} == {"left", "right"}


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


def test_who_stands_for_a_light_or_a_sign_tells_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(clauses_motion.WHY, "light", ["QLIGHT"])
    monkeypatch.setitem(clauses_motion.WHY, "sign", ["QSIGN"])
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
