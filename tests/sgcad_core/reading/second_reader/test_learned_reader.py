"""A reader that learned where the rules err: what it sees, whom it lets win, and that its weights hold no text."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.errors import ConfigError
from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader import learned_reader
from sgcad_core.reading.second_reader.fuse_gist import decide, fused_with_gist
from sgcad_core.reading.second_reader.learned_reader import Field, Learned, contest, hashed, known
from sgcad_core.reading.second_reader.learned_reader_features import account_of, readings, runs, words
from sgcad_core.reading.second_reader.seven_question_gist import rule_values, shown_alike
from sgcad_core.records.second_reader import WEIGHTS

TEXT = (
    "The Waymo AV was stopped at a red light on Main Street. An SUV traveling behind it at 12 mph made contact with "
    "the rear bumper of the Waymo AV with its front bumper. Then a van passed."
)
NUMBERED = "V1 was traveling north. V2 was stopped. The front of V1 struck the back of V2."
VALUES = ("backing", "stopped", "straight", "turn_left")


def test_actors_are_three_words_and_numbers_one() -> None:
    seen = words(account_of(TEXT))
    assert {"U:SUBJ_was_stopped", "U:OTH_traveling_behind", "U:at_NUM_mph", "S:was_stopped", "O:traveling"} <= seen
    assert not any("12" in one or "waymo" in one for one in seen)
    assert "Pb:stopped" in seen
    assert "Pc:stopped" not in seen


def test_what_the_rules_say_is_seen_with_how_they_came_by_it() -> None:
    seen = readings(account_of(TEXT))
    assert {"subject=stopped", "subject=stopped&True", "subject_area=back&other_area=front", "near=False"} <= seen
    assert "S.maneuver:deeds.stopped" in seen


def made(text: str, field: str = "subject", to: str = "backing", takes: float = 0.6, sure: float = 3.0) -> Learned:
    """Weights that knew just this text and are sure of a value, however the rules have it."""
    account = account_of(text)
    word_hashes, reading_hashes = hashed(words(account)), hashed(readings(account))
    shape = len(VALUES)
    bias = np.array([sure if value == to else 0.0 for value in VALUES])
    nothing = np.zeros((len(word_hashes), shape)), np.zeros((len(reading_hashes), shape))
    one = Field(VALUES, *nothing, bias, nothing[0], bias, (0.0, 0.5, 0.5, 0.0), (0.0, 0.5, 0.5))
    return Learned(word_hashes, reading_hashes, {field: one}, takes, 0.5)


def test_a_sure_reader_wins_and_an_unsure_one_tells_how_sure_the_rules_are() -> None:
    reading = read(TEXT)
    said = learned_reader.opinion(TEXT, made(TEXT))
    assert said is not None
    assert said.heard["subject"].value == "backing"
    assert fused_with_gist(reading, said).crash.vehicles[0].maneuver == "backing"
    unsure = learned_reader.opinion(TEXT, made(TEXT, takes=0.99))
    assert unsure is not None
    assert unsure.heard["subject"].value == "stopped"
    assert fused_with_gist(reading, unsure) is reading
    decided = decide(unsure, rule_values(reading))["subject"]
    assert (decided.p, decided.changed) == (unsure.heard["subject"].p, False)
    assert decided.p < 0.5


def test_between_one_half_and_its_margin_the_rules_stand() -> None:
    p = learned_reader.opinion(TEXT, made(TEXT, takes=0.0)).heard["subject"].p  # type: ignore[union-attr]
    below = learned_reader.opinion(TEXT, made(TEXT, takes=p + 0.01))
    assert below is not None
    assert below.heard["subject"].value == "stopped"


def test_nothing_is_said_of_numbered_reports_and_of_foreign_texts() -> None:
    assert learned_reader.opinion(NUMBERED, made(NUMBERED)) is None
    assert learned_reader.opinion(TEXT, made(NUMBERED)) is None


@given(st.integers(0, 2**32 - 1), st.sampled_from(VALUES), st.booleans())
def test_no_value_that_may_look_the_same_stands_against_the_rules(seed: int, rule: str, told: bool) -> None:
    both, alone = np.random.default_rng(seed).dirichlet(np.ones(len(VALUES)), 2)
    found = contest(VALUES, both, alone, rule, told)
    assert found is not None
    assert not shown_alike(found.other, rule)
    assert found.change[3] == told
    assert contest(("straight", "slowing"), both[:2], alone[:2], "overtaking", told) is None


def test_features_that_were_not_learned_are_left_out() -> None:
    hashes = hashed(["a", "b"])
    assert len(known(["a", "c", "a"], hashes)) == 1
    assert len(known(["a"], hashed([]))) == 0
    assert runs(["U:a", "U:a_b", "S:a_b"]) == {"U:a_b"}


def test_weights_come_back_from_their_file_in_eight_bits(tmp_path: Path) -> None:
    before = made(TEXT)
    field = before.fields["subject"]
    random = np.random.default_rng(0).normal(size=field.words.shape)
    before = before._replace(fields={"subject": field._replace(words=random)})
    learned_reader.save(before, tmp_path / "w.npz")
    after = learned_reader.load(tmp_path / "w.npz")
    step = np.abs(random).max(0) / 127
    assert (np.abs(after.fields["subject"].words - random) <= step * 0.51).all()
    assert after.fields["subject"].values == VALUES
    assert learned_reader.opinion(TEXT, after) == learned_reader.opinion(TEXT, after._replace(takes=0.6))


def test_missing_and_broken_weights_are_told_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"its file of weights .* is missing; make it with"):
        learned_reader.load(tmp_path / "none.npz")
    (tmp_path / "bad.npz").write_bytes(b"PK no archive")
    with pytest.raises(ConfigError, match="is not a file of weights for the learned reader"):
        learned_reader.load(tmp_path / "bad.npz")


def test_shipped_weights_are_numbers_and_small() -> None:
    with np.load(WEIGHTS) as kept:
        arrays = dict(kept)
    assert {a.dtype.kind for a in arrays.values()} <= {"i", "u", "f"}
    about = json.loads(arrays["about"].tobytes())
    assert set(about) == {"takes", "least_known", "fields"}
    assert all(set(one) == {"values", "change", "keep"} for one in about["fields"].values())
    assert WEIGHTS.stat().st_size < 5_000_000
