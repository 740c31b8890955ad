"""Contrast of whole answers through text completions: for hosted services that tell no values but those of one text.

    score(y) = (1 + alpha) log p(y | c, x) - alpha log p(y | x)

The service writes several answers under the evidence and tells their log-probabilities; the same answers are scored
behind the prompt without evidence (`echo`); the best is taken. It is context-aware decoding (Shi et al. 2024,
arXiv:2305.14739) applied to answers instead of tokens: the order is that of log p(y|c,x) - a log p(y|x) with
a = alpha / (1 + alpha). What no sample says cannot win. Pictures are not sent. Knows no tokenizer.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

from pydantic import Field

from plugins.backbone.prompt import Parts, parts
from plugins.backbone.server.http import ServerHttp, body_of, defused, said
from sgcad_core.asking.json_field_spans import is_refusal
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import ConfigError, InvalidOutput
from sgcad_core.interfaces import Backbone, Decoder

_PATH = "completions"
_ELSE = "use backbone 'openai_server' (vLLM, SGLang, llama.cpp), 'hf_vision', or decoder 'greedy'"


@dataclass(frozen=True)
class Sample:
    """An answer with its log-probabilities in nats, with the evidence and without it (None: not asked)."""

    text: str
    with_context: float
    without_context: float | None = None

    def score(self, alpha: float) -> float:
        """The contrast of both; that of the evidence alone where the other was not asked."""
        if self.without_context is None:
            return self.with_context
        return (1 + alpha) * self.with_context - alpha * self.without_context


class OpenAISamples(Backbone):
    """Ranks several sampled answers by the contrast of both prompts; refuses services that do not tell what it takes.

    model is the service's name of the model, max_new_tokens the limit of one answer, timeout_s the longest wait for a
    reply, retries the further tries after a fault that may pass.
    """

    gives_logits: ClassVar[bool] = True
    base_url: str = Field("http://localhost:8000/v1", description="up to and with /v1")
    model: str = Field(min_length=1)
    samples: int = Field(8, ge=1, le=128, description="answers that are ranked")
    temperature: float = Field(0.7, gt=0, description="of the samples, where the decoder's is 0")
    api_key_env: str = Field("OPENAI_API_KEY", description="environment variable that holds the key; unset = no key")
    max_new_tokens: int = Field(2048, ge=1)
    schema_mode: Literal["json_schema", "none"] = Field(
        "json_schema", description="whether the service takes a schema as response_format"
    )
    timeout_s: float = Field(300.0, gt=0)
    retries: int = Field(2, ge=0, le=10, description="tries of one question beside the first; a step is repeated too")
    backoff_s: float = Field(1.0, gt=0, description="first wait between tries; doubles")

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """Answers a query.

        Raises ConfigError (the decoder has no alpha, or the service tells no log-probabilities), InvalidOutput (no
        sample is finished) or ServerSilent.
        """
        alpha, prior = self._contrasted(context, query, decoder)
        started = time.perf_counter()
        found = self._sampled(_text(parts(context, query)), query, decoder, seed)
        if prior is not None:
            behind = _text(prior)
            found = [Sample(one.text, one.with_context, self._scored(behind, one.text)) for one in found]
        best = max(found, key=lambda one: one.score(alpha))
        plain = max(found, key=lambda one: one.with_context)
        return Generation(
            text=best.text,
            finish="refused" if is_refusal(best.text) else "stop",
            model_calls=1 + len(found) * (prior is not None),
            seconds=time.perf_counter() - started,
            notes=(*_notes(context), _told(found, alpha, prior is not None, best.text == plain.text)),
        )

    def _contrasted(self, context: Context, query: Query, decoder: Decoder) -> tuple[float, Parts | None]:
        """The strength of the contrast and the prompt without evidence; None where the decoder reads no prior."""
        if not decoder.reads_prior():
            return 0.0, None
        alpha = getattr(decoder, "alpha", None)
        other = decoder.contrast_context(context)
        if not isinstance(alpha, int | float) or (other is not None and other.narrative == context.narrative):
            raise ConfigError(
                f"decoder {type(decoder).__name__} decides token by token or by pictures, which backbone "
                f"'openai_samples' cannot: it ranks whole answers by one alpha; use decoder 'cad', or {_ELSE}"
            )
        return float(alpha), parts(other, query)

    def _sampled(self, prompt: str, query: Query, decoder: Decoder, seed: int) -> list[Sample]:
        body: dict[str, Any] = {
            "prompt": prompt,
            "n": self.samples,
            "max_tokens": self.max_new_tokens,
            "temperature": float(getattr(decoder, "temperature", 0.0)) or self.temperature,
            "logprobs": 1,
            "seed": seed,
        }
        if query.answer_schema is not None and self.schema_mode == "json_schema":
            schema = {"name": "answer", "schema": dict(query.answer_schema)}
            body["response_format"] = {"type": "json_schema", "json_schema": schema}
        choices = [one for one in self._choices(body) if one.get("finish_reason") != "length" and one.get("text")]
        if not choices:
            raise InvalidOutput(
                f"none of {self.samples} answers ended within {self.max_new_tokens} tokens; raise "
                "backbone.max_new_tokens or backbone.samples"
            )
        texts = {str(one["text"]): math.fsum(self._told_of(one, "answer")) for one in choices}
        return [Sample(text, logp) for text, logp in texts.items()]

    def _scored(self, prompt: str, answer: str) -> float:
        """log p(answer | prompt), from the values of a given text behind its prompt."""
        body = {"prompt": prompt + answer, "echo": True, "max_tokens": 0, "logprobs": 1, "temperature": 0.0}
        (choice,) = self._choices(body)
        values = self._told_of(choice, "given text (echo)")
        places = (choice.get("logprobs") or {}).get("text_offset") or []
        if not str(choice.get("text") or "").startswith(prompt) or len(places) != len(values):
            raise ConfigError(
                f"{self._http.url(_PATH)} does not score a given text (echo with text_offset), so log p(y|x) of an "
                f"answer is not known and nothing can be contrasted; {_ELSE}"
            )
        ends = [*places[1:], len(prompt) + len(answer)]
        return math.fsum(value for value, end in zip(values, ends, strict=True) if end > len(prompt))

    def _told_of(self, choice: Mapping[str, Any], what: str) -> list[float]:
        values = (choice.get("logprobs") or {}).get("token_logprobs")
        if not values:
            raise ConfigError(
                f"{self._http.url(_PATH)} tells no log-probabilities of the {what}, which a ranking of answers takes; "
                f"{_ELSE}"
            )
        return [0.0 if value is None else float(value) for value in values]

    def _choices(self, body: Mapping[str, Any]) -> Sequence[dict[str, Any]]:
        response = self._http.post(_PATH, {"model": self.model, **body})
        found = body_of(response, "choices")
        if found is None:
            raise ConfigError(
                f"{self._http.url(_PATH)} answered no completion but {said(response)}; mend backbone.base_url"
            )
        choices: list[dict[str, Any]] = found["choices"]
        return choices

    @cached_property
    def _http(self) -> ServerHttp:
        remedies = {
            403: f"use a key that may call {self.model!r}",
            404: f"the service has no text completions, or no model {self.model!r}; {_ELSE}",
            413: "the prompt is too long for the service",
            400: f"it may take no echo, no logprobs or no schema (backbone.schema_mode none); else {_ELSE}",
        }
        return ServerHttp(self.base_url, self.api_key_env, self.timeout_s, self.retries, self.backoff_s, remedies)


def _text(known: Parts) -> str:
    """A plain prompt: completions have no turns."""
    evidence = [defused(text) for text in (known.narrative, known.repair) if text]
    return "\n\n".join([known.shared, *evidence, "Answer:\n"])


def _notes(context: Context) -> tuple[str, ...]:
    return ("the model is shown no pictures: diagrams are left out",) if context.diagrams else ()


def _told(found: Sequence[Sample], alpha: float, contrasted: bool, same: bool) -> str:
    """What was ranked, in words."""
    if not contrasted:
        return f"the likeliest of {len(found)} different answers"
    kept = "the likeliest of them" if same else "not the likeliest of them"
    return f"the best of {len(found)} different answers under contrast of whole answers (alpha {alpha:g}), {kept}"
