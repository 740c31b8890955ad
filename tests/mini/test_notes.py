"""Lists of lanes: every item says which lanes it tells, where its words end, and answers look there."""

import re
from dataclasses import replace
from random import Random

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from mini import tags
from mini.batch import Taggers
from mini.generator.grammar import MARK, unmark
from mini.generator.listed import MOST, USES, Item, placed
from mini.generator.noise import slips
from mini.generator.report import Report, make_report
from mini.generator.words import NUMBERS
from mini.generator.world import WORDS
from mini.rows import collate, training_row
from mini.tokens import Coder, train_tokenizer

seeds = st.integers(0, 10**6)
items = st.builds(Item, st.integers(0, 7), st.sampled_from(USES), st.integers(0, MOST))
COUNTS = {"a": 1, "an": 1, "a single": 1, **{word: lanes for lanes, word in enumerate(NUMBERS)}}
TOLD = re.compile(
    r".*\b(?P<count>a single|an?|one|two|three|four|five|six|seven|\d) (?P<rest>(?:(?!\b(?:and|or)\b|[,;]).)*)$", re.S
)


@pytest.fixture(scope="module")
def coder() -> Coder:
    return Coder(train_tokenizer(make_report(seed, modes={"text": 1.0}).narrative for seed in range(200)))


def with_lists(count: int, held_out: bool = False) -> list[Report]:
    """The first reports without a drawing that list lanes."""
    found: list[Report] = []
    seed = 0
    while len(found) < count:
        report = make_report(seed, held_out, length=0.2, modes={"text": 1.0})
        found += [report] * bool(report.items)
        seed += 1
    return found


@given(item=items)
def test_a_mark_is_read_as_the_item_it_stands_for(item: Item) -> None:
    assert Item.of(item.mark) == item


@given(letter=st.characters(max_codepoint=0xEFFFF))
def test_no_other_letter_is_a_mark(letter: str) -> None:
    assert Item.of(letter) is None


@given(found=st.lists(st.tuples(st.text("a b,.", max_size=5), items), max_size=6))
def test_marks_are_taken_out_with_their_places(found: list[tuple[str, Item]]) -> None:
    text = "".join(words + item.mark for words, item in found)
    plain, sentences, told = unmark(text + f".{chr(MARK)}")
    assert plain == "".join(words for words, _ in found) + "."
    assert sentences == [(len(plain), 0)]
    assert [item for _, item in told] == [item for _, item in found]
    assert [plain[:end] for end, _ in told] == ["".join(w for w, _ in found[: n + 1]) for n in range(len(found))]


@pytest.mark.parametrize("held_out", [False, True])
def test_items_say_what_their_words_say(held_out: bool) -> None:
    seen = slips = 0
    for report in with_lists(60, held_out):
        for end, item in report.items:
            words = TOLD.search(report.narrative[:end].lower())
            if words is None:  # a slip of the pen
                continue
            count = COUNTS.get(words["count"]) or int(words["count"])
            assert item.lanes == count
            assert ("left" in words["rest"]) == (item.use == "left")
            assert ("right" in words["rest"]) == (item.use == "right")
            way, begun = WORDS[(item.leg + 4) % 8], max((e for e, _ in report.sentences if e < end), default=0)
            before = re.sub("[/-]", "", report.narrative[begun:end].lower())
            slips += way not in before and f"{way[0]}b" not in before
            seen += 1
    assert seen > 150
    assert slips < 0.02 * seen  # a slip of the pen


@settings(max_examples=150, deadline=None)
@given(seed=seeds)
def test_items_of_an_approach_sum_up_to_its_lanes(seed: int) -> None:
    report = make_report(seed, modes={"text": 1.0})
    for leg in report.crash.legs:
        own = [item for _, item in report.items if item.leg == leg.bearing]
        if own:
            told = sum(item.lanes for item in own)
            assert told % leg.lanes_in == 0  # a road may be described twice
            uses = {item.use for item in own}
            assert {"left", "right"} & uses == {"left", "right"} & set(leg.turns_in)


