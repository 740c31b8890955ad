"""The loop against two plain forwards without cache: same tokens, same logits, for every architecture."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest
import torch

from plugins.backbone.engine.check import batching, reference
from plugins.backbone.engine.families import Family
from plugins.backbone.engine.grammar import Grammar, GrammarCompiler, allowed
from plugins.backbone.engine.loop import engine_of
from plugins.backbone.engine.records import Answer, Prompt, Request
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from sgcad_core.interfaces import Decoder
from tests.effort import spread
from tests.plugins.backbone import tiny

EOS = frozenset({2})
LIMIT = 1e-4
ARCHITECTURES = list(tiny.BUILDERS)


@dataclass
class Recorder:
    """A decoder that keeps the rows it was given."""

    decoder: Decoder
    rows: list[tuple[torch.Tensor, torch.Tensor | None]] = field(default_factory=list)

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        for i in range(len(with_context)):
            self.rows.append((with_context[i].clone(), without_context[i].clone() if self.reads_prior() else None))
        return self.decoder.scores(with_context, without_context)

    def draw(self, scores: Any, generator: Any) -> Any:
        return self.decoder.draw(scores, generator)

    def reads_prior(self) -> bool:
        return self.decoder.reads_prior()


@cache
def model_of(name: str) -> tuple[Any, Family, bool]:
    model, family = tiny.build(name)
    return model, family, batching(model, family, None if name == "text_only" else tiny.picture(name, 1))


@cache
def maker() -> GrammarCompiler:
    return GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2])


def plain_loop(name: str, rows: tuple[Prompt, Prompt], decoder: Decoder, limit: int, grammar: Grammar | None) -> Any:
    """Token by token with two forwards each and no cache: ids, and both rows' logits at every step."""
    model, family, _ = model_of(name)
    ids: list[int] = []
    seen = []
    track = grammar.track() if grammar else None
    while len(ids) < limit and not (track and track.done):
        with_, without = (reference(model, family, prompt, ids)[-1] for prompt in rows)
        seen.append((with_, without))
        scores = decoder.scores(with_[None], without[None])
        if track:
            mask = np.zeros((1, (tiny.VOCABULARY + 31) // 32), np.int32)
            track.fill(mask[0])
            scores = scores.masked_fill(~allowed(mask, scores.shape[-1], scores.device), float("-inf"))
        token = int(decoder.draw(scores, None))
        if token in EOS:
            break
        if track:
            assert track.take(token)
        ids.append(token)
    return ids, seen


def run(
    name: str,
    count: int,
    decoder: Decoder,
    limit: int,
    grammar: Grammar | None = None,
    watched: bool = False,
    **fields: Any,
) -> Any:
    """`count` reports at once through the engine: prompts, answers and recorded rows."""
    model, family, apart = model_of(name)
    engine = engine_of(model, family, apart, reports_at_once=8, watched=watched)
    reports = [tiny.prompts(name, family, seed) for seed in range(count)]
    recorders = [Recorder(decoder) for _ in reports]
    requests = [
        Request(with_, without if decoder.reads_prior() else None, recorder, grammar, 0, limit, EOS, **fields)
        for (with_, without), recorder in zip(reports, recorders, strict=True)
    ]
    futures = [engine.submit(request) for request in requests]
    answers: list[Answer] = [future.result(timeout=60) for future in futures]
    engine.close()
    return reports, answers, recorders


def worst(recorder: Recorder, answer: Answer, seen: Any) -> float:
    """Largest difference of any logit at the positions that the loop scored."""
    jumped = len(recorder.rows) < len(seen)
    scored = [i for i, forced in enumerate(answer.forced) if not (jumped and forced)] or range(len(seen))
    faults = [0.0]
    for (with_, without), i in zip(recorder.rows, scored, strict=False):
        faults.append(float((with_ - seen[i][0]).abs().max()))
        if without is not None:
            faults.append(float((without - seen[i][1]).abs().max()))
    return max(faults)


@pytest.mark.parametrize(("name", "alpha"), spread(product(ARCHITECTURES, (0.0, 0.3, 0.7, 2.0)), 3))
def test_a_batch_of_reports_equals_two_forwards_without_cache(name: str, alpha: float) -> None:
    decoder = Cad(alpha=alpha)
    reports, answers, recorders = run(name, 4, decoder, 10)
    for rows, answer, recorder in zip(reports, answers, recorders, strict=True):
        ids, seen = plain_loop(name, rows, decoder, 10, None)
        assert answer.ids == ids
        assert worst(recorder, answer, seen) < LIMIT
        assert (answer.without_context == []) == (alpha == 0.0)


@pytest.mark.parametrize(("name", "held"), spread(product(ARCHITECTURES, (False, True)), 3))
def test_every_token_was_chosen_from_the_state_that_is_kept_of_it(name: str, held: bool) -> None:
    grammar = maker().grammar(tiny.SCHEMA) if held else None
    _, (first, *_), _ = run(name, 1, Cad(alpha=0.7), 60, grammar)
    _, answers, _ = run(name, 3, Cad(alpha=0.7), 60, grammar, watched=True, draft=first.ids)
    embedding = model_of(name)[0].get_output_embeddings()
    for answer in answers:
        assert len(answer.states) == len(answer.ids) == len(answer.with_context)
        logp = embedding(torch.stack(answer.states)).log_softmax(-1)
        found = logp.gather(-1, torch.tensor(answer.ids)[:, None])[:, 0]
        assert found.tolist() == pytest.approx(answer.with_context, abs=LIMIT)
    assert first.states == [], "not asked for"


@pytest.mark.parametrize("name", spread(ARCHITECTURES, 2))
def test_with_a_grammar_and_jump_forward_tokens_and_logits_stay_the_same(name: str) -> None:
    decoder = Cad(alpha=0.7)
    grammar = maker().grammar(tiny.SCHEMA)
    reports, answers, recorders = run(name, 3, decoder, 90, grammar)
    for rows, answer, recorder in zip(reports, answers, recorders, strict=True):
        assert any(answer.forced)
        ids, seen = plain_loop(name, rows, decoder, 90, grammar)
        assert grammar.text(answer.ids) == grammar.text(ids)
        assert answer.ids == ids
        assert worst(recorder, answer, seen) < LIMIT
        for logps, k in ((answer.with_context, 0), (answer.without_context, 1)):
            expected = [float(seen[i][k].log_softmax(-1)[t]) for i, t in enumerate(ids)]
            np.testing.assert_allclose(logps, expected, atol=LIMIT)


@pytest.mark.parametrize("count", spread(range(1, 9), 3))
def test_any_number_of_reports_gives_each_its_own_answer(count: int) -> None:
    decoder = Cad(alpha=0.7)
    reports, answers, recorders = run("qwen2_5_vl", count, decoder, 6)
    for rows, answer, recorder in zip(reports, answers, recorders, strict=True):
        ids, seen = plain_loop("qwen2_5_vl", rows, decoder, 6, None)
        assert answer.ids == ids
        assert worst(recorder, answer, seen) < LIMIT


@pytest.mark.parametrize("name", ARCHITECTURES)
def test_alpha_zero_equals_generate_token_for_token(name: str) -> None:
    model, family, _ = model_of(name)
    prompt, _ = tiny.prompts(name, family, 0)
    _, answers, _ = run(name, 1, Cad(alpha=0.0), 12)
    assert answers[0].ids == run(name, 1, Greedy(), 12)[1][0].ids
    from plugins.backbone.engine.check import _forget_positions
    from plugins.backbone.engine.families import forward_inputs

    ids = torch.tensor([list(prompt.ids)])
    inputs = forward_inputs(prompt.pictures)
    if family.dimensions > 1:
        inputs["mm_token_type_ids"] = ids.eq(tiny.IMAGE_TOKEN).int()
    if name == "mllama":
        inputs["cross_attention_mask"] = family.visible(prompt)[None]  # type: ignore[attr-defined]
    _forget_positions(model)
    ones = torch.ones_like(ids)
    made = model.generate(input_ids=ids, attention_mask=ones, max_new_tokens=12, do_sample=False, **inputs)
    expected = made[0, ids.shape[1] :].tolist()
    expected = expected[: expected.index(2)] if 2 in expected else expected
    assert answers[0].ids == expected


def test_on_a_text_model_it_equals_classifier_free_guidance_with_scale_one_plus_alpha() -> None:
    model, _, _ = model_of("text_only")
    for alpha in (0.3, 0.7, 2.0):
        reports, answers, _ = run("text_only", 3, Cad(alpha=alpha), 12)
        for (with_, without), answer in zip(reports, answers, strict=True):
            ids, negative = torch.tensor([list(with_.ids)]), torch.tensor([list(without.ids)])
            made = model.generate(
                input_ids=ids, attention_mask=torch.ones_like(ids), negative_prompt_ids=negative,
                negative_prompt_attention_mask=torch.ones_like(negative), guidance_scale=1 + alpha, max_new_tokens=12,
                do_sample=False,
            )  # fmt: skip
            expected = made[0, ids.shape[1] :].tolist()
            assert answer.ids == (expected[: expected.index(2)] if 2 in expected else expected)


@pytest.mark.parametrize("name", ARCHITECTURES)
def test_a_draft_changes_the_number_of_model_calls_and_nothing_else(name: str) -> None:
    decoder = Cad(alpha=0.7)
    grammar = maker().grammar(tiny.SCHEMA)
    _, (first, *_), _ = run(name, 1, decoder, 90, grammar)
    wrong = [t if i % 9 else (t + 1) % 250 for i, t in enumerate(first.ids)]
    for draft in (first.ids, wrong, first.ids[5:], [5, 6, 7] * 20):
        _, (again, *_), _ = run(name, 1, decoder, 90, grammar, draft=draft)
        assert again.ids == first.ids
        np.testing.assert_allclose(again.with_context, first.with_context, atol=LIMIT)
    _, (same, *_), _ = run(name, 1, decoder, 90, grammar, draft=first.ids)
    assert same.model_calls < 0.6 * first.model_calls


def test_without_jump_forward_the_answer_is_the_same_and_costs_more_calls() -> None:
    grammar = maker().grammar(tiny.SCHEMA)
    _, (jumped, *_), _ = run("qwen2_5_vl", 1, Cad(alpha=0.7), 90, grammar)
    _, (stepped, *_), _ = run("qwen2_5_vl", 1, Cad(alpha=0.7), 90, grammar, jump_forward=False)
    assert jumped.ids == stepped.ids
    assert jumped.model_calls < stepped.model_calls


@pytest.mark.parametrize(("name", "apart"), [("mllama", True), *((n, False) for n in ARCHITECTURES if n != "mllama")])
def test_the_self_check_keeps_rows_apart_only_where_a_batch_is_wrong(name: str, apart: bool) -> None:
    assert model_of(name)[2] is apart
