"""Typing errors are mended towards the words of the rules; words, names and places in the text stay."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.errors import ConfigError
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.normalise import normalize
from sgcad_core.reading.text.traced_text import TracedText
from sgcad_core.reading.text.typos import Spelling, deletions, hashed, load, mended, one_slip, save

CLEAN = (
    "Vehicle 1 was traveling northbound in the right lane behind Vehicle 2. Vehicle 2 slowed for traffic. "
    "The front of Vehicle 1 struck the rear of Vehicle 2."
)
letters = st.text("abcdefghij", min_size=3, max_size=9)


@pytest.mark.parametrize(("written", "meant"), [
    ("nrothbound", "northbound"), ("strukc", "struck"), ("intersectin", "intersection"), ("lsft", "left"),
    ("frnt", "front"), ("frontof", "front of"), ("s0uthbound", "southbound"), ("veh1cle", None), ("left", None),
    ("toyota", None), ("i", None),
])  # fmt: skip
def test_a_slip_becomes_the_word_of_the_rules(written: str, meant: str | None) -> None:
    assert load().meant(written) == meant


@given(letters, letters)
def test_one_slip_is_one_edit(a: str, b: str) -> None:
    def edits(word: str) -> set[str]:
        letters = set(a + b)
        put = {word[:i] + c + word[i:] for i in range(len(word) + 1) for c in letters}
        taken = {word[:i] + c + word[i + 1 :] for i in range(len(word)) for c in letters}
        turned = {word[:i] + word[i + 1] + word[i] + word[i + 2 :] for i in range(len(word) - 1)}
        return (deletions(word) | put | taken | turned) - {word}

    assert one_slip(a, b) == (b in edits(a))


@given(st.data())
def test_a_slip_in_any_word_of_the_rules_is_mended_to_a_word_one_slip_away_or_stays(data: st.DataObject) -> None:
    spelling = load()
    word = data.draw(st.sampled_from(sorted(w for w in spelling.targets if len(w) >= 5)))
    at = data.draw(st.integers(1, len(word) - 2))
    slip = word[:at] + word[at + 1] + word[at] + word[at + 2 :]
    meant = spelling.meant(slip)
    assert meant is None or (meant in spelling.targets and one_slip(slip, meant)) or " " in meant


@given(st.lists(st.integers(3, len(CLEAN) - 3), max_size=4))
def test_characters_keep_their_places(left_out: list[int]) -> None:
    written = "".join(c for i, c in enumerate(CLEAN) if i not in left_out)
    text = mended(TracedText.of(written))
    assert all(0 <= a <= b <= len(written) for a, b in zip(text.starts, text.ends, strict=True))
    assert normalize(normalize(written)) == normalize(written)


@pytest.mark.parametrize("slips", [
    {"northbound": "nrothbound", "struck": "strukc"}, {"traveling": "travleing", "rear": "raer", "behind": "behnid"},
    {"lane": "lnae", "front": "frotn", "traffic": "trafic"}, {". The": ". the", ". Vehicle": ". vehicle"},
])  # fmt: skip
def test_a_report_with_slips_is_read_as_without(slips: dict[str, str]) -> None:
    text = CLEAN
    for word, slip in slips.items():
        text = text.replace(word, slip)
    assert {f.field: f.value for f in read(text).facts} == {f.field: f.value for f in read(CLEAN).facts}


def test_names_within_a_sentence_stay() -> None:
    assert mended(TracedText.of("V1 was on Trafic Street and Norht.")).text == "V1 was on Trafic Street and North."
    assert mended(TracedText.of("V1 STRUKC V2.")).text == "V1 STRUCK V2."


def test_of_two_words_the_far_commoner_one_is_taken_or_none() -> None:
    near = Spelling({"rear": 900.0, "read": 10.0}, frozenset())
    assert near.meant("reax") == "rear"
    assert Spelling({"rear": 90.0, "read": 80.0}, frozenset()).meant("reax") is None
    assert Spelling({"rear": 900.0}, frozenset({hashed("reax")})).meant("reax") is None


def test_a_file_that_is_none_is_named_with_its_remedy(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="train_spelling"):
        load(tmp_path / "none.npz")
    save({"rear": 3}, ["rear", "gear"], tmp_path / "some.npz")
    assert load(tmp_path / "some.npz").targets == {"rear": 3.0}