@given(
    parts=st.lists(st.sampled_from(["two lanes", "eastbound", "Westbound", "one lane", " and "]), max_size=6),
    marked=st.lists(st.sampled_from([2, 6]), max_size=6),
)
def test_items_before_the_words_for_their_way_lose_their_marks(parts: list[str], marked: list[int]) -> None:
    pieces = [f"{part} " for part in parts]
    for at, leg in zip(range(len(pieces)), marked, strict=False):
        pieces[at] += Item(leg, "through", 2).mark
    text = "".join(pieces)
    plain, _, kept = unmark(placed(text, {6: "eastbound", 2: "westbound"}))
    assert plain == unmark(text)[0]
    for end, item in unmark(text)[2]:
        told = ("eastbound" if item.leg == 6 else "westbound") in plain[:end].lower()
        assert ((end, item) in kept) == told


def test_slips_of_the_pen_fall_as_if_no_mark_were_there() -> None:
    words = ["two lanes", "one eastbound lane", "a left turn lane and"] * 40
    marked = " ".join(some + Item(6, "left", 1).mark for some in words)
    for seed in range(20):
        slipped = slips(Random(seed), marked, 0.2)
        assert unmark(slipped)[0] == slips(Random(seed), " ".join(words), 0.2)
        assert len(unmark(slipped)[2]) == len(words)


def test_the_tagged_token_ends_the_item(coder: Coder) -> None:
    for report in with_lists(30):
        row = training_row(coder, report, None)
        assert len(row.item_tags) == len(report.items)
        for (at, said), (end, item) in zip(row.item_tags, report.items, strict=True):
            assert coder.raw.decode(row.ids[: at + 1]).startswith(report.narrative[:end])
            assert not coder.raw.decode(row.ids[:at]).startswith(report.narrative[:end])
            assert said == tags.listed(item)


def test_lanes_point_at_the_items_that_tell_them(coder: Coder) -> None:
    found = 0
    for report in with_lists(60):
        row = training_row(coder, report, None)
        places = {at for at, _ in row.item_tags}
        by_leg = {leg: {at for at, said in row.item_tags if tags.ITEM[f"leg={leg}"] in said} for leg in range(8)}
        pointed = [frozenset(places.intersection(sources)) for _, sources in row.pointers]
        for leg in report.crash.legs:
            known = f"lanes.{leg.bearing % 4}" in report.told and f"turns.{leg.bearing % 4}" in report.told
            if known and by_leg[leg.bearing]:
                assert by_leg[leg.bearing] in pointed
                found += 1
        assert set().union(*pointed) <= places
    assert found > 40


def test_a_list_that_tells_nothing_for_sure_is_pointed_at_by_nothing(coder: Coder) -> None:
    """Beside a drawing of one carriageway sentences no longer tell the road's lanes, and no answer is read there."""
    for report in with_lists(10):
        mute = [(end, {f for f in facts if not f.startswith(("lanes", "turns"))}) for end, facts in report.sentences]
        row = training_row(coder, replace(report, sentences=mute), None)
        assert row.item_tags
        assert not any({at for at, _ in row.item_tags}.intersection(sources) for _, sources in row.pointers)


def test_a_batch_carries_the_items_of_its_rows_and_heads_learn_them(coder: Coder) -> None:
    rows = [training_row(coder, report, None) for report in with_lists(4)]
    batch = collate(rows, coder)
    assert batch.items.tolist() == [
        i * batch.ids.shape[1] + at for i, row in enumerate(rows) for at, _ in row.item_tags
    ]
    assert batch.listed.sum(dim=1).tolist() == [3.0] * len(batch.items)
    torch.manual_seed(0)
    heads = Taggers(16, 5, len(tags.ITEM), 7)
    states = torch.randn(len(batch.items), 16)
    before = float(heads.items(states, batch.listed).detach())
    step = torch.optim.Adam(heads.parameters(), lr=0.05)
    for _ in range(60):
        step.zero_grad()
        heads.items(states, batch.listed).backward()
        step.step()
    assert float(heads.items(states, batch.listed).detach()) < 0.5 * before
    assert float(heads.items(states[:0], batch.listed[:0]).detach()) == 0
