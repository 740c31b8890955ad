"""What is coded and stated of single vehicles agrees with the crash."""

from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from research.generator.clauses import code_clauses
from research.generator.clauses.noise_blocks import BY_MANEUVER, event_of
from research.generator.clauses.noise_clauses import GROUPS, SPEED
from research.generator.crash.crash import sample_crash
from research.generator.records import Group, group, slots_of
from research.generator.report import make_report
from research.generator.writer import Writer
from tests.effort import many
from tests.research.reports import only, sentences, text_report

seeds = st.integers(0, 10**6)
SLOTS_KNOWN = "V W He he his code move kind doing did anyside spd dir lane xb"


@settings(max_examples=300, deadline=None)
@given(seed=seeds)
def test_critical_events_are_those_of_the_crash(seed: int) -> None:
    writer = Writer(Random(seed), sample_crash(Random(seed)), False, 1.0)
    crash, (v, w) = writer.crash, writer.who
    erring, other = crash.actors[v], crash.actors[w]
    own, met = event_of(crash, v, writer.who), event_of(crash, w, writer.who)
    for key in (own, met):
        assert key is None or key in code_clauses.EVENT
    if own in ("turn_left", "turn_right", "turn_around", "backing", "off_left", "off_right"):
        assert BY_MANEUVER[erring.maneuver] == own
    if own == "into_stopped":
        assert other.maneuver == "stopped"
    if met == "from_opposite":
        assert (erring.leg - other.leg) % 8 == 4
    if met in ("from_crossing", "from_side_left", "from_side_right"):
        assert (erring.leg - other.leg) % 4 == 2
    if met in ("from_behind", "from_left_lane"):
        assert erring.leg == other.leg
    for third in set(range(len(crash.actors))) - {v, w}:
        assert event_of(crash, third, writer.who) is None


def test_every_vehicle_of_a_common_crash_has_a_critical_event() -> None:
    found = 0
    for seed in range(400):
        writer = Writer(Random(seed), sample_crash(Random(seed)), False, 1.0)
        if writer.crash.config in ("crossing", "left_opposite", "left_lateral", "right_into", "rear_end", "head_on"):
            found += 1
            assert all(event_of(writer.crash, index, writer.who) for index in writer.who)
    assert found > 200


@pytest.mark.parametrize(
    "options",
    [
        code_clauses.EVENT_FRAMES,
        code_clauses.MOVEMENT_FRAMES,
        code_clauses.TYPE_FRAMES,
        code_clauses.SELF_FRAMES,
        code_clauses.OTHER_FRAMES,
    ],
)
def test_frames_stand_on_both_sides_of_the_split_and_use_known_slots(options: Group) -> None:
    trained, held = options.side(False), options.side(True)
    assert trained
    assert held
    assert not set(trained) & set(held)
    assert {slot for clause in trained + held for slot in slots_of(clause)} <= set(SLOTS_KNOWN.split())


@pytest.mark.slow
def test_left_turns_are_coded_of_those_who_turn_left() -> None:
    told = 0
    for seed in range(many(1500, 4000)):
        report = text_report(seed)
        turning = {actor.id for actor in report.crash.actors if actor.maneuver == "turn_left"}
        start = 0
        for end, facts in report.sentences:
            sentence, start = report.narrative[start:end].lower(), end
            if "critical" in sentence and "this vehicle turning left" in sentence:
                told += 1
                assert facts & {f"man.{name}" for name in turning}, sentence
    assert told > many(3, 8)


@pytest.mark.slow
@pytest.mark.parametrize("held_out", [False, True])
def test_speeds_are_told_of_those_whom_the_paragraph_has_named(held_out: bool) -> None:
    pronouns = 0
    for seed in range(500):
        report = text_report(seed, held_out, length=0.8)
        vehicles = [actor for actor in report.crash.actors if actor.id.startswith("V")]
        begun = 0
        for end, facts in report.sentences:
            told = [fact.removeprefix("speed.") for fact in facts if fact.startswith("speed.")]
            paragraph = report.narrative.rfind("\n\n", 0, begun) + 1
            for name in told if len(vehicles) > 1 else ():
                assert any(f"id={name}" in names for at, names in report.notes if paragraph < at < end)
                pronouns += not any(fact.startswith("~named") for fact in facts)
            begun = end
    assert pronouns > 5


@given(seed=seeds, held_out=st.booleans())
def test_until_a_vehicle_is_named_clauses_that_tell_something_of_it_name_it(seed: int, held_out: bool) -> None:
    writer = Writer(Random(seed), sample_crash(Random(seed)), held_out, 1.0)
    assume(writer.crash.actors[0].maneuver not in ("stopped", "parked"))  # these have no speed to tell
    clear = writer._clear(SPEED, 0) + writer._clear(code_clauses.SELF_FRAMES, 0)
    telling = [clause for clause in clear if {"spd", "doing"} & set(slots_of(clause))]
    several = sum(actor.id.startswith("V") for actor in writer.crash.actors) > 1
    assert telling
    assert several == all("{V}" in clause for clause in telling)
    writer.lately.add(0)
    assert writer._clear(SPEED, 0) == list(SPEED.side(held_out))


