"""Narratives of writers: whole, turned and renumbered without loss, and rows of them."""

import json
from dataclasses import asdict
from random import Random

import pytest

from research.generator import writer_texts
from research.generator.writer_texts import Written, load, renumbered, report_of, shipped, some_report, turned
from research.model.tokens import Coder, load_tokenizer
from research.rows.report_rows import MAX_TEXT
from research.rows.row_stream import one_row
from sgcad_core.records.specs import BehaviorSpec, RoadLayout
from sgcad_core.settings import ROOT

SOME = Random("written").sample(shipped(), 40)


def of(text: str) -> Written:
    """A shipped crash with another text."""
    one = shipped()[0]
    return Written(one.id, text, one.crash, one.told)


def test_every_narrative_is_its_own_and_tells_a_contact() -> None:
    found = shipped()
    assert len(found) >= 900
    assert len({one.id for one in found}) == len({one.text for one in found}) == len(found)
    assert all({"contact.0", "areas.0"} <= one.told for one in found)


@pytest.mark.parametrize("one", SOME, ids=lambda one: one.id)
def test_four_quarters_are_the_same_world(one: Written) -> None:
    again = one
    for _ in range(4):
        again = turned(again, 1)
    assert again == one
    assert turned(one, 0) is one


@pytest.mark.parametrize("one", SOME, ids=lambda one: one.id)
def test_a_turned_crash_keeps_who_meets_whom_and_moves_every_leg(one: Written) -> None:
    crash = turned(one, 1).crash
    assert crash.contacts == one.crash.contacts
    assert {leg.bearing for leg in crash.legs} == {(leg.bearing + 2) % 8 for leg in one.crash.legs}
    assert [leg.bearing for leg in crash.legs] == sorted(leg.bearing for leg in crash.legs)
    assert [(a.leg - b.leg) % 8 for a, b in zip(crash.actors, one.crash.actors, strict=True)] == [2] * len(crash.actors)
    assert len(turned(one, 1).told) == len(one.told)


@pytest.mark.parametrize(
    ("text", "want"),
    [
        ("V1 was northbound.", "V1 was eastbound."),
        ("the Northeast corner, NE of it", "the Southeast corner, SE of it"),
        ("SB on Weston Street, then W/B", "WB on Weston Street, then N/B"),
        ("the north-south road", "the east-west road"),
        ("EASTBOUND in Westminster", "SOUTHBOUND in Westminster"),
        ("the southwesterly wind, the easternmost lane", "the northwesterly wind, the southernmost lane"),
        ("N. Smith and E. Jones", "N. Smith and E. Jones"),
    ],
)
def test_compass_words_turn_and_names_stay(text: str, want: str) -> None:
    assert turned(of(text), 1).text == want


def test_two_vehicles_take_each_others_numbers_wherever_these_stand() -> None:
    text = "Vehicle 1 (V1) hit Veh. #2; Unit 2 spun. V10 and 1 mile stay."
    one = next(one for one in shipped() if "heading.V1" in one.told and "heading.V2" not in one.told)
    other = renumbered(Written(one.id, text, one.crash, one.told))
    assert other.text == "Vehicle 2 (V2) hit Veh. #1; Unit 1 spun. V10 and 1 mile stay."
    assert "heading.V2" in other.told
    assert "heading.V1" not in other.told
    names = {actor.id: actor for actor in one.crash.actors}
    assert {a.id: a.leg for a in other.crash.actors}["V2"] == names["V1"].leg
    assert renumbered(other).crash == one.crash


@pytest.mark.parametrize("one", SOME, ids=lambda one: one.id)
def test_who_struck_whom_is_the_same_under_other_numbers(one: Written) -> None:
    other = renumbered(one)
    for a, b in zip(one.crash.contacts, other.crash.contacts, strict=True):
        assert one.crash.actors[a.striker].model == other.crash.actors[b.striker].model
        assert (a.striker_area, a.struck_area) == (b.striker_area, b.struck_area)
    assert renumbered(other).crash == one.crash


@pytest.mark.parametrize("word", ["the first vehicle", "Vehicle One", "the insured", "the second car"])
def test_where_words_stand_for_numbers_they_stay(word: str) -> None:
    one = of(f"V1 met V2 near {word}.")
    assert renumbered(one) is one


@pytest.mark.parametrize("one", SOME, ids=lambda one: one.id)
def test_answers_are_specs_and_untold_facts_weigh_as_guesses(one: Written) -> None:
    report = report_of(one, 1)
    layout, behavior = RoadLayout(**report.road), BehaviorSpec(**(report.behavior or {}))
    assert len(layout.legs) == len(one.crash.legs)
    for i, actor in enumerate(behavior.actors):
        if f"heading.{actor.id}" not in one.told and actor.id.startswith("V"):
            assert report.weight(("actors", i, "road")) < 1
    assert behavior.weather is None or "weather" in one.told


def test_rows_of_the_stage_are_the_same_for_a_seed_and_show_writers_and_made_reports() -> None:
    coder = Coder(load_tokenizer(ROOT / "plugins" / "backbone" / "mini" / "weights"))
    rows = [one_row(coder, seed, 0.5, "written") for seed in range(30)]
    again = one_row(coder, 7, 0.5, "written")
    assert again.ids == rows[7].ids
    assert again.picks == rows[7].picks
    assert any(row.text_tags for row in rows)
    assert any(row.ids and not row.text_tags for row in rows)
    assert all(len(row.ids) < MAX_TEXT + 600 for row in rows)


def test_a_report_of_a_writer_sometimes_shows_the_drawing() -> None:
    modes = {some_report(shipped(), seed).mode for seed in range(40)}
    assert modes == {"both", "text"}


def test_a_fault_names_file_and_line(tmp_path) -> None:
    good = json.dumps({"id": "a", "text": "x", "crash": asdict(shipped()[0].crash), "told": []})
    (tmp_path / "some.jsonl").write_text(good + '\n{"id": "b"}\n')
    with pytest.raises(ValueError, match=r"some\.jsonl, line 2: no narrative"):
        load(tmp_path)
    (tmp_path / "some.jsonl").write_text(good + "\n")
    assert load(tmp_path)[0].crash == shipped()[0].crash
    (tmp_path / "some.jsonl").unlink()
    with pytest.raises(ValueError, match="has no written narratives"):
        load(tmp_path)


def test_the_folder_is_beside_the_module() -> None:
    assert writer_texts.FOLDER.is_dir()
