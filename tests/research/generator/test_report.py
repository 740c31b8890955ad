"""The report generator: its specs are valid, its crashes possible, its texts reproducible and split in families."""

import json
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator.crash.roads import beside
from research.generator.report import MODES, make_report
from research.model.answer_grammar import behavior_walk, road_walk, write
from research.rows.report_rows import road_ids
from sgcad_core.records.specs import BehaviorSpec, Refusal, RoadLayout
from sgcad_core.roads.layout import road_spec
from tests.effort import many
from tests.research.reports import sentences, text_report

seeds = st.integers(0, 10**6)


@settings(max_examples=150, deadline=None)
@given(seed=seeds, held_out=st.booleans())
def test_answers_are_specs_in_compact_json(seed: int, held_out: bool) -> None:
    report = make_report(seed, held_out)
    for answer, spec in ((report.road, RoadLayout), (report.behavior, BehaviorSpec)):
        if answer is None:
            continue
        if "refuse" in answer:
            Refusal.model_validate(answer)
            continue
        assert spec.model_validate(answer).model_dump_json() == json.dumps(answer, separators=(",", ":"))


@settings(max_examples=100, deadline=None)
@given(seed=seeds)
def test_walks_write_exactly_the_answer(seed: int) -> None:
    report = make_report(seed)
    pieces = write(road_walk(), report.road)
    assert json.loads("".join(text for text, _ in pieces)) == report.road
    if report.behavior is not None:
        pieces = write(behavior_walk(road_ids(report.road)), report.behavior)
        assert json.loads("".join(text for text, _ in pieces)) == report.behavior


@settings(max_examples=60, deadline=None)
@given(seed=seeds)
def test_layouts_compile_to_the_roads_that_actors_use(seed: int) -> None:
    report = make_report(seed, modes={"both": 1.0})
    roads = {road.id for road in road_spec(RoadLayout.model_validate(report.road)).roads}
    assert report.behavior is not None
    used = {actor[key] for actor in report.behavior["actors"] for key in ("road", "exit_road")} - {None}
    assert used <= roads


@settings(max_examples=100, deadline=None)
@given(seed=seeds, held_out=st.booleans())
def test_a_seed_is_one_report(seed: int, held_out: bool) -> None:
    first, again = make_report(seed, held_out), make_report(seed, held_out)
    assert (first.narrative, first.road, first.behavior, first.mode) == (
        again.narrative,
        again.road,
        again.behavior,
        again.mode,
    )


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_told_numbers_stand_in_the_text(seed: int) -> None:
    report = make_report(seed, modes={"text": 1.0})
    numbers = set(re.findall(r"\d+", report.narrative))
    assert report.behavior is not None
    for leg in report.road["legs"]:
        assert leg["speed_limit_mph"] is None or str(leg["speed_limit_mph"]) in numbers or len(numbers) > 0
    for actor in report.behavior["actors"]:
        speed = actor["speed_mph"]
        assert not speed or str(speed) in numbers or f"{speed - 4}" in numbers


@settings(max_examples=60, deadline=None)
@given(seed=seeds)
def test_untold_values_are_null_and_unweighted(seed: int) -> None:
    report = make_report(seed, modes={"image": 1.0})
    assert report.behavior is not None
    assert report.narrative == ""
    assert [report.behavior[key] for key in ("light", "weather", "surface")] == [None] * 3
    assert all(leg["speed_limit_mph"] is None for leg in report.road["legs"])
    assert all(
        report.weight(("actors", i, "kind")) < 1 for i, a in enumerate(report.crash.actors) if a.kind in ("car", "suv")
    )


@settings(max_examples=60, deadline=None)
@given(seed=seeds)
def test_rows_without_context_weigh_every_value_alike(seed: int) -> None:
    """They teach the distribution of answers, so no value may count more than another."""
    report = make_report(seed, modes={"none": 1.0})
    paths = [(), ("light",), *((f"{kind}s", 0, key) for kind, key in (("leg", "control"), ("actor", "maneuver")))]
    assert len({report.weight(path) for path in paths}) == 1


def test_rows_without_context_know_every_kind_of_answer() -> None:
    """What they hold impossible, contrast would make certain at the faintest trace."""
    reports = [make_report(seed, modes={"none": 1.0}) for seed in range(400)]
    assert {len(report.road["accesses"]) for report in reports} == {0, 1, 2}
    assert any(leg["curve"] != "none" for report in reports for leg in report.road["legs"])
    assert {report.behavior["weather"] for report in reports if report.behavior} >= {None, "clear", "rain"}


def test_every_mode_comes_up() -> None:
    assert {make_report(seed).mode for seed in range(400)} == set(MODES)


@pytest.mark.parametrize("mode", ["thin", "no_crash", "conflict"])
def test_depleted_reports_are_refused(mode: str) -> None:
    for seed in range(40):
        report = make_report(seed, modes={mode: 1.0})
        assert "refuse" in report.road or (report.behavior is not None and "refuse" in report.behavior)


def test_words_are_believed_where_a_drawing_is_careless() -> None:
    careless = [r for r in (make_report(s, length=0.1, modes={"both": 1.0}) for s in range(300)) if r.shown]
    assert 20 < len(careless) < 80
    for report in careless:
        assert report.shown is not None
        assert [leg.bearing for leg in report.shown.legs] == [leg.bearing for leg in report.crash.legs]
        assert not any(fact.startswith(("lanes.", "turns.", "median.")) for fact in report.drawn)
        for leg, drawn, told in zip(report.crash.legs, report.shown.legs, report.road["legs"], strict=True):
            assert bool(leg.lanes_in) == bool(drawn.lanes_in)
            assert bool(leg.lanes_out) == bool(drawn.lanes_out)
            assert (told["lanes_in"], told["lanes_out"]) == (leg.lanes_in, leg.lanes_out)
    assert not any(make_report(s, held_out=True, modes={"both": 1.0}).shown for s in range(100))