def test_a_driver_stays_the_same_person() -> None:
    swaps = 0
    for seed in range(50):
        writer = Writer(Random(seed), sample_crash(Random(seed)), False, 1.0)
        ages = {writer._person(0)["age"] for _ in range(10)}
        swaps += len(ages) - 1
    assert swaps < 50


def test_trees_and_parked_cars_are_asked_nothing_and_trees_are_not_coded(monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in ("occupant", "interview", "health"):
        monkeypatch.setitem(GROUPS, kind, group("QQ of {V}"))
    for frames in ("SELF_FRAMES", "OTHER_FRAMES"):
        monkeypatch.setattr(code_clauses, frames, group("QQ of {V}"))
    seen = 0
    for seed in range(400):
        writer = Writer(Random(seed), sample_crash(Random(seed)), False, 3.0)
        for index, actor in enumerate(writer.crash.actors[:2]):
            if actor.id.startswith("V") and actor.maneuver != "parked":
                continue
            seen += 1
            text = " ".join(writer._about(index))
            assert "QQ" not in text
            assert actor.id.startswith("V") or not writer._coded(index)
    assert seen > 30


@pytest.mark.parametrize("clause", ["The driver of {W} said that {he} slept", "The passenger of {V} hurt {his} wrist"])
def test_behind_a_sentence_on_somebody_else_pronouns_mean_nobody(clause: str) -> None:
    writer = Writer(Random(1), sample_crash(Random(1)), False, 1.0)
    writer.lately.add(0)
    text = writer.say(group(f"{clause}<third>"), 0, 1, he="he", his="his")
    notes = writer.finish(text).notes
    assert not any(text[:end].endswith(("he", "his")) for end, _ in notes)
    assert 0 not in writer.lately


def test_a_left_turn_from_the_side_is_coded_into_the_direction_that_it_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(code_clauses.EVENT, "from_side_left", group("QQ into the {onto} direction"))
    only(monkeypatch, lambda crash: crash.config == "left_lateral")
    seen = {"same": 0, "opposite": 0}
    for seed in range(180):
        report = make_report(seed, length=1.0, modes={"text": 1.0})
        for text, _ in sentences(report):
            if "QQ" not in text:
                continue
            crash = report.crash
            (turner,) = (actor for actor in crash.actors if actor.maneuver == "turn_left")
            (other,) = (actor for actor in crash.actors[:2] if actor is not turner)
            way = "same" if turner.out == other.heading else "opposite"
            assert f"{way} direction" in text
            seen[way] += 1
    assert min(seen.values()) > 10


def test_an_encroachment_over_a_line_tells_what_the_other_did(monkeypatch: pytest.MonkeyPatch) -> None:
    for key in ("from_opposite", "from_left_lane", "from_right_lane"):
        monkeypatch.setitem(code_clauses.EVENT, key, group("QQ"))
    only(monkeypatch, lambda crash: crash.config in ("head_on", "lane_change"))
    seen = 0
    for seed in range(300):
        report = make_report(seed, length=1.0, modes={"text": 1.0})
        for text, facts in sentences(report):
            if "QQ" in text:
                seen += 1
                told = [actor for actor in report.crash.actors if f"man.{actor.id}" in facts]
                assert [actor.maneuver.startswith(("crossing", "lane_change")) for actor in told] == [True]
    assert seen > 40


def test_noise_speaks_of_others_and_of_signals_where_there_are_some(monkeypatch: pytest.MonkeyPatch) -> None:
    noise = group("QQ {V}", "OO neither driver was hurt<two>", "LL {he} had a green light<signals>")
    monkeypatch.setitem(GROUPS, "occupant", noise)
    said_of = {"OO": 0, "LL": 0}
    for seed in range(400):
        writer = Writer(Random(seed), sample_crash(Random(seed)), False, 1.0)
        text = " ".join(writer._noise("occupant", 4.0))
        signals = any(leg.control == "signal" for leg in writer.crash.legs)
        assert not ("OO" in text and writer.crash.alone)
        assert not ("LL" in text and not signals)
        said_of = {mark: count + (mark in text) for mark, count in said_of.items()}
    assert min(said_of.values()) > 30


def test_a_cyclist_is_coded_as_no_pedestrian() -> None:
    codes = set[str]()
    for seed in range(3000):
        crash = sample_crash(Random(seed), "pedestrian")
        writer = Writer(Random(seed), crash, False, 1.0)
        code = writer._phrase(code_clauses.EVENT["pedestrian"], *writer.who)
        if any(actor.kind == "bicycle" for actor in crash.actors):
            assert "pedestrian" not in code or "cycl" in code or "nonmotor" in code, code
            codes.add(code)
    assert any(code.startswith("bicyclist") for code in codes)
