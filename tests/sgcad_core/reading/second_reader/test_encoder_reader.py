"""The encoder of numbered reports in numpy: marks, answers, its file; what it holds."""

from __future__ import annotations

import json
import zlib
from pathlib import Path

import numpy as np
import pytest

from sgcad_core.errors import ConfigError
from sgcad_core.reading.second_reader import encoder_reader
from sgcad_core.reading.second_reader.encoder_reader import WHOLE_MARK, Encoder, Judge, answers, marks
from sgcad_core.reading.second_reader.encoder_tokens import (
    FIRST_VEHICLE,
    FIRST_WORD,
    LONGEST,
    SENTENCES,
    Narrative,
    coded,
    narrative_of,
)
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.learned_reader_features import account_of
from sgcad_core.reading.second_reader.numbered import numbered_reader
from sgcad_core.records.second_reader import ENCODER_WEIGHTS

TEXT = "V1 was traveling east on a four lane road. V2 was stopped. The front of V1 struck the back of V2."
WIDE = 8


def told() -> Narrative:
    return narrative_of(account_of(TEXT))


def made(seed: int = 0) -> Encoder:
    """Weights at random of an encoder that knows the words of the text."""
    draw = np.random.default_rng(seed)
    words = np.unique(told().codes[told().codes >= FIRST_WORD])
    sizes = {
        "emb": (FIRST_WORD + len(words), WIDE), "pos": (LONGEST, WIDE), "sent": (SENTENCES, WIDE), "subj": (WIDE, WIDE),
        "query_veh": (WIDE, WIDE), "conv": (WIDE, WIDE, 3), "k": (WIDE, WIDE), "v": (WIDE, WIDE),
        "mark_k": (WHOLE_MARK + 1, WIDE), "mark_v": (WHOLE_MARK + 1, WIDE), "query": (2, WIDE), "norm": (WIDE,),
        "layers.0.n1": (WIDE,), "layers.0.n2": (WIDE,), "layers.0.qkv": (3 * WIDE, WIDE), "layers.0.out": (WIDE, WIDE),
        "layers.0.up": (2 * WIDE, WIDE), "layers.0.down": (WIDE, 2 * WIDE), "up.maneuver": (WIDE, WIDE),
        "down.maneuver": (2, WIDE), "up.turned": (WIDE, 2 * WIDE), "down.turned": (4, WIDE),
    }  # fmt: skip
    arrays = {f"{name}.weight": draw.normal(size=size).astype(np.float32) for name, size in sizes.items()}
    biased = ("conv", "k", "v", "norm", "layers.0.", "up.", "down.")
    arrays |= {f"{n}.bias": np.zeros(size[0], np.float32) for n, size in sizes.items() if n.startswith(biased)}
    values = {"maneuver": ("stopped", "straight"), "turned": ("0", "180", "270", "90")}
    return Encoder(arrays, words, values, {"maneuver": Judge((0.0,) * 6, (0.0,) * 4)}, 2)


def test_a_token_is_marked_by_who_it_names_and_whom_its_sentence_is_about() -> None:
    ids = np.array([FIRST_VEHICLE, FIRST_VEHICLE + 1, FIRST_WORD, FIRST_WORD])
    subjects = np.array([1, 1, 2, 0])
    assert marks(ids, subjects, 1).tolist() == [4, 7, 2, 0]
    assert marks(ids, subjects, 2).tolist() == [8, 5, 1, 0]
    assert marks(ids, subjects, 0).tolist() == [WHOLE_MARK] * 4


def test_every_question_of_a_known_kind_gets_shares_of_its_answers() -> None:
    found = answers(made(), told(), ("maneuver.V1", "maneuver.V2", "turned.V2", "lanes.V1"))
    assert set(found) == {"maneuver.V1", "maneuver.V2", "turned.V2"}
    assert [len(shares) for shares in found.values()] == [2, 2, 4]
    assert all(shares.sum() == pytest.approx(1.0, abs=1e-5) for shares in found.values())
    assert not np.allclose(found["maneuver.V1"], found["maneuver.V2"])


def test_an_empty_report_has_no_answers() -> None:
    assert answers(made(), coded([]), ("maneuver.V1",)) == {}


def test_weights_come_back_from_their_file(tmp_path: Path) -> None:
    encoder = made()
    encoder_reader.save(encoder, tmp_path / "w.npz")
    again = encoder_reader.load(tmp_path / "w.npz")
    assert (again.values, again.judges, again.heads) == (encoder.values, encoder.judges, encoder.heads)
    before, after = (answers(one, told(), ("maneuver.V1",))["maneuver.V1"] for one in (encoder, again))
    assert np.allclose(before, after, atol=0.02)


def test_shipped_weights_are_numbers_and_know_answers_of_ours_alone() -> None:
    with np.load(ENCODER_WEIGHTS) as kept:
        arrays = dict(kept)
    about = json.loads(arrays.pop("about").tobytes())
    assert set(about) == {"values", "judges", "heads"}
    assert max(len(value) for some in about["values"].values() for value in some) <= len("lane_change_right")
    assert {name: array.dtype.kind for name, array in arrays.items() if array.dtype.kind != "f"} == {"words": "u"}
    assert ENCODER_WEIGHTS.stat().st_size < 8_000_000


def test_shipped_weights_hold_common_words_alone_and_none_of_a_name_or_a_plate() -> None:
    words = encoder_reader.load().words.tolist()
    common, rare = (
        ("was", "the", "traveling", "struck", "lane", "turning"),
        ("smith", "maria", "jose", "elm", "7abc123"),
    )
    assert all(zlib.crc32(word.encode()) in words for word in common)
    assert not [word for word in rare if zlib.crc32(word.encode()) in words]
    assert not [name for name in encoder_reader.load().arrays if name.startswith("mlm")], "it can tell no hidden word"


def test_the_shipped_encoder_is_heard_beside_the_linear_readers() -> None:
    encoder = encoder_reader.load()
    assert set(encoder.judges) <= set(numbered_reader.load())
    assert all((len(judge.change), len(judge.keep)) == (6, 4) for judge in encoder.judges.values())
    plain = numbered_reader.guesses(TEXT, numbered_reader.load())
    heard = numbered_reader.guesses(TEXT)
    assert plain.keys() == heard.keys()
    differ = {kind_of(field) for field in plain if plain[field] != heard[field]}
    assert differ == {kind_of(field) for field in plain} & set(encoder.judges)


def test_missing_and_broken_weights_are_told_with_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"its file of weights .* is missing; make it with"):
        encoder_reader.load(tmp_path / "none.npz")
    (tmp_path / "bad.npz").write_bytes(b"PK no archive")
    with pytest.raises(ConfigError, match="is not a file of weights for the encoder of numbered reports"):
        encoder_reader.load(tmp_path / "bad.npz")
