"""Teaching the encoder of numbered reports on made ones: that it learns, that numpy says what torch says, its table."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
import torch

from research.rows import narrative_rows
from research.rows.narrative_rows import Case
from research.rows.numbered_rows import Row
from research.training.readers import train_encoder_reader
from research.training.readers.encoder_batches import batches, changed, hid, lesson, prepared, renumbered
from research.training.readers.encoder_net import UNSEEN, EncoderNet, Size
from research.training.readers.train_encoder_reader import adds, kept, kept_cases, learn, taught, values_of, vocabulary
from research.training.readers.train_numbered_reader import taught as taught_linear
from sgcad_core.reading.second_reader import encoder_reader
from sgcad_core.reading.second_reader.encoder_tokens import (
    FIRST_NUMBER,
    FIRST_VEHICLE,
    FIRST_WAY,
    FIRST_WORD,
    HIDDEN,
    coded,
)
from sgcad_core.reading.second_reader.learned_reader import hashed
from sgcad_core.reading.second_reader.numbered.numbered_words import Said, tokens

SMALL = Size(width=16, layers=1, heads=2)


def cases(count: int, part: str = "taught", begin: int = 0) -> list[Case]:
    """Two vehicles one of which is told to stand; the rules say of both that they drive."""
    draw, found = random.Random(begin), []
    for n in range(count):
        stands = draw.choice(("V1", "V2"))
        texts = [f"{v} was {'halted' if v == stands else 'driving'} on the {draw.choice(('north', 'east'))} road"
                 for v in ("V1", "V2")]  # fmt: skip
        told = coded([Said(at, f"V{at + 1}", tokens(text)) for at, text in enumerate(texts)])
        rows = tuple(
            Row(f"r{begin + n}", part, f"maneuver.{v}", hashed(["M:w"]), hashed(["own=straight"]), "straight", 0.0,
                ("stopped" if v == stands else "straight",))
            for v in ("V1", "V2")
        )  # fmt: skip
        found.append(Case(told, rows))
    return found


@pytest.fixture(scope="module")
def encoder() -> encoder_reader.Encoder:
    torch.set_num_threads(1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(train_encoder_reader, "RATE", 0.01)  # a net so small takes larger steps
        return taught(cases(200), epochs=30, size=SMALL)


def test_which_vehicle_a_word_is_about_is_learned(encoder: encoder_reader.Encoder) -> None:
    right = [
        encoder.values["maneuver"][int(shares.argmax())] in row.allowed
        for row, shares in train_encoder_reader.heard(encoder, cases(50, begin=1000))["maneuver"]
    ]
    assert np.mean(right) > 0.95


def test_the_table_tells_what_is_mended_and_a_judge_hears_it(encoder: encoder_reader.Encoder) -> None:
    rows = [row for case in cases(100) for row in case.rows]
    some = [*cases(80, "apart", 2000), *cases(40, "blind", 3000)]
    ((name, judge, lines),) = learn(encoder, some, {"maneuver": taught_linear(rows)})
    assert name == "maneuver"
    assert judge is not None
    assert len(judge.change) == 6
    assert lines[0].startswith("maneuver, apart, judges cross-fitted: n 160, rules 0.5000")
    assert lines[1].startswith("maneuver, blind: n 80")


def test_an_encoder_that_says_nothing_new_is_not_heard(encoder: encoder_reader.Encoder) -> None:
    even = {name: np.zeros_like(array) for name, array in encoder.arrays.items()}
    rows = [row for case in cases(100) for row in case.rows]
    some = cases(80, "apart", 2000)
    ((_, judge, lines),) = learn(encoder._replace(arrays=even), some, {"maneuver": taught_linear(rows)})
    assert judge is None
    assert lines[0].endswith("(left to the linear readers)")


def test_what_may_be_chance_in_blind_lines_is_left_to_the_linear_readers() -> None:
    mends, spoils, even = [(False, True)], [(True, False)], [(True, True)] * 50
    assert adds(mends * 3 + spoils, mends * 8 + even)
    assert not adds(mends * 9 + even, mends * 5), "five of five are chance"
    assert not adds(mends * 5 + spoils * 4, mends * 30), "too few for what is spoiled"
    assert not adds(mends * 9, [])


def test_numpy_says_what_torch_says() -> None:
    torch.manual_seed(1)
    some = cases(6)
    words, values = vocabulary(some, 1), values_of(some)
    net = EncoderNet(FIRST_WORD + len(words), {"maneuver": 2}, SMALL).eval()
    state = {name: one.numpy() for name, one in net.state_dict().items() if not name.startswith(UNSEEN)}
    exact = kept(net, words, values)._replace(arrays=state)
    one = lesson([prepared(case, words, values) for case in some], net.emb.num_embeddings, 0.0)
    with torch.no_grad():
        pooled = net.pooled(net.encoded(one.batch), one.batch)
        of, _ = one.asked["maneuver"]
        said = torch.softmax(net.scores("maneuver", pooled[of, 0].flatten(1)), 1).numpy()
    again = [shares for _, shares in train_encoder_reader.heard(exact, some)["maneuver"]]
    assert np.abs(np.array(again) - said).max() < 1e-5


def test_only_words_of_many_reports_are_learned() -> None:
    rare = coded([Said(0, None, tokens("jane doe ran"))])
    some = [*cases(30), *(Case(rare, case.rows) for case in cases(3))]
    words = vocabulary(some)
    assert len(words) == 6, "was, halted, driving, on, the, road"
    assert not set(rare.codes.tolist()) & set(words.tolist())


def test_renumbering_and_turning_change_names_and_directions_alone() -> None:
    draw = np.random.default_rng(0)
    ids = np.array([FIRST_VEHICLE, FIRST_WAY + 7, FIRST_NUMBER, FIRST_WORD])
    number = np.array([0, 3, 2, 1, 4, 5, 6])
    assert changed(ids, number, 2).tolist() == [FIRST_VEHICLE + 2, FIRST_WAY + 1, FIRST_NUMBER, FIRST_WORD]
    assert sorted(renumbered(draw)) == list(range(7))
    assert renumbered(draw)[0] == 0
    assert renumbered(None).tolist() == list(range(7))


def test_about_so_many_words_are_hidden_and_no_padding() -> None:
    draw = np.random.default_rng(0)
    ids = np.full((50, 40), FIRST_WORD)
    ids[:, 30:] = 0
    shown, told = hid(ids, FIRST_WORD + 9, 0.2, draw)
    assert told[:, :30].mean() == pytest.approx(0.2, abs=0.03)
    assert not told[:, 30:].any()
    assert (shown[told] == HIDDEN).mean() > 0.7
    assert (shown[~told] == ids[~told]).all()


def test_an_epoch_has_every_report_once() -> None:
    some = cases(70)
    words, values = vocabulary(some, 1), values_of(some)
    ready = [prepared(case, words, values) for case in some]
    seen = [id(one) for part in batches(ready, np.random.default_rng(0)) for one in part]
    assert sorted(seen) == sorted(map(id, ready))


def test_rows_are_kept_between_calls(tmp_path: Path) -> None:
    narrative_rows.save(cases(3), tmp_path / "rows.npz")
    assert len(kept_cases(tmp_path / "rows.npz", tmp_path / "gone", None)) == 3
