"""Requests to a model's server: JSON over HTTP, retried where a fault may pass, its refusals told with their remedy.

Knows no protocol: the caller gives path and body and reads the answer. Also holds the texts' and pictures' forms that
all servers share.
"""

from __future__ import annotations

import base64
import re
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NoReturn

import httpx

from sgcad_core import settings
from sgcad_core.errors import ConfigError, ServerSilent

_RETRIED = frozenset({408, 409, 425, 429})
_LONGEST_WAIT_S = 60.0

_SPECIAL = re.compile(
    r"<\|[^<>|\n]{1,40}\|>|\[/?(?:INST|AVAILABLE_TOOLS|TOOL_CALLS|TOOL_RESULTS|IMG)\]|<</?SYS>>"
    r"|</?(?:s|bos|eos|pad|unk|mask|image|img|video|think|tool_call|tool_response|start_of_turn|end_of_turn"
    r"|start_of_image|end_of_image|fim_\w+)>",
    re.IGNORECASE,
)
"""Forms in which models write the ends of turns, pictures and tools."""


@dataclass
class ServerHttp:
    """One server. `base_url` is where paths are joined to; waits double from `backoff_s` to a minute.

    `sent` counts requests that were answered.
    """

    base_url: str
    api_key_env: str = "OPENAI_API_KEY"
    timeout_s: float = 300.0
    retries: int = 2
    backoff_s: float = 1.0
    remedies: Mapping[int, str] = field(default_factory=dict)
    """By status: what mends a request that the server rejects."""
    sent: int = 0

    @cached_property
    def client(self) -> httpx.Client:
        """The open connections, with the key if its variable is set."""
        key = settings.environment(self.api_key_env)
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        return httpx.Client(timeout=self.timeout_s, headers=headers)

    def url(self, path: str) -> str:
        """The address of a path."""
        return f"{self.base_url.rstrip('/')}/{path.lstrip('/')}"

    def post(self, path: str, body: Mapping[str, Any]) -> httpx.Response:
        """The response to a JSON body. Raises ConfigError (rejected) or ServerSilent (no answer after all tries)."""
        return self._ask("POST", path, body)

    def get(self, path: str) -> httpx.Response:
        """The response of a page. Raises as `post`."""
        return self._ask("GET", path, None)

    def status_of(self, path: str, body: Mapping[str, Any]) -> httpx.Response:
        """The response whatever its status, asked once: for a question whose refusal is an answer too."""
        try:
            return self.client.post(self.url(path), json=body)
        except httpx.TransportError as fault:
            raise self._silent(path, 1, f"{type(fault).__name__}: {fault}") from fault

    def _ask(self, method: str, path: str, body: Mapping[str, Any] | None) -> httpx.Response:
        last = ""
        for number in range(self.retries + 1):
            if number:
                time.sleep(min(self.backoff_s * 2 ** (number - 1), _LONGEST_WAIT_S))
            try:
                response = self.client.request(method, self.url(path), json=body)
            except httpx.TransportError as fault:
                last = f"{type(fault).__name__}: {fault}"
                continue
            if response.status_code < 400:
                self.sent += 1
                return response
            last = f"HTTP {response.status_code}: {said(response)}"
            if response.status_code < 500 and response.status_code not in _RETRIED:
                self._reject(path, response)
            _wait_as_told(response)
        raise self._silent(path, self.retries + 1, last)

    def _silent(self, path: str, tries: int, last: str) -> ServerSilent:
        return ServerSilent(
            f"{self.url(path)} gave no answer in {tries} tries, at last {last}; start the server, mend "
            "backbone.base_url, or raise backbone.retries"
        )

    def _reject(self, path: str, response: httpx.Response) -> NoReturn:
        own = {401: f"set the environment variable {self.api_key_env} to a valid key"}
        remedy = {**own, **self.remedies}.get(response.status_code, "see the server's log")
        raise ConfigError(
            f"{self.url(path)} refused the request: HTTP {response.status_code}: {said(response)}; {remedy}"
        )


def _wait_as_told(response: httpx.Response) -> None:
    told = response.headers.get("Retry-After", "")
    if told.isdigit():
        time.sleep(min(float(told), _LONGEST_WAIT_S))


def said(response: httpx.Response) -> str:
    """The beginning of a body, for a message."""
    return " ".join(response.text.split())[:300] or "(empty body)"


def body_of(response: httpx.Response, *keys: str) -> dict[str, Any] | None:
    """The JSON object of a response, None if it is none or one of the keys is missing or empty."""
    try:
        body = response.json()
    except ValueError:
        return None
    return body if isinstance(body, dict) and all(body.get(key) for key in keys) else None


def defused(text: str) -> str:
    """Evidence in which a space breaks up each word that a server could take for a special token.

    Servers do not list their special tokens, so all common forms count: <|...|>, <s>, </s>, [INST], <<SYS>>,
    <start_of_turn>, <image>, <think> and their ends.
    """
    return _SPECIAL.sub(lambda found: f"{found[0][0]} {found[0][1:]}", text)


def data_url(png: bytes) -> str:
    """A picture as a data URL."""
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"


def listed(http: ServerHttp, model: str) -> tuple[str, int | None]:
    """The server's name of a model and its window, from /v1/models. Raises ConfigError if it has no such model."""
    response = http.get("v1/models")
    found = body_of(response, "data")
    if found is None:
        raise ConfigError(f"{http.url('v1/models')} lists no models but {said(response)}; mend backbone.base_url")
    names = {str(one.get("id")): one for one in found["data"]}
    if model not in names:
        raise ConfigError(
            f"backbone.model {model!r}: the server at {http.base_url} has {', '.join(names)}; use that name"
        )
    meta = names[model].get("meta") or {}
    window = names[model].get("max_model_len") or meta.get("n_ctx") or meta.get("n_ctx_train")
    return model, int(window) if window else None


def tokenized(http: ServerHttp, body: Mapping[str, Any]) -> list[int] | None:
    """A text's tokens by the page /tokenize; None if the server has no such page."""
    found = body_of(http.status_of("tokenize", body), "tokens")
    return [int(token) for token in found["tokens"]] if found else None
