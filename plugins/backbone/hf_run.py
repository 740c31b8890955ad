"""A loaded model: from prompts to Generations, with the loop's faults as the project's errors.

A module of its own, so that naming `hf_vision` in a YAML loads no torch. Knows no file.
"""

from __future__ import annotations

import codecs
import dataclasses
import math
import threading
import weakref
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

from plugins.backbone.prompt import EarlierAnswers, Parts, parts, subject, with_previous
from sgcad_core.asking.json_field_spans import field_spans, first_tokens, grounding, is_refusal, name_of
from sgcad_core.case.records import Context, Finding, Generation, Query, Token
from sgcad_core.errors import BadInput, ConfigError, InvalidOutput
from sgcad_core.plugin_calls import fault_of
from sgcad_core.settings import cache_home

if TYPE_CHECKING:
    from plugins.backbone.engine.grammar import Grammar, GrammarCompiler
    from plugins.backbone.engine.records import Answer, Loop, Policy, Prompt
    from plugins.backbone.hf_prompt import Prompter
    from plugins.backbone.llama.pictures import GgufPrompts
    from plugins.backbone.server.pictures import ShownPrompts


@dataclass(frozen=True)
class Call:
    """One question for the loop; `without_context` None: that row is not run."""

    with_context: Parts
    without_context: Parts | None
    schema: Mapping[str, Any] | None
    policy: Policy
    seed: int
    max_new_tokens: int
    draft: Sequence[int]
    truncate: bool
    views: int = 1


