"""Names of roads, lanes, junctions and limits: what they count is what there is."""

from __future__ import annotations

import re
from collections.abc import Iterator
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator import words, writer
from research.generator.clauses import lane_lists, road_clauses, scene_clauses
from research.generator.crash.compass_ties import AXIS, ROAD_HINT
from research.generator.crash.world import WORDS, Crash, Leg
from research.generator.grammar import unmark
from research.generator.records import group
from research.generator.report import make_report
from tests.research.reports import only, sentences, text_report

COUNTS = {word: n for n, word in enumerate(words.NUMBERS)} | {str(n): n for n in range(13)} | {"a": 1}
seeds = st.integers(0, 2**31)


def _leg(rng: Random) -> Leg:
    plain = rng.randint(1, 4)
    turns = rng.choice(([], [], ["left"], ["right"], ["left", "right"]))
    uses = [*(["right"] if "right" in turns else []), *["through"] * plain, *(["left"] if "left" in turns else [])]
    return Leg(rng.choice((0, 2, 4, 6)), plain + len(turns), rng.randint(1, 4), uses if turns else [])


@settings(max_examples=300, deadline=None)
@given(seed=seeds)
def test_lanes_told_one_way_add_up(seed: int) -> None:
    rng = Random(seed)
    leg = _leg(rng)
    text = unmark(lane_lists._further_lanes(rng, leg, "northbound"))[0]
    parts = text.replace("a single", "one").split(", ")
    assert sum(COUNTS[part.split()[0]] for part in parts) == leg.lanes_in
    for use in ("left", "right"):
        assert text.count(use) == leg.turns_in.count(use)
    assert all("northbound" in part for part in parts)


@settings(max_examples=200, deadline=None)
@given(seed=seeds)
def test_a_bracket_tells_both_ways_and_what_lies_between(seed: int) -> None:
    rng = Random(seed)
    leg, back = _leg(rng), _leg(rng)
    leg.median = back.median = rng.choice(("none", "painted", "grass", "raised", "barrier"))
    text = unmark(lane_lists.split(rng, leg, back, "northbound", "southbound", rng.random() < 0.5))[0]
    assert text.count("northbound") >= 1 <= text.count("southbound")
    named = leg.median in lane_lists.IN_BRACKETS
    assert any(word in text for word in ("median", "barrier", "divider", "wall")) == named
    assert text[0] + text[-1] == "()" or "(" not in text


@pytest.mark.parametrize("held_out", [False, True])
@pytest.mark.parametrize("turns", [[], ["through_right", "through", "left"], ["right", "through", "left"]])
def test_a_lane_is_named_for_where_it_lies(held_out: bool, turns: list[str]) -> None:
    leg = Leg(0, 3, 1, turns)
    for number in (1, 2, 3):
        told = [words.lane(Random(i), leg, number, "northbound", held_out) for i in range(400)]
        for name, from_left in ((lane.text, lane.from_left) for lane in told):
            assert not re.match(r"(middle|center)\b", name) or number == 2, name
            assert not re.search(r"^(left|passing|inside|dedicated left)\b", name) or (number == 3 and from_left), name
            assert not re.search(r"^(right|curb)\b", name) or (number == 1 and not from_left), name
            numbered = re.fullmatch(r"lane (\w+)|(first|second|third|1st|2nd|3rd) (travel )?lane", name)
            assert not numbered or not from_left, name


def test_the_held_out_side_tells_lanes_as_it_always_did() -> None:
    leg, back = Leg(0, 3, 2, ["right", "through", "left"]), Leg(4, 2, 2)
    told = {unmark(lane_lists.split(Random(i), leg, back, "southbound", "northbound", True))[0] for i in range(60)}
    assert all(text.startswith("(one southbound left-turn lane, one ") for text in told)


@pytest.mark.parametrize(
    ("lanes", "number", "turns", "kind"),
    [
        (1, 1, [], "only"),
        (2, 1, [], "right"),
        (3, 3, [], "left"),
        (3, 2, [], "middle"),
        (4, 2, [], "numbered"),
        (2, 2, ["through", "left"], "turn_left"),
        (2, 1, ["right", "through"], "turn_right"),
    ],
)
def test_a_lane_is_named_for_its_place_or_its_number(lanes: int, number: int, turns: list[str], kind: str) -> None:
    leg = Leg(0, lanes, 1, turns)
    assert {words._kind_of_lane(Random(i), leg, number) for i in range(40)} - {"numbered"} <= {kind}


@settings(max_examples=150, deadline=None)
@given(seed=seeds, held_out=st.booleans())
def test_articles_fit_and_no_slot_or_mark_is_left(seed: int, held_out: bool) -> None:
    text = make_report(seed, held_out, 0.3, {"text": 1.0}).narrative
    assert not re.search(r"[{}\[\]|\uf8ff]", text)
    assert not re.search(r"\ba (?:eight|undivided|intersection|ordinary|urban|asphalt|eleven)\b", text, re.IGNORECASE)
    assert not re.search(r"\ban (?:one|two|four|divided|road|northbound)\b", text, re.IGNORECASE)


