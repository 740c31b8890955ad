"""The report generator: its specs are valid, its crashes possible, its texts reproducible and split in families."""

import json
import re
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator.clauses import contact as clauses_contact
from research.generator.clauses import motion, noise_clauses, scene_clauses
from research.generator.crash.configurations import opens
from research.generator.crash.crash import sample_crash
from research.generator.crash.roads import beside, one_way
from research.generator.crash.world import COMPASS, TURN_OF, WORDS, Crash
from research.generator.records import Group
from research.generator.report import MODES, make_report
from research.generator.targets import GUESS
from research.generator.writer import Writer
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


@settings(max_examples=300, deadline=None)
@given(seed=seeds)
def test_contacts_fit_the_directions(seed: int) -> None:
    crash = sample_crash(Random(seed))
    contact = crash.contacts[0]
    striker, struck = crash.actors[contact.striker], crash.actors[contact.struck]
    if crash.config == "rear_end":
        assert (striker.leg, contact.striker_area, contact.struck_area) == (struck.leg, "front", "back")
    if crash.config == "crossing":
        from_left = (striker.leg - (struck.heading - 2)) % 8 == 0
        assert contact.struck_area == ("left" if from_left else "right")
    if crash.config == "head_on":
        assert (striker.leg - struck.leg) % 8 == 4


@settings(max_examples=300, deadline=None)
@given(seed=seeds)
def test_everyone_has_a_lane_to_start_on_and_one_to_go_to(seed: int) -> None:
    crash = sample_crash(Random(seed))
    for actor in crash.actors:
        leg = crash.leg(actor.leg)
        assert leg is not None
        if actor.id.startswith("V"):
            assert 1 <= (actor.lane or 0) <= leg.lanes_in
            assert actor.out is None or _opens(crash, actor.out)


def _opens(crash: Crash, bearing: int) -> bool:
    leg = crash.leg(bearing)
    return leg is not None and leg.lanes_out > 0


@settings(max_examples=200, deadline=None)
@given(seed=seeds)
def test_lanes_go_on_through_a_plain_road(seed: int) -> None:
    crash = sample_crash(Random(seed))
    if crash.layout == "plain":
        first, second = crash.legs
        assert (first.lanes_in, first.lanes_out) == (second.lanes_out, second.lanes_in)


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
    "options", [motion.APPROACH, clauses_contact.IMPACT, scene_clauses.CONDITIONS, noise_clauses.INTERVIEW]
)
def test_both_sides_of_the_split_have_clauses(options: Group) -> None:
    train, test = options.side(held_out=False), options.side(held_out=True)
    assert train
    assert test
    assert not set(train) & set(test)


def test_texts_are_thousands_of_forms() -> None:
    shapes = {re.sub(r"\d+|[A-Z][\w-]*", "#", text_report(seed).narrative) for seed in range(1500)}
    assert len(shapes) > 1450


def test_every_mode_comes_up() -> None:
    assert {make_report(seed).mode for seed in range(400)} == set(MODES)


@pytest.mark.parametrize("mode", ["thin", "no_crash", "conflict"])
def test_depleted_reports_are_refused(mode: str) -> None:
    for seed in range(40):
        report = make_report(seed, modes={mode: 1.0})
        assert "refuse" in report.road or (report.behavior is not None and "refuse" in report.behavior)


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


@given(seed=st.integers(0, 100_000))
@settings(max_examples=200, deadline=None)
def test_a_one_way_street_carries_everybody_who_uses_it(seed: int) -> None:
    before = sample_crash(Random(seed))
    crash = one_way(Random(seed), before, 1.0)
    assert [(a.id, a.leg, a.out, a.maneuver) for a in crash.actors] == [
        (a.id, a.leg, a.out, a.maneuver) for a in before.actors
    ]
    assert [leg.bearing for leg in crash.legs] == [leg.bearing for leg in before.legs]
    for actor in crash.actors:
        if actor.kind in ("object", "pedestrian", "bicycle"):
            continue
        leg = crash.leg(actor.leg)
        assert leg is not None
        assert actor.lane is not None
        assert actor.lane <= leg.lanes_in
        alone = sum(other.leg == actor.leg and bool(other.lane) for other in crash.actors) == 1
        if alone and actor.maneuver == "turn_left" and not leg.two_way:
            assert actor.lane == leg.lanes_in
        out = crash.leg(actor.out) if actor.out is not None else None
        assert actor.out is None or (out is not None and out.lanes_out)
    for leg, old in zip(crash.legs, before.legs, strict=True):
        assert leg == old or leg.control == "none" or leg.lanes_in
        assert len(leg.turns_in) in (0, leg.lanes_in)
        for use in leg.turns_in:
            assert all(opens(crash, leg.bearing + TURN_OF[way]) for way in use.split("_"))


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


def test_some_one_way_streets_meet_two_way_ones_and_some_end_at_a_t() -> None:
    changed = [one_way(Random(seed), sample_crash(Random(seed)), 1.0) for seed in range(300)]
    found = [
        (crash.layout, len({leg.two_way for leg in crash.legs if leg.kind == "road"}))
        for crash in changed
        if any(leg.kind == "road" and not leg.two_way for leg in crash.legs)
    ]
    assert {("four", 2), ("t", 2), ("plain", 1), ("driveway", 1)} <= set(found)


