"""The loop's own promises: reports enter and leave, memory runs out, prefixes are reused, nobody waits for ever."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import torch
import transformers as tf

from plugins.backbone.engine.check import batching, kept_batching
from plugins.backbone.engine.families import Family, family_of
from plugins.backbone.engine.faults import DoesNotFit, EngineFault, TooBig, TooLong, WrongBatch
from plugins.backbone.engine.grammar import GrammarCompiler
from plugins.backbone.engine.loop import engine_of
from plugins.backbone.engine.records import Prompt, Request
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from sgcad_core.interfaces import Decoder
from tests.plugins.backbone import tiny

EOS = frozenset({2})


class Cramped(tf.LlamaForCausalLM):
    """A model whose memory holds a batch of `rows` rows."""

    rows = 2

    def forward(self, input_ids: Any = None, **kwargs: Any) -> Any:
        if input_ids.shape[0] > self.rows:
            raise torch.OutOfMemoryError(f"CUDA out of memory: {input_ids.shape[0]} rows")
        return super().forward(input_ids=input_ids, **kwargs)


class Muddled(tf.LlamaForCausalLM):
    """A model that computes something else in a batch."""

    def forward(self, input_ids: Any = None, **kwargs: Any) -> Any:
        found = super().forward(input_ids=input_ids, **kwargs)
        found.logits = found.logits * torch.linspace(1, input_ids.shape[0], found.logits.shape[-1])
        return found


def built(kind: type[Any]) -> tuple[Any, Family]:
    torch.manual_seed(0)
    model = kind(tf.LlamaConfig(**tiny._TEXT)).eval()
    return model, family_of(model)


def request(family: Family, seed: int, decoder: Decoder | None = None, tokens: int = 12, **fields: Any) -> Request:
    with_, without = tiny.prompts("text_only", family, seed)
    return Request(with_, without, decoder or Cad(), None, seed, tokens, EOS, **fields)


def alone(model: Any, family: Family, requests: Sequence[Request]) -> list[list[int]]:
    found = []
    for one in requests:
        engine = engine_of(model, family)
        found.append(engine.generate(one).ids)
        engine.close()
    return found


def test_reports_enter_and_leave_and_each_gets_the_answer_it_would_get_alone() -> None:
    model, family = tiny.build("text_only")
    requests = [request(family, seed, tokens=4 + 3 * (seed % 5)) for seed in range(9)]
    engine = engine_of(model, family, reports_at_once=3)
    futures = [engine.submit(one) for one in requests]
    assert [future.result(30).ids for future in futures] == alone(model, family, requests)
    assert engine.jobs == []
    assert all(lane.rows == [] for lane in engine.runner.lanes.values())


def test_memory_running_out_halves_the_batch_and_loses_nothing() -> None:
    model, family = built(Cramped)
    model.rows = 99
    requests = [request(family, seed) for seed in range(6)]
    expected = alone(model, family, requests)
    model.rows = 5
    engine = engine_of(model, family, reports_at_once=6)
    futures = [engine.submit(one) for one in requests]
    assert [future.result(30).ids for future in futures] == expected
    assert engine.halved >= 1
    assert engine.limit <= 2


def test_memory_running_out_in_the_middle_keeps_grammar_draws_and_log_probabilities() -> None:
    model, family = built(Cramped)
    grammar = GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2]).grammar(tiny.SCHEMA)
    decoder = Cad(temperature=1.0)
    with_, without = tiny.prompts("text_only", family, 1)
    late = Request(with_, without, decoder, grammar, 5, 90, EOS)
    model.rows = 99
    plain = engine_of(model, family).generate(late)
    model.rows = 3
    engine = engine_of(model, family, reports_at_once=4)
    futures = [engine.submit(one) for one in (late, *(request(family, s, tokens=20) for s in range(3)))]
    crowded = futures[0].result(30)
    assert crowded.ids == plain.ids
    assert crowded.forced == plain.forced
    assert crowded.with_context == pytest.approx(plain.with_context, abs=1e-4)
    assert crowded.without_context == pytest.approx(plain.without_context, abs=1e-4)


def test_a_single_report_that_does_not_fit_in_memory_fails_and_the_next_is_tried() -> None:
    model, family = built(Cramped)
    model.rows = 1
    engine = engine_of(model, family)
    with pytest.raises(TooBig, match=r"one report alone does not fit in memory: .*2 rows"):
        engine.generate(request(family, 0))
    with_, _ = tiny.prompts("text_only", family, 0)
    assert engine.generate(Request(with_, None, Greedy(), None, 0, 5, EOS)).ids


def test_the_second_row_reuses_the_shared_beginning_and_a_repair_everything_before_its_findings() -> None:
    model, family = tiny.build("qwen2_5_vl")
    engine = engine_of(model, family)
    with_, without = tiny.prompts("qwen2_5_vl", family, 0, shared=30)
    first = engine.generate(Request(with_, without, Cad(), None, 0, 12, EOS))
    assert first.reused_tokens >= 30
    findings = tiny.words(6, 77)
    longer = [Prompt([*p.ids, *first.ids, *findings], p.pictures) for p in (with_, without)]
    repair = Request(longer[0], longer[1], Cad(), None, 0, 12, EOS)
    again = engine.generate(repair)
    assert again.prompt_tokens - again.reused_tokens <= 2 * (len(findings) + 1)
    fresh = engine_of(model, family, prefix_bytes=0).generate(repair)
    assert fresh.reused_tokens == 0
    assert again.ids == fresh.ids
    assert again.with_context == pytest.approx(fresh.with_context, abs=1e-4)


@pytest.mark.parametrize("name", list(tiny.BUILDERS))
def test_another_picture_in_the_same_place_is_not_taken_for_the_first(name: str) -> None:
    model, family = tiny.build(name)
    engine = engine_of(model, family, apart=name == "mllama")
    task, rest = tiny.words(20, 1), tiny.words(6, 2)
    seeds = (4, 16) if name != "idefics3" else (3, 6)
    pictures = [tiny.picture(name, seed) for seed in seeds]
    prompts = [Prompt([*task, *[tiny.IMAGE_TOKEN] * family.tokens_of(p), *rest], [p]) for p in pictures]
    for prompt in (*prompts, *prompts):
        request = Request(prompt, None, Greedy(), None, 0, 4, EOS)
        fresh = engine_of(model, family, apart=name == "mllama", prefix_bytes=0).generate(request)
        assert engine.generate(request).with_context == pytest.approx(fresh.with_context, abs=1e-4)


def test_a_prompt_beyond_the_window_is_refused_with_both_numbers() -> None:
    model, family = tiny.build("text_only")
    long = Request(Prompt(tiny.words(1000, 1)), None, Greedy(), None, 0, 50, EOS)
    with pytest.raises(TooLong, match=r"prompt has 1000 tokens and the answer may have 50, .* 1050; .* is 1024"):
        engine_of(model, family).generate(long)


def test_a_prompt_that_ends_in_a_picture_is_refused_and_leaves_no_row_behind() -> None:
    model, family = tiny.build("llava")
    engine = engine_of(model, family)
    picture = tiny.picture("llava", 1)
    bad = Prompt([5, *[tiny.IMAGE_TOKEN] * family.tokens_of(picture)], [picture])
    with pytest.raises(ValueError, match="ends in a picture"):
        engine.generate(Request(bad, None, Greedy(), None, 0, 4, EOS))
    short = Prompt([5, tiny.IMAGE_TOKEN, 6], [picture])
    with pytest.raises(ValueError, match="the prompt has 1 picture tokens, its 1 pictures need"):
        engine.generate(Request(short, None, Greedy(), None, 0, 4, EOS))
    assert engine.jobs == []
    assert all(not lane.rows for lane in engine.runner.lanes.values())


def test_a_closed_engine_answers_nobody_and_says_so() -> None:
    model, family = tiny.build("text_only")
    engine = engine_of(model, family, reports_at_once=1)
    futures = [engine.submit(request(family, seed, tokens=400)) for seed in range(3)]
    engine.close()
    for future in futures:
        if not future.done() or future.exception():
            with pytest.raises(EngineFault, match="closed before this report was answered"):
                future.result(5)
    with pytest.raises(EngineFault, match="the engine is closed"):
        engine.submit(request(family, 0))


def test_a_model_that_is_wrong_in_a_batch_is_refused_at_the_start() -> None:
    model, family = built(Muddled)
    with pytest.raises(WrongBatch, match=r"Muddled gives other logits in a batch .*one batch: .*two caches: "):
        batching(model, family, None)


def test_how_a_model_is_batched_is_kept_and_a_wrong_one_is_refused_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model, family = tiny.build("text_only")
    assert kept_batching(model, family, None, tmp_path) is batching(model, family, None)
    assert len(list(tmp_path.iterdir())) == 1
    monkeypatch.setattr("plugins.backbone.engine.check.batching", lambda *_: pytest.fail("checked again"))
    assert kept_batching(model, family, None, tmp_path) is False
    with pytest.raises(pytest.fail.Exception):
        kept_batching(*built(Cramped), None, tmp_path)
    monkeypatch.undo()
    for _ in range(2):
        with pytest.raises(WrongBatch):
            kept_batching(*built(Muddled), None, tmp_path)
    (tmp_path / "file").touch()
    assert kept_batching(model, family, None, tmp_path / "file") is False


def test_a_dead_end_names_the_field() -> None:
    """Neither digits nor a minus can be spelled by this vocabulary, so no integer can."""
    from llguidance import LLTokenizer

    tokens = [bytes([b]) if not (48 <= b <= 57 or b == 45) else b"~" + bytes([b]) for b in range(256)]

    class Words:
        eos_token_id, bos_token_id = 256, None
        special_token_ids = (256,)

        def __init__(self) -> None:
            self.tokens = [*tokens, b"<eos>"]

        def __call__(self, text: bytes) -> list[int]:
            return list(text)

    from llguidance import TokenizerWrapper

    maker = GrammarCompiler(LLTokenizer(TokenizerWrapper(Words()), n_vocab=tiny.VOCABULARY), tiny.VOCABULARY, [256])
    lanes = {"type": "object", "properties": {"lanes": {"type": "integer"}}, "required": ["lanes"]}
    model, family = tiny.build("text_only")
    with_, without = tiny.prompts("text_only", family, 0)
    with pytest.raises(DoesNotFit, match="no token may follow") as caught:
        engine_of(model, family).generate(Request(with_, without, Cad(), maker.grammar(lanes), 0, 60, frozenset({256})))
    assert caught.value.path == "lanes"


@pytest.mark.slow
def test_an_interpreter_that_ends_has_ended_the_loop_first() -> None:
    told = """
import atexit
atexit.register(lambda: print("alive" if engine.thread.is_alive() else "ended"))  # runs behind the loop's own
from plugins.backbone.engine.loop import engine_of
from tests.plugins.backbone import test_loop, tiny
model, family = tiny.build("text_only")
engine = engine_of(model, family)
print(len(engine.generate(test_loop.request(family, 1)).ids))
"""
    done = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.split()) == (0, ["12", "ended"]), done.stderr
