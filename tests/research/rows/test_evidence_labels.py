"""Tags: sentences say what they tell, drawings what they show, and neither leaves a trace in the report."""

from bisect import bisect_left
from dataclasses import replace
from random import Random

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.backbone.mini import drawing_view
from research.generator.crash.crash import sample_crash
from research.generator.grammar import HINT, MARK, StatedFacts, unmark
from research.generator.report import make_report
from research.generator.targets import THIRD_LEG
from research.model.batch import Pass, Taggers
from research.model.model import Forward
from research.model.tokens import Coder, train_tokenizer
from research.rows import evidence_labels
from research.rows.collate import collate
from research.rows.report_rows import tag_picture, training_row
from research.rows.row_stream import labeled
from tests.research.reports import text_report

seeds = st.integers(0, 10**6)
NAMES = {index: name for name, index in evidence_labels.TEXT.items()}
SHOWN = {index: name for name, index in evidence_labels.PICTURE.items()}


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(train_tokenizer(text_report(seed).narrative for seed in range(200)))


@settings(max_examples=150, deadline=None)
@given(seed=seeds, held_out=st.booleans())
def test_no_mark_is_left_and_every_sentence_ends_in_the_text(seed: int, held_out: bool) -> None:
    report = make_report(seed, held_out)
    assert not any("\ue000" <= letter <= "\uf8ff" or letter >= "\U000f0000" for letter in report.narrative)
    ends = [end for end, _ in report.sentences]
    assert ends == sorted(ends)
    assert all(0 < end <= len(report.narrative) for end in ends)
    assert all(report.narrative[end - 1] in ".!?" for end in ends)


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_what_a_report_tells_is_what_its_sentences_tell(seed: int) -> None:
    report = make_report(seed, modes={"text": 1.0})
    facts = {fact for _, some in report.sentences for fact in some if not fact.startswith(HINT)}
    assert (report.stated | report.doubtful) - {"legs"} == facts
    assert not report.stated & report.doubtful
    said = {NAMES[i] for _, facts in report.sentences for i in evidence_labels.stated_tags(report.crash, facts)}
    for actor in report.crash.actors:
        if f"heading.{actor.id}" in report.stated and actor.id in evidence_labels.IDS:
            assert f"{actor.id}.heading={actor.heading}" in said
    if "areas.0" in report.stated:
        assert f"contact0.struck_area={report.crash.contacts[0].struck_area}" in said
    for key in {"light", "weather", "surface"} & report.stated:
        assert f"{key}={getattr(report.crash, key)}" in said


def test_told_hands_out_repeated_facts_too() -> None:
    told = StatedFacts()
    told |= {"light"}
    assert told.take() == {"light"}
    told.add("light")
    told |= {"curve"}
    assert told.take() == {"light", "curve"}
    assert told == {"light", "curve"}
    assert not told.take()


def test_marks_are_taken_out_with_their_places() -> None:
    assert unmark(f"One.{chr(MARK)} Two.{chr(MARK + 7)}") == ("One. Two.", [(4, 0), (9, 7)], [])