def test_a_road_whose_lanes_nobody_tells_is_most_often_a_plain_one() -> None:
    plain = {False: 0, True: 0}
    for report in (text_report(s, length=0.1) for s in range(300)):
        silent = [leg for leg in report.crash.legs if leg.kind == "road"]
        silent = [leg for leg in silent if not {f"lanes.{leg.bearing % 4}"} & (report.stated | report.doubtful)]
        for leg in silent:
            plain[max(leg.lanes_in, leg.lanes_out) == 1] += 1
    assert 0.55 < plain[True] / sum(plain.values()) < 0.9


@pytest.mark.slow
def test_where_one_waits_to_turn_to_is_known_only_from_words_that_say_so() -> None:
    found = {False: 0, True: 0}
    for report in (text_report(s, length=0.1) for s in range(many(1500, 2000))):
        answers = report.behavior["actors"] if report.behavior else ()
        for actor, answer in zip(report.crash.actors, answers, strict=False):
            if actor.meant and f"man.{actor.id}" in report.stated and f"heading.{actor.id}" in report.stated:
                said = f"exit.{actor.id}" in report.stated
                assert (answer["exit_road"] is not None) == said
                found[said] += 1
    assert min(found.values()) > 2


@pytest.mark.slow
def test_a_drawing_may_show_a_junction_that_the_narrative_passes_over(monkeypatch: pytest.MonkeyPatch) -> None:
    def silent() -> int:
        found = 0
        for report in (make_report(s, length=0.1, modes={"both": 1.0}) for s in range(400)):
            plain = beside(report.crash)
            if plain is None:
                continue
            ways = {leg.bearing for leg in plain.legs}
            assert len(ways) == 2
            assert all(way in ways for a in report.crash.actors for way in (a.leg, a.out) if way is not None)
            if not {"layout", "legs"} & report.stated and "intersection" not in report.narrative:
                assert len(report.road["legs"]) > 2
                found += 1
        return found

    some = silent()
    monkeypatch.setattr("research.generator.report.UNMENTIONED", 0.0)
    assert some > silent() + 4


@pytest.mark.slow
def test_drawings_of_junctions_rarely_show_driveways_that_no_text_tells_of() -> None:
    reports = [make_report(s, length=0.1, modes={"image": 1.0}) for s in range(600)]
    near = [bool(r.road["accesses"]) for r in reports if r.crash.layout in ("t", "four")]
    along = [bool(r.road["accesses"]) for r in reports if r.crash.layout in ("plain", "driveway")]
    assert 0 < sum(near) < 0.05 * len(near)
    assert sum(along) > 0.08 * len(along)
    for report in (make_report(s, length=1.0, modes={"both": 1.0}) for s in range(300)):
        if report.crash.layout in ("t", "four") and "access" in report.stated:
            assert report.crash.accesses


@pytest.mark.slow
def test_a_one_way_street_whose_lanes_nobody_counts_mostly_has_one() -> None:
    lanes = []
    for seed in range(many(1500, 4000)):
        report = text_report(seed, length=0.0)
        for leg in report.crash.legs if report.behavior and "refuse" not in report.road else ():
            axis = leg.bearing % 4
            if leg.kind == "road" and f"ways.{axis}" in report.stated and f"lanes.{axis}" not in report.stated:
                lanes += [max(leg.lanes_in, leg.lanes_out)] * (not leg.two_way)
    assert len(lanes) > 40
    assert 0.7 < lanes.count(1) / len(lanes) < 0.97


@pytest.mark.slow
def test_what_no_words_can_tell_is_not_told() -> None:
    """Which way one backs out, and whether one that hit a parked vehicle had kept its lane, where nobody says so."""
    backing, parked = 0, {True: 0, False: 0}
    for seed in range(many(1500, 2500)):
        report = text_report(seed, length=0.0)
        for i, actor in enumerate(report.crash.actors if report.behavior else ()):
            if actor.maneuver == "backing":
                backing += 1
                assert f"exit.{actor.id}" not in report.stated
                assert report.behavior["actors"][i]["exit_road"] is None
            if report.crash.config == "parked" and actor.maneuver == "departing_road_right":
                says = [text for text, facts in sentences(report) if f"man.{actor.id}" in facts]
                kept = "did not|without|keep its lane"
                assert not [text for text in says if re.search(kept, text) and "right" not in text], says
                parked[bool(says)] += 1
    assert backing > 20
    assert min(parked.values()) > 5


@pytest.mark.slow
def test_drawings_train_on_kinds_that_are_seldom_seen() -> None:
    shares = {}
    for mode, held_out in (("image", False), ("text", False), ("image", True)):
        crashes = [make_report(seed, held_out, 0.0, {mode: 1.0}).crash for seed in range(400)]
        rare = ("motorcycle", "bus", "pedestrian", "bicycle")
        shares[mode, held_out] = sum(any(a.kind in rare for a in crash.actors) for crash in crashes) / 400
        for actor in (actor for crash in crashes for actor in crash.actors):
            assert actor.vehicle == (actor.kind not in ("object", "pedestrian", "bicycle"))
    assert shares["image", False] > 0.2 > 0.15 > max(shares["text", False], shares["image", True])