def test_one_carriageway_is_drawn_of_some_divided_roads() -> None:
    found = 0
    for seed in range(many(1500, 2500)):
        report = make_report(seed, length=0.1, modes={"both": 1.0})
        if not report.crash.one_way or "divided" not in report.narrative or len(report.road["legs"]) != 2:
            continue
        ways = [(leg["lanes_in"], leg["lanes_out"], leg["median"]) for leg in report.road["legs"]]
        axes = {f"lanes.{leg.bearing % 4}" for leg in report.crash.legs}
        if axes & report.stated:  # a road that was one-way from the first
            continue
        found += 1
        assert sorted(bool(into) for into, _, _ in ways) == [False, True]
        assert all(median == "none" for _, _, median in ways)
        assert axes <= report.drawn
    assert found > 5


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


def test_drawings_show_driveways_that_the_narrative_passes_over() -> None:
    reports = [make_report(s, length=0.1, modes={"both": 1.0}) for s in range(600)]
    several = [r for r in reports if len(r.crash.accesses) > 1]
    assert 10 < len(several) < 100
    for report in several:
        drawn = [(COMPASS[a.leg], a.side, a.kind) for a in report.crash.accesses]
        told = [(a["leg"], a["side"], a["kind"]) for a in report.road["accesses"]]
        assert sorted(told) == sorted(drawn)
        assert len({leg for leg, _, _ in drawn}) == len(drawn)
        assert all(report.weight(("accesses", i, "distance_m")) == GUESS for i in range(len(told)))
    short = [leg.bearing for r in reports for leg in r.crash.legs if leg.mouth is not None]
    assert len(short) > 10
    assert not any(a.leg == leg.bearing and leg.mouth for r in reports for a in r.crash.actors for leg in r.crash.legs)
    for report in (make_report(s, held_out=True, modes={"both": 1.0}) for s in range(200)):
        assert not any(access.mouth for access in report.crash.accesses)


def test_drawings_of_junctions_rarely_show_driveways_that_no_text_tells_of() -> None:
    reports = [make_report(s, length=0.1, modes={"image": 1.0}) for s in range(600)]
    near = [bool(r.road["accesses"]) for r in reports if r.crash.layout in ("t", "four")]
    along = [bool(r.road["accesses"]) for r in reports if r.crash.layout in ("plain", "driveway")]
    assert 0 < sum(near) < 0.05 * len(near)
    assert sum(along) > 0.08 * len(along)
    for report in (make_report(s, length=1.0, modes={"both": 1.0}) for s in range(300)):
        if report.crash.layout in ("t", "four") and "access" in report.stated:
            assert report.crash.accesses


def test_who_turns_has_often_stopped_or_slowed_before() -> None:
    """Of turning vehicles in real narratives two in five had stopped; then it is told that they went."""
    waited = {True: 0, False: 0}
    for seed in range(700):
        rng = Random(seed)
        crash = sample_crash(rng)
        if crash.config not in ("left_opposite", "left_lateral", "right_into"):
            continue
        writer = Writer(rng, crash, False, 0.1)
        writer.write()
        waited[writer.waited] += 1
        turner = crash.actors[writer.who[0]].id
        assert not writer.waited or f"man.{turner}" in writer.stated
    assert 0.4 < waited[True] / sum(waited.values()) < 0.65


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


def test_who_waits_to_turn_right_waits_for_what_comes_from_the_left() -> None:
    seen = 0
    for seed in range(1500):
        crash = sample_crash(Random(seed))
        writer = Writer(Random(seed), crash, False, 1.0)
        for actor in crash.actors:
            if actor.maneuver == "turn_right":
                heads = writer._others(actor, left=False)
                seen += len(heads)
                assert heads in ([], [actor.out % 8])  # the way on which it will drive itself
    assert seen > 50


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


def test_who_goes_on_along_a_bend_negotiates_it() -> None:
    for seed in range(400):
        crash = sample_crash(Random(seed))
        for actor in (actor for actor in crash.actors if actor.vehicle):
            bends = crash.leg(actor.leg).curve != "none"  # type: ignore[union-attr]
            assert not (bends and actor.maneuver == "straight")


def test_impacts_that_name_nobody_tell_no_striker() -> None:
    seen = 0
    for seed in range(many(1500, 2500)):
        for sentence, facts in sentences(text_report(seed, length=0.0)):
            if "contact.0" in facts:
                assert any(fact.startswith("~named") for fact in facts), sentence
            seen += bool(re.match(r"(This led to|This ended in|There was an impact|An impact occurred)", sentence))
    assert seen > 1


def test_drawings_train_on_kinds_that_are_seldom_seen() -> None:
    shares = {}
    for mode, held_out in (("image", False), ("text", False), ("image", True)):
        crashes = [make_report(seed, held_out, 0.0, {mode: 1.0}).crash for seed in range(400)]
        rare = ("motorcycle", "bus", "pedestrian", "bicycle")
        shares[mode, held_out] = sum(any(a.kind in rare for a in crash.actors) for crash in crashes) / 400
        for actor in (actor for crash in crashes for actor in crash.actors):
            assert actor.vehicle == (actor.kind not in ("object", "pedestrian", "bicycle"))
    assert shares["image", False] > 0.2 > 0.15 > max(shares["text", False], shares["image", True])
