"""Any server that speaks OpenAI's chat completions: vLLM, llama.cpp, Ollama, SGLang, OpenAI itself.

The diagram is sent as a data URL, the answer's JSON schema as `response_format`. Chat completions score
no given answer, so contrastive decoders are refused before anything starts: `openai_server` has them. Knows no model;
the writer checks whether the answer keeps the schema.
"""

from __future__ import annotations

import time
from functools import cached_property
from typing import Any, ClassVar, Literal

import httpx
from pydantic import Field

from plugins.backbone.prompt import parts
from plugins.backbone.server.http import ServerHttp, body_of, data_url, defused, said
from sgcad_core.asking.json_field_spans import is_refusal
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import ConfigError, InvalidOutput, Refused
from sgcad_core.interfaces import Backbone, Decoder

_PATH = "chat/completions"


class OpenAIChat(Backbone):
    """Asks a server with OpenAI's chat completions, one request for each query; retries faults that may pass.

    model is the server's name of the model, max_new_tokens the limit of one answer, timeout_s the longest wait for a
    reply, retries the further tries after a fault that may pass.
    """

    gives_logits: ClassVar[bool] = False
    base_url: str = Field("http://localhost:8000/v1", description="up to and with /v1")
    model: str = Field(min_length=1)
    api_key_env: str = Field("OPENAI_API_KEY", description="environment variable that holds the key; unset = no key")
    max_new_tokens: int = Field(4096, ge=1)
    timeout_s: float = Field(300.0, gt=0)
    retries: int = Field(2, ge=0, le=10, description="tries of one question beside the first; a step is repeated too")
    backoff_s: float = Field(1.0, gt=0, description="first wait between tries; doubles")
    schema_mode: Literal["json_schema", "json_object", "none"] = Field(
        "json_schema", description="what the server understands of response_format"
    )

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """Asks the server.

        Raises InvalidOutput for an answer that is empty or cut off, Refused where the model declines,
        ConfigError for a request that the server rejects, ServerSilent where no server answers.
        """
        if decoder.needs_prior:
            raise ConfigError(
                f"decoder {type(decoder).__name__} needs logits; backbone 'openai_chat' gives none: use decoder "
                "'greedy', backbone 'hf_vision', or backbone 'openai_server' where the server is vLLM, SGLang or "
                "llama.cpp"
            )
        started = time.perf_counter()
        body = self._body(self._http.post(_PATH, self._request(context, query, decoder, seed)))
        text, usage = self._answer(body)
        return Generation(
            text=text,
            finish="refused" if is_refusal(text) else "stop",
            prompt_tokens=int(usage.get("prompt_tokens") or 0),
            model_calls=1,
            seconds=time.perf_counter() - started,
        )

    @cached_property
    def _http(self) -> ServerHttp:
        remedies = {
            403: f"use a key that may call {self.model!r}",
            404: "mend backbone.base_url (it ends in /v1) or backbone.model",
            413: "the prompt is too long for the server",
            422: "try backbone.schema_mode json_object or none",
            400: "shorten the prompt, or try backbone.schema_mode json_object or none",
        }
        return ServerHttp(self.base_url, self.api_key_env, self.timeout_s, self.retries, self.backoff_s, remedies)

    def _request(self, context: Context, query: Query, decoder: Decoder, seed: int) -> dict[str, Any]:
        known = parts(context, query)
        content: list[dict[str, Any]] = [{"type": "text", "text": known.shared}]
        content += [{"type": "image_url", "image_url": {"url": data_url(d.png)}} for d in known.diagrams]
        content += [{"type": "text", "text": defused(text)} for text in (known.narrative, known.repair) if text]
        request: dict[str, Any] = {
            "model": self.model,
            "messages": [{"role": "user", "content": content}],
            "max_tokens": self.max_new_tokens,
            "temperature": float(getattr(decoder, "temperature", 0.0)),
            "top_p": float(getattr(decoder, "top_p", 1.0)),
            "seed": seed,
        }
        if query.answer_schema is not None and self.schema_mode == "json_schema":
            schema = {"name": "answer", "schema": dict(query.answer_schema)}
            request["response_format"] = {"type": "json_schema", "json_schema": schema}
        elif query.answer_schema is not None and self.schema_mode == "json_object":
            request["response_format"] = {"type": "json_object"}
        return request

    def _body(self, response: httpx.Response) -> dict[str, Any]:
        body = body_of(response, "choices")
        if body is None:
            raise ConfigError(
                f"{self._http.url(_PATH)} answered no chat completion but {said(response)}; mend backbone.base_url"
            )
        return body

    def _answer(self, body: dict[str, Any]) -> tuple[str, dict[str, Any]]:
        choice = body["choices"][0]
        message = choice.get("message") or {}
        text = message.get("content") or ""
        if message.get("refusal"):
            raise Refused(f"the model declined: {message['refusal']}")
        if choice.get("finish_reason") == "content_filter":
            raise Refused("the server's content filter held the answer back")
        if choice.get("finish_reason") == "length":
            raise InvalidOutput(
                f"the answer was cut off after {self.max_new_tokens} tokens; raise backbone.max_new_tokens"
            )
        if not text.strip():
            raise InvalidOutput(f"the server answered nothing (finish_reason {choice.get('finish_reason')!r})")
        return text, body.get("usage") or {}