@pytest.mark.parametrize("seed", range(0, 60, 6))
def test_the_tagged_token_ends_the_sentence(coder: Coder, seed: int) -> None:
    report = text_report(seed)
    row = training_row(coder, report, None)
    assert len(row.text_tags) == len(report.sentences)
    for (at, _), (end, _) in zip(row.text_tags, report.sentences, strict=True):
        assert coder.raw.decode(row.ids[: at + 1]).rstrip() == report.narrative[:end] or (
            coder.raw.decode(row.ids[: at + 1]).startswith(report.narrative[:end])
        )


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_every_leg_and_vehicle_in_view_is_tagged(seed: int) -> None:
    report = make_report(seed, modes={"image": 1.0})
    image, shapes = labeled(report)
    assert image is not None
    row = training_row(_any_coder(), report, image, shapes)
    assert row.picture_tags is not None
    assert row.picture_tags.shape == (row.grid[0] * row.grid[1] // 4, len(evidence_labels.PICTURE))
    fit, found = drawing_view.fit(image), {SHOWN[i] for i in np.flatnonzero(row.picture_tags.any(axis=0))}
    for shape in shapes:
        middle = fit(shape.corners.mean(axis=0)[None])[0]
        inside = (middle > 0).all() and (middle < np.array(fit.grid[::-1]) * drawing_view.PATCH).all()
        if inside and shape.least < 0.1:
            assert {SHOWN[i] for i in shape.tags} <= found


def _any_coder(made: list[Coder] = []) -> Coder:  # noqa: B006 - remembered on purpose
    if not made:
        made.append(Coder(train_tokenizer(text_report(seed).narrative for seed in range(50))))
    return made[0]


def test_a_shape_is_tagged_where_it_lies(coder: Coder) -> None:
    report = make_report(900001, modes={"image": 1.0})
    image, shapes = labeled(report)
    assert image is not None
    row = training_row(coder, report, image, shapes)
    vehicle = next(s for s in shapes if any(SHOWN[i].startswith("id=") for i in s.tags))
    fit = drawing_view.fit(image)
    x, y = fit(vehicle.corners.mean(axis=0)[None])[0] // (2 * drawing_view.PATCH)
    tag_picture(row, image, [vehicle])
    assert row.picture_tags is not None
    shown = row.picture_tags.reshape(fit.grid[0] // 2, fit.grid[1] // 2, -1)[int(y), int(x)]
    assert set(np.flatnonzero(shown)) == set(vehicle.tags)


def test_heads_learn_what_states_tell() -> None:
    torch.manual_seed(0)
    heads = Taggers(16, 5, 4, 7)
    states, told = torch.randn(40, 16), torch.zeros(40, 5)
    told[:, 1] = (states[:, 0] > 0).float()
    before = float(heads.sentences(states, told).detach())
    step = torch.optim.Adam(heads.parameters(), lr=0.05)
    for _ in range(60):
        step.zero_grad()
        heads.sentences(states, told).backward()
        step.step()
    assert float(heads.sentences(states, told).detach()) < 0.5 * before
    assert float(heads.sentences(states[:0], told[:0]).detach()) == 0
    assert float(heads.drawings(states[:0], torch.zeros(0, 7)).detach()) == 0


def test_a_batch_carries_the_tags_of_its_rows(coder: Coder) -> None:
    reports = [make_report(seed, length=0.2, modes={mode: 1.0}) for seed, mode in enumerate(("text", "both", "image"))]
    rows = [training_row(coder, r, *labeled(r)) for r in reports]
    batch = collate(rows, coder)
    assert len(batch.ends) == len(batch.sentence_tags) == sum(len(r.sentences) for r in reports)
    assert len(batch.drawn) == len(batch.patch_index)
    at = [i * batch.ids.shape[1] + place for i, row in enumerate(rows) for place, _ in row.text_tags]
    assert batch.ends.tolist() == at


@settings(max_examples=60, deadline=None)
@given(seed=seeds)
def test_pointers_lead_to_what_tells_the_value(seed: int) -> None:
    report = make_report(seed, length=0.1, modes={"both": 1.0})
    row = training_row(_any_coder(), report, *labeled(report))
    places = {at for at, _ in row.pointers}
    assert places <= {at for at, weight in row.picks if weight >= 1}
    ends = [at for at, _ in row.text_tags]
    phrases = {at: ends[bisect_left(ends, at)] for at, _ in row.notes}
    shown = range(row.image_start, row.image_start + len(row.picture_tags if row.picture_tags is not None else ()))
    for at, sources in row.pointers:
        told = set(sources) - {at for at in sources if phrases.get(at) in sources}  # but for phrases of told sentences
        assert all(source in ends for source in told) or all(source in shown for source in told)
        assert all(source < at for source in sources)


def test_one_way_without_a_count_tells_the_direction_that_nobody_drives(coder: Coder) -> None:
    found = 0
    for seed in range(500):
        report = text_report(seed)
        bare = [leg for leg in report.crash.legs if not leg.two_way and f"ways.{leg.bearing % 4}" in report.stated]
        bare = [leg for leg in bare if f"lanes.{leg.bearing % 4}" not in report.stated | report.doubtful]
        said = {NAMES[i] for _, facts in report.sentences for i in evidence_labels.stated_tags(report.crash, facts)}
        if bare:
            mute = [(end, {fact for fact in facts if not fact.startswith("ways")}) for end, facts in report.sentences]
            without = replace(report, sentences=mute)
            pointers = [len(training_row(coder, some, None).pointers) for some in (report, without)]
            assert pointers[0] > pointers[1]
        for leg in bare:
            side, other = ("in", "out") if not leg.lanes_in else ("out", "in")
            assert f"leg{leg.bearing}.{side}=0" in said
            assert not any(name.startswith(f"leg{leg.bearing}.{other}=") for name in said)
            found += 1
    assert found > 10


def test_places_of_three_legs_are_read_where_the_third_is_used(coder: Coder) -> None:
    found = 0
    for seed in range(300):
        report = text_report(seed)
        legs = report.crash.legs
        if report.crash.layout not in ("driveway", "t") or "legs" not in report.stated:
            continue
        stem = next(leg.bearing for leg in legs if not report.crash.is_main(leg.bearing))
        row = training_row(coder, report, None)
        ends = [at for at, said in row.text_tags if evidence_labels.TEXT[f"leg={stem}"] in said]
        used = {actor.leg for actor in report.crash.actors} | {actor.out for actor in report.crash.actors}
        assert ends or stem not in used
        assert not ends or sum(sources == ends for _, sources in row.pointers) >= len(legs)
        assert {report.weight(("legs", i, "bearing")) for i in range(len(legs))} == {THIRD_LEG}
        found += bool(ends)
    assert found > 20


def test_a_turn_leads_to_a_leg_once_the_heading_is_known() -> None:
    crash = next(c for c in (sample_crash(Random(s)) for s in range(99)) if c.config == "left_lateral")
    mover = next(actor for actor in crash.actors if actor.maneuver == "turn_left")
    turn, heading = {f"man.{mover.id}"}, {f"heading.{mover.id}"}
    legs = {evidence_labels.TEXT[f"leg={mover.leg}"], evidence_labels.TEXT[f"leg={mover.out}"]}
    assert legs.isdisjoint(evidence_labels.stated_tags(crash, turn))
    assert legs <= set(evidence_labels.stated_tags(crash, turn, heading)) & set(
        evidence_labels.stated_tags(crash, heading, turn)
    )


def test_every_fact_of_an_answer_has_a_name() -> None:
    report = make_report(7, length=0.0, modes={"both": 1.0})
    crash = report.crash
    bearing = crash.legs[0].bearing
    assert evidence_labels.fact_of(("legs", 0, "lanes_in"), crash) == (f"lanes.{bearing % 4}", f"leg={bearing}")
    assert evidence_labels.fact_of(("legs", 0, 0), crash)[0] == f"turns.{bearing % 4}"
    assert evidence_labels.fact_of(("actors", 0, "maneuver"), crash) == (
        f"man.{crash.actors[0].id}",
        f"id={crash.actors[0].id}",
    )
    assert evidence_labels.fact_of(("contacts", 0, "struck_area"), crash) == ("areas.0", "struck")
    assert evidence_labels.fact_of(("legs", 0, "bearing"), crash)[0] == "legs"
    assert evidence_labels.fact_of(("light",), crash) == ("light", "")
    assert evidence_labels.fact_of(("refuse",), crash) == ("", "")


def test_attention_on_the_right_place_costs_nothing(coder: Coder) -> None:
    report = text_report(3, length=0.0)
    batch = collate([training_row(coder, report, None)], coder)
    places, length = len(batch.pointing), batch.ids.shape[1]
    assert places
    queries, keys = torch.zeros(1, 2, length, 4), torch.zeros(1, length, 4)
    way = Pass(*[torch.zeros(0)] * 4, queries, keys)
    even = Forward._pointers(batch, way)
    reach = batch.pointing.float() + 1
    assert float(even) == pytest.approx(float((reach.log() - batch.sources.sum(1).float().log()).mean()), rel=1e-4)
    keys[0, batch.sources.any(dim=0)] = 9.0
    queries[:] = 9.0
    assert float(Forward._pointers(batch, way)) < float(even)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_vehicles_that_share_a_token_are_told_apart_by_name(seed: int) -> None:
    crash = make_report(seed, modes={"image": 1.0}).crash
    names = {index: name for name, index in evidence_labels.PICTURE.items()}
    contact = crash.contacts[0]
    shown = set()
    for index in (contact.striker, contact.struck):
        actor = crash.actors[index]
        found = {
            names[i] for i in evidence_labels.drawn_actor(crash, actor, "contact", actor.heading, {f"man.{actor.id}"})
        }
        own = {name for name in found if name.startswith(f"{actor.id}.")}
        role = "striker" if index == contact.striker else "struck"
        assert f"{actor.id}.area={getattr(contact, role + '_area')}" in own
        assert f"{actor.id}.{role}" in own
        assert own == {f"{actor.id}.{name}" for name in found if f"{actor.id}.{name}" in evidence_labels.PICTURE}
        shown |= own
    assert sum(".area=" in name for name in shown) == 2


def test_the_side_that_hit_a_pedestrian_is_asked_where_it_is_named(coder: Coder) -> None:
    seen = 0
    for seed in range(1500):
        report = text_report(seed, length=0.0)
        if "side.0" not in report.stated or report.behavior is None:
            continue
        seen += 1
        contact, row = report.crash.contacts[0], training_row(coder, report, None)
        said = {tag for _, some in row.text_tags for tag in some}
        assert evidence_labels.TEXT[f"contact0.striker_area={contact.striker_area}"] in said
        assert not [
            area for area in evidence_labels.AREAS if evidence_labels.TEXT[f"contact0.struck_area={area}"] in said
        ]
        assert report.weight(("contacts", 0, "striker_area")) > report.weight(("contacts", 0, "struck_area"))
    assert seen > 10
