"""The small parts of the loop: slots, kept prefixes, drafts, masks, faulty schemas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.backbone.engine.cache import SlotCache, Window
from plugins.backbone.engine.faults import DoesNotFit
from plugins.backbone.engine.grammar import GrammarCompiler, allowed, choice_counts, collisions, single_choices
from plugins.backbone.engine.job import Draft
from plugins.backbone.engine.prefix import SHORTEST, PrefixStore, prompt_key
from tests.plugins.backbone import tiny

torch.set_num_threads(1)
HEADS, WIDTH = 2, 3


# ------------------------------------------------------------------ slots
def states(values: list[float]) -> torch.Tensor:
    """(1, heads, tokens, channels) whose every number is the token's value."""
    return torch.tensor(values).view(1, 1, -1, 1).expand(1, HEADS, -1, WIDTH).clone()


def write(cache: SlotCache, slot: int, start: int, values: list[float]) -> None:
    places = slot * cache.capacity + start + torch.arange(len(values))
    cache.look_at(Window(slot, 1, start + len(values), start, places))
    cache.update(states(values), -states(values), 0)


def read(cache: SlotCache, slot: int, length: int) -> list[float]:
    keys, values = cache.layers[0].stored
    assert torch.equal(keys[slot, :length], -values[slot, :length])
    return [float(v) for v in keys[slot, :length, 0, 0]]


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(1, 300)), min_size=1, max_size=8))
@settings(max_examples=30, deadline=None)
def test_rows_keep_their_own_tokens_however_the_storage_grows(writes: list[tuple[int, int]]) -> None:
    cache = SlotCache(1)
    known: dict[int, list[float]] = {}
    for number, (slot, count) in enumerate(writes):
        row = known.setdefault(slot, [])
        fresh = [1000.0 * number + i + 1 for i in range(count)]
        cache.ensure(slot + 1, len(row) + count)
        write(cache, slot, len(row), fresh)
        row += fresh
        assert all(read(cache, s, len(r)) == r for s, r in known.items())


def test_a_row_moves_is_saved_and_loaded_as_it_was() -> None:
    cache = SlotCache(1)
    cache.ensure(3, 10)
    write(cache, 0, 0, [1.0, 2.0, 3.0])
    cache.move(0, 2, 3)
    saved = cache.save(2, 3)
    cache.clear(0)
    assert read(cache, 0, 3) == [0.0, 0.0, 0.0]
    other = SlotCache(1)
    other.load(1, saved, 2)
    assert read(other, 1, 3) == [1.0, 2.0, 0.0]


# ------------------------------------------------------------------ prefixes
def saved(length: int) -> Any:
    return [(torch.zeros(length, HEADS, WIDTH), torch.zeros(length, HEADS, WIDTH))]


def test_the_longest_shared_beginning_is_found_and_pictures_count_by_their_digest() -> None:
    store = PrefixStore(1 << 20)
    shared = list(range(20))
    first = prompt_key([*shared, 9, 9, 9, 5], [(20, 23)], ["aaaaaaaaaaaa"])
    store.add((), first, saved(24))
    same = store.longest((), prompt_key([*shared, 9, 9, 9, 6], [(20, 23)], ["aaaaaaaaaaaa"]))
    other = store.longest((), prompt_key([*shared, 9, 9, 9, 5], [(20, 23)], ["bbbbbbbbbbbb"]))
    assert same is not None
    assert same[1] == 23
    assert other is not None
    assert other[1] == 20
    assert store.longest(("picture",), first) is None
    assert store.longest((), np.arange(SHORTEST - 1)) is None


def test_a_longer_prompt_replaces_its_own_beginning_and_the_limit_drops_the_oldest() -> None:
    size = 2 * 4 * HEADS * WIDTH * 40
    store = PrefixStore(2 * size)
    store.add((), np.arange(20), saved(20))
    store.add((), np.arange(40), saved(40))
    assert len(store.entries) == 1
    for start in (100, 200):
        store.add((), np.arange(start, start + 40), saved(40))
    assert store.longest((), np.arange(40)) is None
    assert store.known((), np.arange(200, 240))
    PrefixStore(0).add((), np.arange(40), saved(40))


# ------------------------------------------------------------------ drafts
def test_a_draft_follows_substitutions_insertions_and_deletions() -> None:
    earlier = list(range(100, 160))
    draft = Draft(earlier)
    for token in (100, 101, 102):
        draft.note(token)
    assert draft.guess(3) == [103, 104, 105]
    draft.note(7)
    assert draft.guess(2) == [104, 105]
    for token in (8, 9, 104, 105, 106):
        draft.note(token)
    assert draft.guess(2) == [107, 108]
    for token in (120, 121, 122):
        draft.note(token)
    assert draft.guess(2) == [123, 124]


def test_a_draft_guesses_further_after_success_and_less_after_failure() -> None:
    draft = Draft(list(range(200)))
    assert len(draft.guess(100)) == 16
    draft.judge(16, 16)
    assert len(draft.guess(100)) == 32
    draft.judge(32, 1)
    assert len(draft.guess(100)) == 2
    assert draft.guess(0) == []
    assert Draft([]).guess(9) == []


# ------------------------------------------------------------------ grammar
@given(st.lists(st.booleans(), min_size=70, max_size=70))
@settings(max_examples=20, deadline=None)
def test_a_mask_unpacks_to_the_tokens_it_holds(bits: list[bool]) -> None:
    mask = np.packbits(np.array([*bits, *[False] * 26]), bitorder="little").view(np.int32)[None]
    assert allowed(mask, 70, torch.device("cpu"))[0].tolist() == bits
    assert choice_counts(mask).tolist() == [sum(bits)]


@given(st.lists(st.integers(0, 319), min_size=1, max_size=9))
@settings(max_examples=30, deadline=None)
def test_the_only_token_of_a_mask_is_read_off_it(tokens: list[int]) -> None:
    mask = np.zeros((len(tokens), 10), np.uint32)
    for row, token in enumerate(tokens):
        mask[row, token // 32] = np.uint32(1) << np.uint32(token % 32)
    assert single_choices(mask.view(np.int32)).tolist() == tokens


def test_a_schema_is_compiled_once() -> None:
    maker = GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2])
    assert maker.grammar(tiny.SCHEMA) is maker.grammar(dict(tiny.SCHEMA))


@pytest.mark.parametrize(
    ("part", "path"),
    [
        ({"type": "string", "minLength": 5, "maxLength": 3}, "a"),
        ({"type": "array", "minItems": 2, "maxItems": 1, "items": {"type": "null"}}, "a"),
        ({"type": "array", "minItems": 1, "items": {"enum": []}}, r"a\[\]"),
        ({"type": "string", "pattern": "(?=x)"}, "a"),
    ],
)
def test_a_schema_that_cannot_be_met_names_the_innermost_part_at_fault(part: dict[str, Any], path: str) -> None:
    maker = GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2])
    schema = {"type": "object", "properties": {"ok": {"type": "null"}, "a": part}, "required": ["ok", "a"]}
    with pytest.raises(DoesNotFit, match=rf"no answer can meet the schema at {path}: "):
        maker.grammar(schema)


def test_special_tokens_within_the_answers_words_collide_and_others_do_not() -> None:
    schema = {"properties": {"legs": {"enum": ["a<x>b"]}}}
    assert collisions(["<x>", "<eos>", "<|im_end|>", '"', "legs"], schema) == ["<x>", '"', "legs"]
