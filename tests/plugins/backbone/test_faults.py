"""Whose fault costs what: a decoder's, a model's, a grammar's or a caller's costs that report and no other."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
import torch
import transformers as tf

from plugins.backbone.engine.families import Family, family_of
from plugins.backbone.engine.faults import BadLogits, BadScores, EngineFault, TooBig
from plugins.backbone.engine.grammar import Grammar, GrammarCompiler, GrammarState
from plugins.backbone.engine.loop import engine_of
from plugins.backbone.engine.records import Answer, Prompt, Request
from plugins.decoder.cad import Cad
from plugins.decoder.greedy import Greedy
from plugins.decoder.nucleus import Nucleus
from sgcad_core.errors import PluginFault
from sgcad_core.interfaces import Decoder
from tests.plugins.backbone import tiny

EOS = frozenset({2})
POISON = 277
WAIT_S = 120.0


class Touchy(tf.LlamaForCausalLM):
    """Raises for one token, and runs out of memory as often as it is told to."""

    cramped = 0
    fault: BaseException | None = None

    def forward(self, input_ids: Any = None, **kwargs: Any) -> Any:
        if self.cramped:
            self.cramped -= 1
            raise torch.OutOfMemoryError("CUDA out of memory")
        if self.fault and bool((input_ids == POISON).any()):
            raise self.fault
        return super().forward(input_ids=input_ids, **kwargs)


class After(Greedy):
    """Greedy for two tokens; then `bad` answers in its place."""

    bad: Callable[[torch.Tensor], Any]
    seen: list[int]

    def scores(self, with_context: Any, without_context: Any | None) -> Any:
        self.seen.append(1)
        return self.bad(with_context) if len(self.seen) > 2 else with_context


def touchy() -> tuple[Any, Family]:
    torch.manual_seed(0)
    model = Touchy(tf.LlamaConfig(**tiny._TEXT)).eval()
    return model, family_of(model)


def request(family: Family, seed: int, decoder: Decoder | None = None, tokens: int = 10, **fields: Any) -> Request:
    with_, without = tiny.prompts("text_only", family, seed)
    return Request(with_, without, decoder or Cad(), fields.pop("grammar", None), seed, tokens, EOS, **fields)


def alone(model: Any, family: Family, one: Request) -> Answer:
    engine = engine_of(model, family, prefix_bytes=0)
    answer = engine.generate(one)
    engine.close()
    return answer


def grammar() -> Grammar:
    return GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2]).grammar(tiny.SCHEMA)


def _raise(rows: torch.Tensor) -> Any:
    raise ZeroDivisionError("a bug in a plugin")


BAD: dict[str, tuple[Callable[[torch.Tensor], Any], type[Exception], str]] = {
    "raises": (_raise, PluginFault, "decoder 'After' .*: scores raised ZeroDivisionError: a bug in a plugin"),
    "nan": (lambda rows: rows * math.nan, BadScores, "scores are NaN or inf behind token 2"),
    "inf": (lambda rows: rows + math.inf, BadScores, "scores are NaN or inf"),
    "shape": (lambda rows: rows[0], BadScores, r"float32 \(300,\) on cpu, expected float logits \(1, 300\) on cpu"),
    "nothing": (lambda rows: None, BadScores, "scores are None, expected float logits"),
}


@pytest.mark.parametrize("how", list(BAD))
def test_a_decoder_that_goes_wrong_costs_its_own_report_alone(how: str) -> None:
    bad, kind, said = BAD[how]
    model, family = tiny.build("text_only")
    good = [request(family, seed) for seed in range(3)]
    engine = engine_of(model, family)
    futures = [engine.submit(one) for one in (good[0], request(family, 9, After(bad=bad, seen=[])), *good[1:])]
    with pytest.raises(kind, match=said):
        futures.pop(1).result(WAIT_S)
    for future, one in zip(futures, good, strict=True):
        assert future.result(WAIT_S).ids == alone(model, family, one).ids
    assert engine.generate(good[0]).ids == alone(model, family, good[0]).ids
    assert all(lane.rows == [] for lane in engine.runner.lanes.values())


@pytest.mark.parametrize("drawn", [torch.tensor([0.5]), torch.tensor([1, 2]), torch.tensor([300]), 7], ids=repr)
def test_a_draw_that_is_no_token_is_named_and_costs_its_own_report_alone(drawn: Any) -> None:
    class Odd(Greedy):
        def draw(self, scores: Any, generator: Any) -> Any:
            return drawn

    model, family = tiny.build("text_only")
    engine = engine_of(model, family)
    futures = [engine.submit(request(family, 0, Odd())), engine.submit(request(family, 1))]
    with pytest.raises(BadScores, match=r"draw gave|outside the vocabulary"):
        futures[0].result(WAIT_S)
    assert futures[1].result(WAIT_S).ids


def test_a_decoder_that_writes_into_its_rows_does_not_change_the_log_probabilities() -> None:
    class Writes(Cad):
        def scores(self, with_context: Any, without_context: Any | None) -> Any:
            found = super().scores(with_context, without_context)
            with_context.zero_()
            return found

    model, family = tiny.build("text_only")
    answers = [alone(model, family, request(family, 0, kind())) for kind in (Cad, Writes)]
    assert answers[0].ids == answers[1].ids
    assert answers[0].with_context == answers[1].with_context


def test_where_a_decoder_excludes_every_token_the_most_likely_with_context_is_taken() -> None:
    class Excludes(Greedy):
        def scores(self, with_context: Any, without_context: Any | None) -> Any:
            return with_context.fill_(-math.inf)

    model, family = tiny.build("text_only")
    for rules in (None, grammar()):
        found = [alone(model, family, request(family, 0, d, 90, grammar=rules)).ids for d in (Excludes(), Greedy())]
        assert found[0] == found[1]


def test_a_model_that_raises_on_one_report_answers_the_others_one_by_one() -> None:
    model, family = touchy()
    good = [request(family, seed) for seed in range(3)]
    expected = [alone(model, family, one).ids for one in good]
    model.fault = RuntimeError("shapes do not match")
    ends_in_it = Prompt([*good[0].with_context.ids, POISON])  # its last token goes through the shared step
    begins_with_it = Prompt([POISON, *good[0].with_context.ids])  # this one through a prefill of its own
    engine = engine_of(model, family)
    bad = [Request(prompt, None, Greedy(), None, 0, 10, EOS) for prompt in (ends_in_it, begins_with_it)]
    futures = [engine.submit(one) for one in (good[0], *bad, *good[1:])]
    for future in (futures.pop(1), futures.pop(1)):
        with pytest.raises(RuntimeError, match="shapes do not match"):
            future.result(WAIT_S)
    assert [future.result(WAIT_S).ids for future in futures] == expected
    assert engine.halved == 0
    assert engine.generate(good[1]).ids == expected[1]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_what_no_boundary_may_catch_ends_the_loop_and_every_wait() -> None:
    class Broken(BaseException):
        """As a panic of a library written in Rust arrives."""

    model, family = touchy()
    model.fault = Broken("panic")
    engine = engine_of(model, family)
    future = engine.submit(Request(Prompt([5, POISON]), None, Greedy(), None, 0, 10, EOS))
    with pytest.raises(EngineFault, match="closed before this report was answered: Broken: panic"):
        future.result(WAIT_S)
    assert engine.thread
    engine.thread.join(WAIT_S)
    with pytest.raises(EngineFault, match="the engine is closed: Broken: panic"):
        engine.submit(request(family, 0))


def test_a_grammar_that_raises_costs_its_own_report_alone() -> None:
    class Breaks(GrammarState):
        def fill(self, row: Any) -> None:
            raise ValueError("the matcher is in an error state")

    class Bad(Grammar):
        def track(self) -> GrammarState:
            return Breaks(self)

    model, family = tiny.build("text_only")
    engine = engine_of(model, family)
    bad = Bad(GrammarCompiler(tiny.tokenizer(), tiny.VOCABULARY, [2]), tiny.SCHEMA)
    futures = [engine.submit(request(family, i, grammar=g, tokens=90)) for i, g in enumerate((bad, grammar()))]
    with pytest.raises(ValueError, match="the matcher is in an error state"):
        futures[0].result(WAIT_S)
    assert futures[1].result(WAIT_S).finished


def test_a_cancelled_report_leaves_and_the_others_stay() -> None:
    model, family = tiny.build("text_only")
    good = [request(family, seed, tokens=30) for seed in range(3)]
    engine = engine_of(model, family, reports_at_once=2)
    endless = [engine.submit(request(family, 5, Greedy(), tokens=900)) for _ in range(3)]
    futures = [engine.submit(one) for one in good]
    for future in endless:  # one or two of them run, the rest wait
        future.cancel()
    assert [future.result(WAIT_S).ids for future in futures] == [alone(model, family, one).ids for one in good]
    assert all(future.done() for future in endless)
    assert engine.jobs == []


def test_bad_logits_of_one_report_leave_the_others_their_answers() -> None:
    model, family = tiny.build("text_only")
    with torch.no_grad():
        model.model.embed_tokens.weight[POISON] = math.nan
    clean = Request(Prompt(tiny.words(9, 1)), None, Greedy(), None, 0, 10, EOS)
    engine = engine_of(model, family)
    bad = engine.submit(Request(Prompt([5, POISON, 6]), None, Greedy(), None, 0, 10, EOS))
    good = engine.submit(clean)
    with pytest.raises(BadLogits, match="the model gave NaN or inf behind token 0"):
        bad.result(WAIT_S)
    assert good.result(WAIT_S).ids == alone(model, family, clean).ids


# ------------------------------------------------------------------ memory
def test_a_single_report_is_tried_again_with_the_caches_emptied_before_it_is_given_up() -> None:
    model, family = touchy()
    expected = alone(model, family, request(family, 0)).ids
    engine = engine_of(model, family)
    assert engine.generate(request(family, 0)).ids == expected
    model.cramped = 1
    assert engine.generate(request(family, 0)).ids == expected
    model.cramped = 2
    with pytest.raises(TooBig, match="one report alone"):
        engine.generate(request(family, 0))


def test_memory_running_out_while_a_draft_is_checked_takes_back_only_what_the_grammar_took() -> None:
    model, family = touchy()
    rules = grammar()
    plain = alone(model, family, request(family, 1, tokens=90, grammar=rules))
    again = request(family, 1, tokens=90, grammar=rules, draft=plain.ids)
    for first in range(3, 6):  # the steps behind the two prefills
        engine = engine_of(model, family)
        steps = iter(range(99))
        whole = engine.runner.step

        def step(*told: Any, one: int = first, count: Any = steps, real: Any = whole) -> Any:
            if next(count) == one - 3:
                model.cramped = 1
            return real(*told)

        engine.runner.step = step  # type: ignore[method-assign]
        found = engine.generate(again)
        assert found.ids == plain.ids
        assert found.with_context == pytest.approx(plain.with_context, abs=1e-4)


# ------------------------------------------------------------------ random numbers
def test_neither_draft_nor_jump_forward_nor_the_reports_beside_it_change_what_is_drawn() -> None:
    model, family = tiny.build("text_only")
    rules = grammar()
    decoder = Cad(temperature=1.2)
    plain = alone(model, family, request(family, 3, decoder, 90, grammar=rules))
    wrong = [token if i % 5 else 40 for i, token in enumerate(plain.ids)]
    for draft in (plain.ids, wrong, [2, *plain.ids, 2]):
        assert alone(model, family, request(family, 3, decoder, 90, grammar=rules, draft=draft)).ids == plain.ids
    stepped = alone(model, family, request(family, 3, decoder, 90, grammar=rules, jump_forward=False))
    assert stepped.ids == plain.ids
    engine = engine_of(model, family)
    beside = [engine.submit(request(family, seed, Nucleus(temperature=2.0), 40)) for seed in (7, 8)]
    assert engine.generate(request(family, 3, decoder, 90, grammar=rules, draft=wrong)).ids == plain.ids
    assert all(future.result(WAIT_S) for future in beside)


def test_every_place_and_every_seed_draws_anew() -> None:
    model, family = tiny.build("text_only")
    flat = Nucleus(temperature=5.0, top_p=1.0)
    with_, _ = tiny.prompts("text_only", family, 0)
    found = [alone(model, family, Request(with_, None, flat, None, seed, 30, EOS)).ids for seed in (1, 1, 2)]
    assert found[0] == found[1]
    assert found[0] != found[2]
    assert len(set(found[0])) > 10


def test_a_draft_with_an_end_token_inside_does_not_run_past_the_end() -> None:
    model, family = tiny.build("text_only")
    with_, without = tiny.prompts("text_only", family, 0)
    free = alone(model, family, Request(with_, without, Cad(), None, 0, 12, frozenset()))
    end = frozenset({free.ids[6]})
    stop = free.ids.index(free.ids[6])
    found = alone(model, family, Request(with_, without, Cad(), None, 0, 12, end, draft=free.ids))
    assert found.ids == free.ids[:stop]
    assert found.finished


# ------------------------------------------------------------------ rows that come and go
def test_a_report_of_two_pictures_leaves_nothing_to_one_of_one_picture() -> None:
    model, family = tiny.build("mllama")
    first, second = tiny.picture("mllama", 0), tiny.picture("mllama", 1)
    task, rest = tiny.words(8, 1), tiny.words(5, 2)
    two = Prompt([*task, tiny.IMAGE_TOKEN, *rest, tiny.IMAGE_TOKEN, *rest], [first, second])
    one = Prompt([*task, tiny.IMAGE_TOKEN, *rest], [second])
    requests = [
        Request(prompt, Prompt(task), Cad(), None, 0, tokens, EOS) for prompt, tokens in ((two, 5), (one, 14), (one, 8))
    ]
    engine = engine_of(model, family, apart=True)
    futures = [engine.submit(one) for one in requests[:2]]
    found = [future.result(WAIT_S).ids for future in futures] + [engine.generate(requests[2]).ids]
    for ids, one_request in zip(found, requests, strict=True):
        fresh = engine_of(model, family, apart=True, prefix_bytes=0)
        assert ids == fresh.generate(one_request).ids
