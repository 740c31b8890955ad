"""Tests of what ties a narrative's roads to the compass."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator.crash.compass_ties import AXIS, FLOW, FROM_LEFT, ROAD_HINT, STEM, VAGUE, uncertain_facts
from research.generator.crash.crash import sample_crash
from research.generator.crash.world import Actor, Crash, Leg
from research.generator.targets import GUESS, LIKELY, RARE, SURE
from research.rows.evidence_labels import TEXT, stated_tags
from research.training.evaluate import source
from tests.effort import many
from tests.research.reports import text_report

LANES = {"lanes.0", "lanes.2"}
NOWHERE = {"legs", "control"}
"""What is open where nobody could say which legs there are."""


def _crash(layout: str, *legs: tuple[int, int], actors: tuple[Actor, ...] = ()) -> Crash:
    """A crash on legs (bearing, lanes each way), the first of the main road; the others have signs."""
    signs = {True: "none", False: "stop"}
    made = [Leg(bearing, lanes, lanes, control=signs[(bearing - legs[0][0]) % 4 == 0]) for bearing, lanes in legs]
    return Crash("crossing", layout, legs[0][0], made, list(actors), [], "day", "clear", "dry")


def _car(name: str, leg: int, out: int | None) -> Actor:
    return Actor(name, "car", leg, out, "straight")


CROSS = ((0, 2), (2, 1), (4, 2), (6, 1))
TEE = ((0, 2), (4, 2), (6, 1))
SAID = [frozenset({"layout", *LANES, f"{ROAD_HINT}.0", f"{ROAD_HINT}.2"})]


def test_lanes_without_a_direction_belong_to_no_leg() -> None:
    assert uncertain_facts(_crash("four", *CROSS), SAID) == LANES | NOWHERE


def test_a_control_that_all_meet_is_known_wherever_they_come_from() -> None:
    crash = _crash("four", *CROSS)
    for leg in crash.legs:
        leg.control = "signal"
    assert uncertain_facts(crash, SAID) == LANES | {"legs"}


@pytest.mark.parametrize("tie", [{"heading.V1", f"{ROAD_HINT}.0"}, {f"{AXIS}.2"}])
def test_a_direction_beside_a_road_settles_both_roads(tie: set[str]) -> None:
    crash = _crash("four", *CROSS, actors=(_car("V1", 0, 4),))
    assert not uncertain_facts(crash, [*SAID, frozenset(tie)])


def test_a_direction_alone_tells_the_legs_of_a_crossing_but_not_which_road_is_which() -> None:
    crash = _crash("four", *CROSS, actors=(_car("V1", 0, 4),))
    assert uncertain_facts(crash, [*SAID, frozenset({"heading.V1"})]) == LANES


@pytest.mark.parametrize("fact", ["lanes.2", "ways.2"])
def test_a_one_way_road_needs_its_direction(fact: str) -> None:
    main = [Leg(0, 2, 2), Leg(4, 2, 2)]
    crash = Crash(
        "crossing", "four", 0, [*main, Leg(2, 0, 1), Leg(6, 1, 0)], [_car("V1", 0, 4)], [], "day", "clear", "dry"
    )
    said = [frozenset({"layout", "heading.V1", f"{ROAD_HINT}.0"}), frozenset({fact, f"{ROAD_HINT}.2"})]
    assert uncertain_facts(crash, said) == {fact}
    assert not uncertain_facts(crash, [*said, frozenset({f"{FLOW}.2"})])
    crash.actors.append(_car("V2", 6, 2))
    assert not uncertain_facts(crash, [*said, frozenset({"heading.V2"})])


def test_a_one_way_road_without_a_count_of_lanes_tells_the_side_that_has_none() -> None:
    reports = [text_report(seed) for seed in range(400)]
    weights = []
    for report in reports:
        for index, leg in enumerate(report.crash.legs):
            axis = leg.bearing % 4
            if f"ways.{axis}" in report.stated and f"lanes.{axis}" not in report.stated | report.doubtful:
                found = [report.weight(("legs", index, key)) for key in ("lanes_in", "lanes_out")]
                if leg.two_way:
                    assert found == [GUESS, GUESS]
                    assert "the two-way" in report.narrative.lower()
                    continue
                weights.append(found)
                assert "one-way" in report.narrative or "only" in report.narrative.lower()
    assert len(weights) > 10
    assert all(sorted(found) == [LIKELY, SURE] for found in weights)


@pytest.mark.parametrize("turns", [[], ["through", "left"]])
def test_a_lane_named_from_the_left_needs_the_lanes_beside_it(turns: list[str]) -> None:
    crash = _crash("four", *CROSS, actors=(_car("V1", 0, 4),))
    crash.leg(0).turns_in = turns  # type: ignore[union-attr]
    heading, lanes = {"heading.V1", f"{ROAD_HINT}.0"}, frozenset({"layout", "lanes.0", f"{AXIS}.0"})
    named = frozenset({*heading, "lane.V1", f"{FROM_LEFT}.V1"})
    assert "lane.V1" in uncertain_facts(crash, [named])
    assert ("lane.V1" in uncertain_facts(crash, [named, lanes])) == bool(turns)
    assert "lane.V1" not in uncertain_facts(crash, [named, lanes | {"turns.0"}])
    assert "lane.V1" not in uncertain_facts(crash, [named, frozenset({*heading, "lane.V1"})])  # "lane two"


def test_the_left_lane_of_nobody_knows_how_many_is_a_guess() -> None:
    found = 0
    for seed in range(600):
        report = text_report(seed)
        for index, actor in enumerate(report.crash.actors):
            if f"lane.{actor.id}" in report.doubtful:
                found += 1
                assert actor.lane == report.crash.leg(actor.leg).lanes_in or "through" in report.narrative  # type: ignore[union-attr]
                assert report.weight(("actors", index, "lane")) == GUESS
    assert found > 5


def test_roads_alike_need_no_direction_of_their_own() -> None:
    crash = _crash("four", *((bearing, 2) for bearing in (0, 2, 4, 6)), actors=(_car("V1", 0, 4),))
    assert not uncertain_facts(crash, [*SAID, frozenset({"heading.V1", f"{ROAD_HINT}.0"})])


def test_a_tee_needs_somebody_who_uses_its_stem() -> None:
    main, stem = _car("V1", 0, 4), _car("V2", 6, 0)
    crash = _crash("t", *TEE, actors=(main, stem))
    said = [*SAID, frozenset({"heading.V1", "man.V1", f"{ROAD_HINT}.0"})]
    assert uncertain_facts(crash, said) == {"lanes.2"} | NOWHERE
    assert not uncertain_facts(crash, [*said, frozenset({"heading.V2"})])
    assert not uncertain_facts(crash, [*said, frozenset({STEM})])


def test_turn_lanes_show_where_the_stem_lies() -> None:
    crash = _crash("t", *TEE, actors=(_car("V1", 0, 4),))
    crash.legs[1].turns_in = ["through", "left"]  # from the south: left is west
    said = [*SAID, frozenset({"heading.V1", "man.V1", "turns.0", f"{ROAD_HINT}.0", f"{AXIS}.0"})]
    assert not uncertain_facts(crash, said)


def test_a_limit_of_this_road_is_of_no_road() -> None:
    crash = _crash("four", *CROSS, actors=(_car("V1", 0, 4),))
    crash.legs[0].limit = crash.legs[2].limit = 35
    tied = [*SAID, frozenset({"heading.V1", f"{ROAD_HINT}.0"})]
    assert uncertain_facts(crash, [*tied, frozenset({"limit.0"})]) == {"limit.0"}
    assert not uncertain_facts(crash, [*tied, frozenset({"limit.0", f"{AXIS}.0"})])
    assert not uncertain_facts(crash, [*tied, frozenset({"limit.0", f"{ROAD_HINT}.0"})])
    crash.legs[1].limit = crash.legs[3].limit = 35
    assert uncertain_facts(crash, [*tied, frozenset({"limit.0"})]) == {"limit.0"}
    assert not uncertain_facts(crash, [*tied, frozenset({"limit.0", "limit.2"})])


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 2**31))
def test_more_said_never_unsettles(seed: int) -> None:
    rng = Random(seed)
    crash = sample_crash(rng)
    headings = {f"heading.{actor.id}" for actor in crash.actors} | {f"man.{actor.id}" for actor in crash.actors}
    roads = {f"{key}.{leg.bearing % 4}" for key in ("lanes", ROAD_HINT) for leg in crash.legs}
    some = [frozenset(fact for fact in sorted(headings | roads) if rng.random() < 0.4) for _ in range(3)]
    more = [*some, frozenset(fact for fact in sorted(headings) if rng.random() < 0.5)]
    known = {fact for facts in some for fact in facts} | {"legs"}
    assert uncertain_facts(crash, more) & known <= uncertain_facts(crash, some)


def test_what_is_doubtful_counts_nowhere_in_a_text_and_weighs_as_a_guess() -> None:
    found = 0
    for seed in range(400):
        report = text_report(seed)
        for fact in report.doubtful:
            assert source(report, fact) == "none"
        for index, leg in enumerate(report.crash.legs):
            weight, limit = report.weight(("legs", index, "speed_limit_mph")), f"limit.{leg.bearing % 4}"
            if limit in report.doubtful:
                found += 1
                assert report.road["legs"][index]["speed_limit_mph"] == leg.limit
                assert weight == GUESS
            elif limit in report.stated:
                assert weight == (RARE if leg.limit else SURE)
            if "control" in report.doubtful:
                assert report.road["legs"][index]["control"] == leg.control
                assert report.weight(("legs", index, "control")) == GUESS
    assert found > 20


def test_what_every_sentence_tells_in_part_is_doubtful() -> None:
    crash = _crash("four", *CROSS, actors=(_car("V1", 0, 4),))
    plain = [*SAID, frozenset({"heading.V1", f"{ROAD_HINT}.0"})]
    met = frozenset({"control", f"{VAGUE}.control"})
    assert uncertain_facts(crash, [*plain, met]) == {"control"}
    assert not uncertain_facts(crash, [*plain, met, frozenset({"control"})])


@pytest.mark.parametrize("fact", ["control", "median"])
def test_what_is_told_in_part_alone_weighs_as_a_guess_and_tags_nothing(fact: str) -> None:
    seen = 0
    for seed in range(1500):
        report = text_report(seed, length=0.0)
        telling = [facts for _, facts in report.sentences if fact in {told.partition(".")[0] for told in facts}]
        if not telling or not report.behavior:
            continue
        for i, leg in enumerate(report.crash.legs):
            key = fact if fact == "control" else f"{fact}.{leg.bearing % 4}"
            vague = [f"{VAGUE}.{key}" in facts for facts in telling if key in facts]
            if not vague or not all(vague):
                continue
            seen += 1
            assert key in report.doubtful
            assert report.weight(("legs", i, fact)) == GUESS
            assert report.road["legs"][i][fact] == getattr(leg, fact)
            asked = {
                TEXT[f"leg{leg.bearing}.control={leg.control}"],
                TEXT[f"axis{leg.bearing % 4}.median={leg.median}"],
            }
            for facts in telling:
                assert not asked & set(stated_tags(report.crash, frozenset({key, f"{VAGUE}.{key}"}) & facts))
    assert seen > 10


@pytest.mark.parametrize("fact", ["limit.0", "lanes.0", "median.0"])
def test_what_is_told_plainly_stays_so_when_it_is_said_loosely_again(fact: str) -> None:
    crash = _crash("t", *TEE, actors=(_car("V1", 6, 4),))
    plain = [*SAID, frozenset({fact, f"{AXIS}.0"}), frozenset({"heading.V1", f"{ROAD_HINT}.2"})]
    assert fact not in uncertain_facts(crash, plain)
    assert fact not in uncertain_facts(crash, [*plain, frozenset({fact})])


def test_of_whom_no_maneuver_is_told_the_exit_is_a_guess_and_straight_ahead_where_it_drove_on() -> None:
    ahead, gone = 0, 0
    for seed in range(600):
        report = text_report(seed, length=0.0)
        for i, actor in enumerate(report.crash.actors if report.behavior else ()):
            if not actor.vehicle or f"man.{actor.id}" in report.stated or actor.maneuver == "straight":
                continue
            assert report.weight(("actors", i, "exit_road")) == GUESS
            if f"heading.{actor.id}" in report.stated and actor.out == (actor.leg + 4) % 8 and not actor.meant:
                ahead += report.behavior["actors"][i]["exit_road"] is not None
                gone += report.behavior["actors"][i]["exit_road"] is None
    assert ahead > 10
    assert gone <= 0.2 * ahead


def test_the_lane_of_one_parked_or_of_no_known_heading_is_not_taken_from_the_road() -> None:
    seen = 0
    for seed in range(many(1500, 3000)):
        report = text_report(seed, length=0.0)
        for actor, have in zip(report.crash.actors, (report.behavior or {}).get("actors", ()), strict=False):
            told = {f"lane.{actor.id}", f"heading.{actor.id}"} & (report.stated | report.doubtful)
            if f"lane.{actor.id}" not in told and (actor.maneuver == "parked" or not told):
                seen += 1
                assert have["lane"] is None
    assert seen > 50


def test_where_one_that_stands_goes_is_a_guess_until_it_is_told() -> None:
    guesses = told = 0
    for seed in range(many(1500, 2500)):
        report = text_report(seed, length=0.0)
        for index, actor in enumerate(report.crash.actors):
            if not actor.meant or f"man.{actor.id}" not in report.stated:
                continue
            weight = report.weight(("actors", index, "exit_road"))
            if f"exit.{actor.id}" in report.stated:
                told += weight != GUESS
            else:
                guesses += 1
                assert weight == GUESS
    assert guesses > many(10, 20) < told


def test_a_list_of_turn_lanes_weighs_as_a_whole() -> None:
    named = told = 0
    for seed in range(1500):
        report = text_report(seed, length=0.0)
        for index, leg in enumerate(report.crash.legs):
            path = ("legs", index, "turns_in")
            weights = {report.weight((*path, 0)), report.weight((*path, 0, "more")), report.weight(path)}
            assert len(weights) == 1
            turns = f"turns.{leg.bearing % 4}"
            named += weights == {GUESS}
            told += weights == {SURE} and turns in report.stated and bool(leg.turns_in)
            assert turns not in report.doubtful or weights == {GUESS}
    assert named > 20 < told


def test_how_far_a_driveway_lies_no_text_tells() -> None:
    found = 0
    for seed in range(1500):
        report = text_report(seed, length=0.0)
        for index, _ in enumerate(report.road["accesses"] if report.road else ()):
            found += 1
            assert report.weight(("accesses", index, "distance_m")) == GUESS
            assert report.weight(("accesses", index, "side")) == SURE
    assert found > 20
