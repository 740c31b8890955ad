"""Equality and meaning on a model that has learned something: see `trained.py`."""

from __future__ import annotations

import json
import random

import numpy as np
import pytest

from plugins.backbone.engine.check import reference
from plugins.backbone.engine.grammar import Grammar, GrammarCompiler, allowed
from plugins.backbone.engine.loop import engine_of
from plugins.backbone.engine.records import Answer, Prompt, Request
from plugins.decoder.adacad import AdaCad
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from sgcad_core.asking.json_field_spans import grounding
from sgcad_core.interfaces import Decoder
from tests.plugins.backbone import tiny, trained

EOS = frozenset({2})
REPORTS = [trained.sample(random.Random(seed)) for seed in range(1000, 1012)]
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def grammar() -> Grammar:
    return GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2]).grammar(trained.SCHEMA)


def nothing() -> Prompt:
    return trained.sample(random.Random(0), context=False)[0]


def answers(reports: list[Prompt], decoder: Decoder, grammar: Grammar | None) -> list[Answer]:
    model, family = trained.model()
    engine = engine_of(model, family, reports_at_once=8)
    requests = [Request(prompt, nothing(), decoder, grammar, 0, 80, EOS) for prompt in reports]
    found = [future.result(60) for future in [engine.submit(request) for request in requests]]
    engine.close()
    return found


def plain(prompt: Prompt, decoder: Decoder, grammar: Grammar | None) -> tuple[list[int], list[float], list[float]]:
    """The reference loop: ids and both rows' log-probabilities."""
    model, family = trained.model()
    ids: list[int] = []
    logps: tuple[list[float], list[float]] = ([], [])
    track = grammar.track() if grammar else None
    while len(ids) < 80 and not (track and track.done):
        rows = [reference(model, family, one, ids)[-1] for one in (prompt, nothing())]
        scores = decoder.scores(rows[0][None], rows[1][None])
        if track:
            mask = np.zeros((1, (tiny.VOCABULARY + 31) // 32), np.int32)
            track.fill(mask[0])
            scores = scores.masked_fill(~allowed(mask, scores.shape[-1], scores.device), float("-inf"))
        token = int(scores.argmax())
        if token in EOS:
            break
        assert track is None or track.take(token)
        ids.append(token)
        for kept, row in zip(logps, rows, strict=True):
            kept.append(float(row.log_softmax(-1)[token]))
    return ids, *logps


@pytest.mark.parametrize("with_grammar", [False, True])
@pytest.mark.parametrize("decoder", [Cad(alpha=0.3), Cad(alpha=0.7), Cad(alpha=2.0), AdaCad()], ids=repr)
def test_a_trained_model_gives_the_reference_tokens_and_log_probabilities(
    decoder: Decoder, with_grammar: bool, grammar: Grammar
) -> None:
    reports = [prompt for prompt, _, _ in REPORTS[:3]]
    used = grammar if with_grammar else None
    for prompt, answer in zip(reports, answers(reports, decoder, used), strict=True):
        ids, with_context, without_context = plain(prompt, decoder, used)
        assert answer.ids == ids
        np.testing.assert_allclose(answer.with_context, with_context, atol=1e-4)
        np.testing.assert_allclose(answer.without_context, without_context, atol=1e-4)


def test_the_model_reads_words_and_picture(grammar: Grammar) -> None:
    found = answers([prompt for prompt, _, _ in REPORTS], Greedy(), grammar)
    right = [json.loads(grammar.text(a.ids)) == truth for a, (_, _, truth) in zip(found, REPORTS, strict=True)]
    assert sum(right) >= 10


def test_told_facts_are_grounded_and_untold_ones_are_not(grammar: Grammar) -> None:
    told = [prompt for prompt, _, truth in REPORTS if truth["bearing"] in ("S", "W")]
    assert told
    for answer in answers(told, Cad(alpha=0.7), grammar):
        assert _ground(answer, grammar)["bearing"] > 1.0
    for answer in answers([nothing()], Cad(alpha=0.7), grammar):
        assert all(abs(nats) < 1e-3 for nats in _ground(answer, grammar).values())


def _ground(answer: Answer, grammar: Grammar) -> dict[str, float]:
    ends = [len(grammar.bytes(answer.ids[: i + 1])) for i in range(len(answer.ids))]
    return grounding(grammar.text(answer.ids), ends, answer.with_context, answer.without_context)