@dataclass(frozen=True)
class RunningModel:
    """One model with its token loop, its prompt writer and its grammar compiler."""

    engine: Loop
    prompter: Prompter | ShownPrompts | GgufPrompts
    maker: GrammarCompiler
    eos: frozenset[int]
    name: str
    evidence_heads: Mapping[str, Any] = field(default_factory=dict)
    """Heads of the model's own that say whether the evidence tells a value (`hf_load.Loaded.evidence_heads`)."""

    def answer(self, call: Call) -> tuple[Generation, tuple[int, ...]]:
        """The generation and its token ids. Raises the project's errors, see `HfVision.generate`."""
        from plugins.backbone.engine import faults, records

        try:
            grammar = self._grammar(call.schema)
            (with_context, *views), note = self._fitted(call.with_context, call)
            without = self.prompter.prompt(call.without_context) if call.without_context else None
            request = records.Request(
                with_context,
                without,
                call.policy,
                grammar,
                call.seed,
                call.max_new_tokens,
                self.eos,
                call.draft,
                views=views,
            )
            found = self.engine.generate(request)
        except faults.DoesNotFit as fault:
            finding = Finding(
                source="backbone", what=str(fault), where=fault.path, remedy="answer shorter, or raise max_new_tokens"
            )
            raise InvalidOutput(f"{fault} (at {fault.path})", [finding]) from fault
        except faults.BadLogits as fault:
            raise InvalidOutput(f"{self.name}: {fault}; try dtype bfloat16 or float32") from fault
        except faults.BadScores as fault:
            raise fault_of(call.policy, str(fault)) from fault
        except faults.TooLong as fault:
            raise BadInput(f"{self.name}: {fault}; set backbone.truncate, or lower backbone.max_new_tokens") from fault
        except faults.TooBig as fault:
            raise ConfigError(f"{self.name}: {fault}; use quantization, device_map or a smaller model") from fault
        except faults.EngineFault as fault:
            raise ConfigError(f"{self.name}: {fault}") from fault
        computed = f"computed in {self.engine.computed_in}"
        return self._generation(found, [*self.prompter.notes, *note, computed, *found.notes]), tuple(found.ids)

    def _grammar(self, schema: Mapping[str, Any] | None) -> Grammar | None:
        from plugins.backbone.engine.grammar import collisions

        if schema is None:
            return None
        if wrong := collisions(self.prompter.specials, schema):
            raise ConfigError(
                f"{self.name}: the tokenizer's special tokens {wrong[:5]} are text that the answer must contain, so no "
                "grammar can spell it; rename the fields, or add those tokens as ordinary ones"
            )
        return self.maker.grammar(schema)

    def _fitted(self, parts: Parts, call: Call) -> tuple[list[Prompt], list[str]]:
        """The prompt in its views, and a note if its narrative was cut to the window, which `truncate` allows."""
        room = self.engine.window - call.max_new_tokens
        prompts = self._views(parts, call.views)
        kept = whole = len(parts.narrative)
        while (longest := max(len(prompt.ids) for prompt in prompts)) > room and call.truncate and kept > 0:
            over = (longest - room) / max(1, longest)
            kept = max(0, min(kept - 1, int(kept * (1 - over) * 0.98)))
            prompts = self._views(dataclasses.replace(parts, narrative=parts.narrative[:kept]), call.views)
        if kept == whole:
            return prompts, []
        return prompts, [f"the narrative was cut from {whole} to {kept} characters to fit {self.engine.window} tokens"]

    def _views(self, parts: Parts, count: int) -> list[Prompt]:
        """One prompt for each view; a single one if the model sees no picture."""
        sees = parts.diagrams and self.prompter.loaded.prepare
        return [self.prompter.prompt(parts, view) for view in range(count if sees else 1)]

    def _generation(self, found: Answer, notes: list[str]) -> Generation:
        parts = [bytes(self.maker.tokens.decode_bytes([token])) for token in found.ids]
        text = b"".join(parts)
        ends = list(accumulate(len(part) for part in parts))
        ground = {}
        if found.without_context:
            ground = grounding(text.decode("latin-1"), ends, found.with_context, found.without_context)
        answer = text.decode("utf-8", errors="replace")
        finish = "length" if not found.finished else "refused" if is_refusal(answer) else "stop"
        return Generation.model_validate(
            {
                "text": answer,
                "tokens": self._tokens(parts, found),
                "finish": finish,
                "grounding": ground,
                "conflicts": self._conflicts(text.decode("latin-1"), ends, found),
                "told": self._told(text.decode("latin-1"), ends, found) if found.states else {},
                "prompt_tokens": found.prompt_tokens,
                "model_calls": found.model_calls,
                "seconds": found.seconds,
                "notes": tuple(notes),
            }
        )

    def _told(self, text: str, ends: Sequence[int], found: Answer) -> dict[str, float]:
        """By path: the probability that the evidence tells the value, for chosen values whose field has a head."""
        places = {path: at for path, at in first_tokens(text, ends).items() if not found.forced[at]}
        heads = {path: head for path in places if (head := self.evidence_heads.get(name_of(path))) is not None}
        logits = {path: float(found.states[places[path]] @ head[:-1] + head[-1]) for path, head in heads.items()}
        return {path: 1 / (1 + math.exp(-logit)) for path, logit in logits.items()}

    def _conflicts(self, text: str, ends: Sequence[int], found: Answer) -> list[dict[str, str]]:
        """The tokens at which both rows disagreed, with their fields."""
        spans = field_spans(text)
        begins = [span.start for span in spans]
        told = []
        for place, (evidence, prior) in sorted(found.rivals.items()):
            if place < len(found.ids):
                at = max(bisect_right(begins, max(ends[place] - 1, 0)) - 1, 0)
                words = [self._spelled(token) for token in (evidence, prior, found.ids[place])]
                told.append(
                    dict(zip(("evidence", "prior", "chosen"), words, strict=True))
                    | {"field": spans[at].path if spans else "$"}
                )
        return told

    def _spelled(self, token: int) -> str:
        """A token's text; a part of a character is written as its bytes."""
        return bytes(self.maker.tokens.decode_bytes([token])).decode("utf-8", errors="backslashreplace")

    def _tokens(self, parts: list[bytes], found: Answer) -> tuple[Token, ...]:
        """Token records; a character that several tokens spell counts to the last of them."""
        without: Sequence[float | None] = found.without_context or [None] * len(parts)
        spell = codecs.getincrementaldecoder("utf-8")(errors="replace")
        return tuple(
            Token(
                text=spell.decode(part),
                logp_with_context=with_context,
                logp_without_context=prior,
                forced=forced,
            )
            for part, with_context, prior, forced in zip(parts, found.with_context, without, found.forced, strict=True)
        )


