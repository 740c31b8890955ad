"""The tokenizer: text comes back, fragments are single tokens, pieces join to what the tokenizer would give."""

import json
import re
from collections import Counter
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from research.generator.report import make_report
from research.model.tokens import ROAD, SCENARIO, SPECIAL, Coder, fragments, train_tokenizer
from research.rows.report_rows import training_row
from tests.research.reports import text_report

_SPARED = (
    "a an the its his her own of in at to and then also had that which turn turning lane lanes road roadway street "
    "highway side direction travel traveling approach"
)
SPARED = set(_SPARED.split())


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(train_tokenizer(text_report(seed).narrative for seed in range(300)))


@settings(max_examples=100, deadline=None)
@given(text=st.text(max_size=200))
def test_any_text_comes_back(coder: Coder, text: str) -> None:
    assert coder.tokenizer.decode(coder.text(text)) == text.replace("<|", "< |")


def test_fragments_are_single_tokens(coder: Coder) -> None:
    assert all(len(coder.piece(fragment)) == 1 for fragment in fragments())


def test_numbers_below_a_hundred_are_single_tokens(coder: Coder) -> None:
    assert all(len(coder.piece(str(number))) == 1 for number in range(100))


def test_a_report_cannot_smuggle_special_tokens(coder: Coder) -> None:
    ids = set(coder.text("the end <|im_end|><|road|>"))
    assert not ids & {coder.special[name] for name in SPECIAL}


def test_pieces_join_to_the_tokens_of_the_whole_answer(coder: Coder) -> None:
    for seed in range(80):
        report = text_report(seed)
        row = training_row(coder, report, None)
        start = row.ids.index(coder.special[ROAD]) + 1
        end = row.ids.index(coder.special[SCENARIO])
        whole = coder.raw.encode(json.dumps(report.road, separators=(",", ":")), add_special_tokens=False).ids
        assert row.ids[start:end] == whole


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_a_copy_without_wear_is_the_narrative(coder: Coder, seed: int) -> None:
    text = make_report(seed, modes={"text": 1.0}).narrative
    ids, ends = coder.worn(text, 0.0, 0.0, Random(seed))
    assert ids == coder.text(text)
    assert ends == [end for _, end in coder.raw.encode(text, add_special_tokens=False).offsets]


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), broken=st.floats(0, 1))
def test_broken_tokens_join_to_the_same_text_and_spare_numbers(coder: Coder, seed: int, broken: float) -> None:
    report = make_report(seed, modes={"text": 1.0}, length=0.3)
    ids, ends = coder.worn(report.narrative, broken, 0.0, Random(seed))
    assert (ids, ends) == coder.worn(report.narrative, broken, 0.0, Random(seed))
    assert coder.tokenizer.decode(ids) == report.narrative
    assert ends == sorted(ends)
    assert {end for end, _ in report.sentences} <= set(ends)
    pairs = [t for t in coder.text(report.narrative) if coder.tokenizer.decode([t]).isdigit()]
    assert [t for t in ids if coder.tokenizer.decode([t]).isdigit()] == pairs


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_of_words_left_out_none_tells_anything(coder: Coder, seed: int) -> None:
    report = make_report(seed, modes={"text": 1.0}, length=0.3)
    ids, ends = coder.worn(report.narrative, 0.0, 1.0, Random(seed))
    before, after = (Counter(re.findall("[A-Za-z]+", text)) for text in (report.narrative, coder.tokenizer.decode(ids)))
    assert set(before - after) <= SPARED
    assert not after - before
    assert {end for end, _ in report.sentences} <= set(ends)  # full stops stay


@pytest.mark.parametrize(("text", "left"), [
    (" making a left turn.", " making left."), (" in the left turn lane of the road", " left turn"),
    (" was struck by V1 from the north", " was struck by V1 from north"), (" two-lane", " two-lane"),
    (" in the left turning lane", " left turning"), (" left turn-lane", " left turn-lane"),
    (" the at-fault vehicle at 7 a.m.", " at-fault vehicle 7 a.m."),
])  # fmt: skip
def test_what_is_left_of_an_idiom_tells_it(coder: Coder, text: str, left: str) -> None:
    assert coder.tokenizer.decode(coder.worn(text, 0.0, 1.0, Random(0))[0]) == left


def test_the_template_puts_evidence_first_and_the_task_last(coder: Coder) -> None:
    content = [{"type": "text", "text": "<|road|>\n\n"}, {"type": "image"}, {"type": "text", "text": "V1 struck V2."}]
    text = coder.tokenizer.apply_chat_template(
        [{"role": "user", "content": content}], tokenize=False, add_generation_prompt=True
    )
    assert text == "V1 struck V2.<|vision_start|><|image_pad|><|vision_end|><|road|>"


def test_picks_point_at_value_tokens(coder: Coder) -> None:
    row = training_row(coder, text_report(3), None)
    spoken = "".join(coder.tokenizer.decode([row.ids[at]]) for at, _ in row.picks)
    assert '"forward"' in spoken
    assert ',"direction":' not in spoken


@pytest.mark.slow
def test_where_more_digits_might_follow_the_end_of_a_number_is_learned(coder: Coder) -> None:
    seen = 0
    for seed in range(400):
        report = text_report(seed)
        if report.behavior is None or "actors" not in report.behavior:
            continue
        speeds = [actor["speed_mph"] for actor in report.behavior["actors"]]
        row = training_row(coder, report, None)
        ends = [at for at, _ in row.picks if row.ids[at] == coder.piece(',"length_m":')[0]]
        assert len(ends) == sum(speed is not None and 0 < speed < 10 for speed in speeds)
        assert all(coder.tokenizer.decode([row.ids[at - 1]]).isdigit() for at in ends)
        seen += len(ends)
    assert seen > 3


def test_a_distance_ends_behind_its_decimals(coder: Coder) -> None:
    reports = [r for r in (text_report(seed) for seed in range(300)) if r.road.get("accesses")]
    assert reports
    for report in reports:
        row = training_row(coder, report, None)
        learned = "".join(coder.tokenizer.decode([row.ids[at]]) for at, _ in row.picks)
        for access in report.road["accesses"]:
            assert f'{access["distance_m"]},"kind":' in learned
