"""A reader of numbered reports that learned where the rules err: what it is asked and sees, that it holds no text."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sgcad_core.errors import ConfigError
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.learned_reader import Field, hashed
from sgcad_core.reading.second_reader.learned_reader_features import account_of
from sgcad_core.reading.second_reader.numbered import numbered_reader
from sgcad_core.reading.second_reader.numbered.numbered_answers import same
from sgcad_core.reading.second_reader.numbered.numbered_questions import Question, questions
from sgcad_core.reading.second_reader.numbered.numbered_reader import Kind, Learned, contest
from sgcad_core.records.second_reader import NUMBERED_WEIGHTS

TEXT = (
    "V1 was traveling east on a three lane road. V2 was traveling north and came to a halt beside the fair ground. "
    "The front of V1 struck the left side of V2. V2 came to rest in a field."
)
VALUES = {
    "maneuver": ("backing", "stopped", "straight"), "area": ("back", "front", "left", "right"),
    "lanes": ("both2", "both3", "own2", "own3", "own6"),
}  # fmt: skip


def asked(text: str) -> dict[str, Question]:
    return {one.field: one for one in questions(account_of(text))}


def made(text: str, field: str, answer: str, sure: float = 4.0) -> Learned:
    """Weights that knew just this text and are sure of an answer to one kind of question, from one word."""
    one, values = asked(text)[field], VALUES[kind_of(field)]
    words, readings = hashed(one.words), hashed(one.readings)
    bias = np.array([sure if value == answer else 0.0 for value in values])
    nothing = np.zeros((len(words), len(values))), np.zeros((len(readings), len(values)))
    of = Field(values, *nothing, bias, nothing[0], bias, (0.0, 0.5, 0.5, -0.5, 0.0), (0.0, 0.5, 0.5))
    return {kind_of(field): Kind(words, readings, of)}


def test_every_vehicle_pair_road_and_the_whole_are_asked_for() -> None:
    fields = set(asked(TEXT))
    assert fields == {
        "maneuver.V1", "area.V1", "met.V1", "lanes.V1", "maneuver.V2", "area.V2", "met.V2", "lanes.V2", "junction",
        "turned.V2",
    }  # fmt: skip
    assert questions(account_of("The AV was hit by a truck on a road.")) == ()


def test_the_vehicle_in_question_is_self_and_its_first_way_is_ahead() -> None:
    one, two = asked(TEXT)["maneuver.V1"], asked(TEXT)["maneuver.V2"]
    assert "M:SELF_was_traveling" in one.words & two.words
    assert "M:traveling_D0" in one.words & two.words
    assert "N:traveling_D270" in one.words, "the other one's way, from the first one's"
    assert not any("v1" in word.lower() or "north" in word for word in one.words | two.words)


def test_only_numbers_of_its_own_sentences_may_count_its_lanes() -> None:
    may = asked(TEXT)["lanes.V1"].may
    assert may is not None
    assert {"own3", "both3", "both6"} <= set(may)
    assert not {"own2", "both2"} & set(may)
    assert asked(TEXT)["lanes.V2"].may == ()


def test_the_same_crash_is_seen_alike_in_every_direction() -> None:
    around = TEXT.replace("north", "#").replace("east", "south").replace("#", "east")
    assert asked(TEXT)["maneuver.V2"].words == asked(around)["maneuver.V2"].words


def test_an_answer_that_is_the_rules_own_is_no_other_one() -> None:
    even = np.array([0.25, 0.25, 0.25, 0.25])
    found = contest(("both2", "both4", "own2", "own4"), (even, even), "own2+both4", 1.0)
    assert found is not None
    assert found.other in ("both2", "own4")
    assert found.change[3:] == (1.0, 0.0)
    assert contest(("both2",), (even[:1], even[:1]), "both2", 0.0) is None
    assert contest(("both2", "own4"), (even[:2], even[:2]), "both2", 0.0, may=("both2",)) is None
    assert same("own2", "own2+both4")
    assert not same("own2", None)


def test_a_sure_reader_says_another_answer_with_the_sentence_that_speaks_for_it() -> None:
    learned = made(TEXT, "maneuver.V2", "stopped")
    kind = learned["maneuver"]
    row = int(np.searchsorted(kind.word_hashes, hashed(["M:fair_ground"]))[0])
    kind.field.words[row, VALUES["maneuver"].index("stopped")] = 0.5
    said = numbered_reader.guesses(TEXT, learned)["maneuver.V2"]
    assert said.value == "stopped" or asked(TEXT)["maneuver.V2"].rule == "stopped"
    other = numbered_reader.guesses(TEXT, made(TEXT, "maneuver.V1", "stopped"))["maneuver.V1"]
    assert other.value == "stopped"
    assert other.p > 0.9
    assert sum(other.shares.values()) == pytest.approx(1.0, abs=0.001)
    assert other.sentence is not None


def test_an_unsure_reader_leaves_the_rules_their_answer_and_tells_how_sure_it_is() -> None:
    said = numbered_reader.guesses(TEXT, made(TEXT, "maneuver.V1", "stopped", sure=0.0))["maneuver.V1"]
    assert said.value is None
    assert said.p < 0.6


def test_nothing_is_said_of_a_text_of_another_sort() -> None:
    learned = {name: kind._replace(least_known=0.5) for name, kind in made(TEXT, "maneuver.V1", "stopped").items()}
    assert numbered_reader.guesses(TEXT, learned)
    other = "V1, a sedan whose driver had looked away, went along some lane. Then V2 rammed V1 from behind."
    assert numbered_reader.guesses(other, learned) == {}


def test_what_a_text_tells_needs_a_surer_reader() -> None:
    assert numbered_reader.takes(1.0) > numbered_reader.takes(0.5) == numbered_reader.takes(0.0)


def test_weights_come_back_from_their_file(tmp_path: Path) -> None:
    learned = made(TEXT, "maneuver.V1", "stopped")
    numbered_reader.save(learned, tmp_path / "w.npz")
    again = numbered_reader.guesses(TEXT, numbered_reader.load(tmp_path / "w.npz"))
    before = numbered_reader.guesses(TEXT, learned)
    assert again.keys() == before.keys()
    assert again["maneuver.V1"].value == "stopped"
    assert again["maneuver.V1"].p == pytest.approx(before["maneuver.V1"].p, abs=0.01)


def test_missing_and_broken_weights_are_told_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"its file of weights .* is missing; make it with"):
        numbered_reader.load(tmp_path / "none.npz")
    (tmp_path / "bad.npz").write_bytes(b"PK no archive")
    with pytest.raises(ConfigError, match="is not a file of weights for the numbered reader"):
        numbered_reader.load(tmp_path / "bad.npz")


def test_shipped_weights_are_numbers_and_small() -> None:
    with np.load(NUMBERED_WEIGHTS) as kept:
        arrays = dict(kept)
    assert {a.dtype.kind for a in arrays.values()} <= {"i", "u", "f"}
    about = json.loads(arrays["about"].tobytes())
    assert all(set(one) == {"values", "change", "keep", "least_known"} for one in about.values())
    answers = {value for one in about.values() for value in one["values"]}
    assert max(map(len, answers)) <= len("lane_change_right"), "an answer is a word of ours, no text"
    assert NUMBERED_WEIGHTS.stat().st_size < 5_000_000