def test_roads_that_are_told_are_noted_and_axes_where_a_direction_stands() -> None:
    seen = 0
    for text, facts, _ in _sentences(range(400)):
        lanes = {fact.partition(".")[2] for fact in facts if fact.startswith("lanes.")}
        roads = {fact.partition(".")[2] for fact in facts if fact.startswith((ROAD_HINT, AXIS))}
        seen += any(fact.startswith(ROAD_HINT) for fact in facts)
        assert lanes <= roads or "section" in text or "layout" in facts, (
            text
        )  # "a five-lane intersection" names no road
    assert seen > 200


@pytest.mark.parametrize("layout", ["four", "t"])
def test_names_of_junctions_tell_how_many_legs(layout: str) -> None:
    words_of = {"t": r"\bthree|\b3|\btee\b|\bT\b|no fourth", "four": r"\bfour\b|\b4|cross"}
    other = words_of["four" if layout == "t" else "t"]
    names = [name for name in road_clauses.JUNCTION[layout].side(False) if not re.search(words_of[layout], name)]
    assert not [name for name in names if re.search(other, name)]


def _sentences(seeds: range) -> Iterator[tuple[str, frozenset[str], Crash]]:
    for seed in seeds:
        report = make_report(seed, False, 0.2, {"text": 1.0})
        yield from ((text, facts, report.crash) for text, facts in sentences(report))


def _junction(crash: Crash) -> bool:
    """Two roads meet."""
    return crash.layout in ("four", "t")


@pytest.mark.slow
def test_one_limit_is_told_of_both_roads_only_where_it_holds_on_both(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(road_clauses, "LIMITS", group("Everywhere {lim}"))
    found = 0
    only(monkeypatch, _junction)
    for text, facts, crash in _sentences(range(600)):
        if "Everywhere" in text:
            found += 1
            assert facts == {f"limit.{leg.bearing % 4}" for leg in crash.legs}
            assert len({leg.limit for leg in crash.legs}) == 1, text
    assert found >= 5


@pytest.mark.slow
def test_lanes_of_both_roads_are_told_at_once_only_where_they_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(road_clauses, "ALIKE", {"two_way": group("Twice {each}"), "one_way": group("Once {each}")})
    monkeypatch.setattr(writer, "slips", lambda rng, text, rate: text)
    only(monkeypatch, lambda crash: _junction(crash) and len({leg.two_way for leg in crash.legs}) == 1)
    found = set()
    for text, facts, crash in _sentences(range(600)):
        said = re.fullmatch(r"(Twice|Once) (\w+) lanes?\.", text)
        if said is None:
            continue
        found.add(said[1])
        one_way, lanes = said[1] == "Once", words.NUMBERS.index(said[2])
        ways = {frozenset((leg.lanes_in, leg.lanes_out)) for leg in crash.legs}
        assert ways == {frozenset((0, lanes)) if one_way else frozenset((lanes,))}
        axes = {leg.bearing % 4 for leg in crash.legs}
        assert facts == {f"{key}.{axis}" for key in ("lanes", ROAD_HINT) for axis in axes}
    assert found == {"Twice", "Once"}


@pytest.mark.slow
def test_both_roads_of_a_junction_in_one_sentence_keep_their_axes_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(road_clauses, "PAIR", group("QQ {a1}={one}; RR {a2}={other}"))
    monkeypatch.setattr(
        road_clauses, "ONE_WAY", group("a one-way {xb} {noun} with {lanes}")
    )  # else in words without "way"
    monkeypatch.setattr(road_clauses, "UNCOUNTED", group("a one-way {noun}"))
    monkeypatch.setattr(writer, "slips", lambda rng, text, rate: text)
    found = 0
    for text, _, crash in _sentences(range(1500)):
        parts = re.findall(r"(?:QQ|RR) ([a-z/ -]+)=(.*?)(?:;|\.$)", text)
        for axis, road in parts:
            way = next(leg for leg in crash.legs if _lies(leg.bearing, axis))
            one_way = not way.two_way
            found += one_way
            told = "one-way" in road or "one way" in road
            assert told >= (one_way and way.kind == "road" and "same" not in road)
    assert found >= 2


def _lies(bearing: int, axis: str) -> bool:
    return set(re.findall(r"(?:north|south)?(?:east|west)?", axis)) - {""} == {
        WORDS[bearing % 4],
        WORDS[bearing % 4 + 4],
    }


@pytest.mark.slow
def test_a_limit_told_beside_a_heading_is_that_of_the_road_in_that_direction() -> None:
    crossing = 0
    for seed in range(1500):
        report = text_report(seed)
        crash = report.crash
        crossing += crash.layout == "four" and not any(crash.is_main(actor.leg) for actor in crash.actors)
        for _, facts in report.sentences:
            limits = {int(fact.partition(".")[2]) for fact in facts if fact.startswith("limit.")}
            axes = {actor.leg % 4 for actor in crash.actors if f"heading.{actor.id}" in facts}
            assert not (limits and axes) or axes <= limits
    assert crossing > 20


@pytest.mark.slow
def test_the_limit_of_the_other_road_is_laid_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene_clauses, "ROAD2", group("QQ the side street has {lim2}"))
    told = 0
    for seed in range(900):
        for text, facts in sentences(make_report(seed, length=0.0, modes={"text": 1.0})):
            if text.startswith("QQ"):
                told += 1
                (axis,) = {fact.partition(".")[2] for fact in facts if fact.startswith("limit.")}
                assert f"{ROAD_HINT}.{axis}" in facts
    assert told > 30
