"""Any server that speaks OpenAI's chat completions: vLLM, llama.cpp, Ollama, SGLang, OpenAI itself.

The diagram is sent as a data URL, the answer's JSON schema as `response_format`. Such a server gives no logits of the
whole vocabulary, so contrastive decoders are refused before anything starts. Knows no model; the writer checks whether
the answer keeps the schema.
"""

from __future__ import annotations

import base64
import re
import time
from functools import cached_property
from typing import Any, ClassVar, Literal, NoReturn

import httpx
from pydantic import Field

from plugins.backbone.prompt import parts
from sgcad_core import settings
from sgcad_core.asking.json_field_spans import is_refusal
from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.errors import ConfigError, InvalidOutput, Refused, ServerSilent
from sgcad_core.interfaces import Backbone, Decoder

_RETRIED = frozenset({408, 409, 425, 429})
_LONGEST_WAIT_S = 60.0

_SPECIAL = re.compile(
    r"<\|[^<>|\n]{1,40}\|>|\[/?(?:INST|AVAILABLE_TOOLS|TOOL_CALLS|TOOL_RESULTS|IMG)\]|<</?SYS>>"
    r"|</?(?:s|bos|eos|pad|unk|mask|image|img|video|think|tool_call|tool_response|start_of_turn|end_of_turn"
    r"|start_of_image|end_of_image|fim_\w+)>",
    re.IGNORECASE,
)
"""Forms in which models write the ends of turns, pictures and tools."""


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
                "'greedy', or backbone 'hf_vision'"
            )
        started = time.perf_counter()
        body = self._post(self._request(context, query, decoder, seed))
        text, usage = self._answer(body)
        return Generation(
            text=text,
            finish="refused" if is_refusal(text) else "stop",
            prompt_tokens=int(usage.get("prompt_tokens") or 0),
            model_calls=1,
            seconds=time.perf_counter() - started,
        )

    @cached_property
    def _client(self) -> httpx.Client:
        key = settings.environment(self.api_key_env)
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        return httpx.Client(timeout=self.timeout_s, headers=headers)

    @property
    def _url(self) -> str:
        return f"{self.base_url.rstrip('/')}/chat/completions"

    def _request(self, context: Context, query: Query, decoder: Decoder, seed: int) -> dict[str, Any]:
        known = parts(context, query)
        content: list[dict[str, Any]] = [{"type": "text", "text": known.shared}]
        content += [_picture(diagram.png) for diagram in known.diagrams]
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

    def _post(self, request: dict[str, Any]) -> dict[str, Any]:
        last = ""
        for number in range(self.retries + 1):
            if number:
                time.sleep(min(self.backoff_s * 2 ** (number - 1), _LONGEST_WAIT_S))
            try:
                response = self._client.post(self._url, json=request)
            except httpx.TransportError as fault:
                last = f"{type(fault).__name__}: {fault}"
                continue
            if response.status_code < 400:
                return self._body(response)
            last = f"HTTP {response.status_code}: {_said(response)}"
            if response.status_code < 500 and response.status_code not in _RETRIED:
                self._reject(response)
            self._wait_as_told(response)
        raise ServerSilent(
            f"{self._url} gave no answer in {self.retries + 1} tries, at last {last}; start the server, mend "
            "backbone.base_url, or raise backbone.retries"
        )

    def _wait_as_told(self, response: httpx.Response) -> None:
        told = response.headers.get("Retry-After", "")
        if told.isdigit():
            time.sleep(min(float(told), _LONGEST_WAIT_S))

    def _reject(self, response: httpx.Response) -> NoReturn:
        remedy = {
            401: f"set the environment variable {self.api_key_env} to a valid key",
            403: f"use a key that may call {self.model!r}",
            404: "mend backbone.base_url (it ends in /v1) or backbone.model",
            413: "the prompt is too long for the server",
            422: "try backbone.schema_mode json_object or none",
            400: "shorten the prompt, or try backbone.schema_mode json_object or none",
        }.get(response.status_code, "see the server's log")
        raise ConfigError(f"{self._url} refused the request: HTTP {response.status_code}: {_said(response)}; {remedy}")

    def _body(self, response: httpx.Response) -> dict[str, Any]:
        try:
            body = response.json()
        except ValueError:
            body = None
        if not isinstance(body, dict) or not body.get("choices"):
            raise ConfigError(f"{self._url} answered no chat completion but {_said(response)}; mend backbone.base_url")
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


def defused(text: str) -> str:
    """Evidence in which a space breaks up each word that a server could take for a special token.

    Servers do not list their special tokens, so all common forms count: <|...|>, <s>, </s>, [INST], <<SYS>>,
    <start_of_turn>, <image>, <think> and their ends.
    """
    return _SPECIAL.sub(lambda found: f"{found[0][0]} {found[0][1:]}", text)


def _picture(png: bytes) -> dict[str, Any]:
    url = f"data:image/png;base64,{base64.b64encode(png).decode()}"
    return {"type": "image_url", "image_url": {"url": url}}


def _said(response: httpx.Response) -> str:
    return " ".join(response.text.split())[:300] or "(empty body)"