def options(dtype: str, attention: str, device_map: str | dict[str, int | str] | None) -> dict[str, Any]:
    """Arguments of from_pretrained; the dtype "native" is left for `hf_load.load`, which knows the device."""
    import torch

    found: dict[str, Any] = {"dtype": dtype if dtype in ("auto", "native") else getattr(torch, dtype)}
    found["attn_implementation"] = attention
    return found | ({"device_map": device_map} if device_map is not None else {})


_RUNNING: WeakValueDictionary[str, RunningModel] = WeakValueDictionary()
_LOCKS: defaultdict[str, threading.Lock] = defaultdict(threading.Lock)
_LOCKS_LOCK = threading.Lock()


def shared_model(stamp: str, name: str, revision: str | None, settings: Mapping[str, Any], **how: Any) -> RunningModel:
    """The model that runs already under the same options, or a new one (see `start_model`).

    The arms of a study differ in their decoder, not in their model: they share one copy of the weights and its prefix
    cache, and the last user frees both. `stamp` changes if the files of a folder were replaced.
    """
    key = repr((stamp, name, revision, sorted(settings.items()), sorted(how.items())))
    with _LOCKS_LOCK:
        lock = _LOCKS[key]
    with lock:  # loading one model for minutes does not block another
        running = _RUNNING.get(key)
        if running is None or running.engine.ended:
            running = _RUNNING[key] = start_model(name, revision, settings, **how)
            weakref.finalize(running, running.engine.end)
        return running


def answered(
    running: RunningModel, earlier: EarlierAnswers, context: Context, query: Query, prior: Parts | None, **settings: Any
) -> Generation:
    """A query's answer, which a repair goes on from. `prior`: the row without context; `settings`: more of `Call`."""
    about = subject(context, query)
    before, draft = earlier.before(about, query)
    rows = (with_previous(parts(context, query), before), with_previous(prior, before) if prior else None)
    generation, ids = running.answer(Call(*rows, schema=query.answer_schema, draft=draft, **settings))
    earlier.note(about, generation.text, ids)
    return generation


def start_model(
    name: str,
    revision: str | None,
    settings: Mapping[str, Any],
    *,
    device: str,
    quantization: str,
    reports_at_once: int,
    prefix_bytes: int,
    pictures_first: bool,
    adapter: str | None = None,
) -> RunningModel:
    """Loads a model, checks its batching and starts its loop. Raises ConfigError or MissingTool."""
    from plugins.backbone.engine.check import kept_batching
    from plugins.backbone.engine.families import family_of
    from plugins.backbone.engine.faults import EngineFault
    from plugins.backbone.engine.grammar import GrammarCompiler
    from plugins.backbone.engine.loop import engine_of
    from plugins.backbone.hf_load import check_outputs, load
    from plugins.backbone.hf_prompt import Prompter, check_diagram

    loaded = load(name, revision, settings, device, quantization, adapter)
    check_outputs(name, loaded.model, loaded.tokenizer)
    try:
        family = family_of(loaded.model)
        prompter = Prompter(loaded, family, pictures_first)
        picture = prompter.picture(check_diagram()) if loaded.prepare else None
        apart = kept_batching(loaded.model, family, picture, cache_home())
    except EngineFault as fault:
        raise ConfigError(f"backbone.model {name}: {fault}") from fault
    eos = end_tokens(loaded.model.generation_config, loaded.tokenizer)
    vocabulary = int(loaded.model.get_output_embeddings().weight.shape[0])
    maker = GrammarCompiler(loaded.tokenizer, vocabulary, sorted(eos))
    engine = engine_of(loaded.model, family, apart, reports_at_once, prefix_bytes, watched=bool(loaded.evidence_heads))
    return RunningModel(engine, prompter, maker, frozenset(eos), name, loaded.evidence_heads)


def end_tokens(generation_config: Any, tokenizer: Any) -> set[int]:
    """Tokens that end an answer. Raises ConfigError if there are none."""
    found = {tokenizer.eos_token_id}
    told = getattr(generation_config, "eos_token_id", None)
    found |= set(told) if isinstance(told, list) else {told}
    kept = {int(token) for token in found if token is not None}
    if not kept:
        raise ConfigError(
            f"{type(tokenizer).__name__}: neither tokenizer nor generation_config names an end token; set eos_token"
        )
    return kept
