"""vLLM's completions: prompts as token ids, `prompt_logprobs` for a given text, `structured_outputs` for drafts.

The server's limit of the top k is its option --max-logprobs (20 unless set, -1 the whole vocabulary). A request with
prompt_logprobs does not read the server's prefix cache: it computes its prompt again. Pictures need the server's
scale-out pages (VLLM_ENABLE_SCALE_OUT_ENDPOINTS=1), which render a chat into token ids with features and take both
back.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from plugins.backbone.server.http import ServerHttp, body_of, said
from plugins.backbone.server.pictures import Content, Shown, sampling
from plugins.backbone.server.protocol import Offer, Schema, Speaker, Top
from sgcad_core.errors import ConfigError

_LIMITS = (5000, 1000, 500, 200, 100, 50, 20, 10, 5, 1)
_ALLOWED = re.compile(r"max(?:imum)? allowed:? (\d+)")
_RENDER, _GENERATE = "v1/chat/completions/render", "inference/v1/generate"
_TOKEN_ID = "token_id:"  # noqa: S105 - vLLM's spelling of a token's number


class Vllm(Speaker):
    """Speaks to one vLLM server."""

    named = 0  # each value by name takes a prompt of its own, computed from its beginning

    def __init__(self, http: ServerHttp, model: str) -> None:
        self.http = http
        self.model = model

    def offer(self) -> Offer:
        """Asks for the model's name and window, then for prompt log-probabilities with ever smaller k."""
        name, window = listed(self.http, self.model)
        return Offer(name, window, self._most())

    def spelled(self, text: str) -> list[int] | None:
        """Tokens by the page /tokenize."""
        return tokenized(self.http, {"model": self.model, "prompt": text, "add_special_tokens": False})

    def draft(self, prompt: Sequence[int], behind: Sequence[int], limit: int, schema: Schema) -> list[int]:
        """Greedy tokens, at the start of an answer guided by the schema in compact JSON."""
        body: dict[str, Any] = {}
        if schema is not None and not behind:
            body["structured_outputs"] = {"json": dict(schema), "disable_any_whitespace": True}
        if isinstance(prompt, Shown):
            return [
                int(token) for token in self._seen(prompt, behind, sampling(limit, body))["choices"][0]["token_ids"]
            ]
        body |= {"max_tokens": limit, "return_token_ids": True}
        (choice,) = self._choices([[*prompt, *behind]], body)
        if (ids := choice.get("token_ids")) is None:
            raise ConfigError(
                f"{self.http.url('v1/completions')} returned no token_ids though return_token_ids was set; use vLLM "
                "0.10.2 or newer, or backbone 'hf_vision'"
            )
        return [int(token) for token in ids]

    def tops(self, prompt: Sequence[int], behind: Sequence[int], count: int, top: int) -> list[Top]:
        """One request: the last `count` - 1 tokens by prompt_logprobs, the next one by logprobs."""
        return self.tops_of([prompt], behind, count, top)[0]

    def tops_of(self, prompts: Sequence[Sequence[int]], behind: Sequence[int], count: int, top: int) -> list[list[Top]]:
        """One request with a prompt for each row; a row that sees pictures has a request of its own."""
        if any(isinstance(prompt, Shown) for prompt in prompts) and len(prompts) > 1:
            return super().tops_of(prompts, behind, count, top)
        if isinstance(prompts[0], Shown):
            return [self._seen_tops(prompts[0], behind, count, top)]
        asked = {"max_tokens": 1, "logprobs": top, "return_tokens_as_token_ids": True}
        if count > 1:
            asked["prompt_logprobs"] = top
        choices = self._choices([[*prompt, *behind] for prompt in prompts], asked)
        return [self._told(choice, count, top) for choice in choices]

    def _told(self, choice: Mapping[str, Any], count: int, top: int) -> list[Top]:
        places = (choice.get("prompt_logprobs") or [])[1 - count :] if count > 1 else []
        if len(places) != count - 1 or None in places:
            raise ConfigError(self._without("gave no prompt_logprobs"))
        return [*(Top.of(_pairs(place), top) for place in places), self._next(choice, top)]

    def exact(self, prompt: Sequence[int], behind: Sequence[int], tokens: Sequence[int]) -> dict[int, float]:
        """One request with a prompt for each token: prompt_logprobs tell the token that stands there, whatever k."""
        known = [*prompt, *behind]
        if isinstance(prompt, Shown):
            return {token: self._seen_tops(prompt, [*behind, token], 2, 1)[0].known[token] for token in tokens}
        choices = self._choices([[*known, token] for token in tokens], {"max_tokens": 1, "prompt_logprobs": 1})
        last = [dict(_pairs(choice["prompt_logprobs"][-1])) for choice in choices]
        return {token: last[i][token] for i, token in enumerate(tokens)}

    # ------------------------------------------------------------------ pictures
    def shown(self, content: Content) -> Shown:
        """A user's turn with its pictures, rendered by the server. Raises ConfigError where it has no such page."""
        body = {
            "model": self.model,
            "messages": [{"role": "user", "content": content}],
            "chat_template_kwargs": {"enable_thinking": False},
        }
        response = self.http.status_of(_RENDER, body)
        found = body_of(response, "token_ids", "features") if response.status_code < 400 else None
        if found is None:
            raise ConfigError(
                f"{self.http.url(_RENDER)} rendered no pictures; start vLLM with VLLM_ENABLE_SCALE_OUT_ENDPOINTS=1 and "
                f"a model that sees pictures, or set backbone.pictures false. It said: {said(response)}"
            )
        return Shown(found["token_ids"], found["features"])

    def _seen(self, prompt: Shown, behind: Sequence[int], asked: Mapping[str, Any]) -> dict[str, Any]:
        sent = {"token_ids": [*prompt, *behind], "features": prompt.features, "sampling_params": dict(asked)}
        response = self.http.post(_GENERATE, {"model": self.model, **sent})
        found = body_of(response, "choices")
        if found is None:
            raise ConfigError(f"{self.http.url(_GENERATE)} answered no tokens but {said(response)}; use a newer vLLM")
        return found

    def _seen_tops(self, prompt: Shown, behind: Sequence[int], count: int, top: int) -> list[Top]:
        more = {"logprobs": top, **({"prompt_logprobs": top} if count > 1 else {})}
        found = self._seen(prompt, behind, sampling(1, more))
        told = ((found["choices"][0].get("logprobs") or {}).get("content") or [{}])[0].get("top_logprobs") or []
        listed = {entry["token"]: entry["logprob"] for entry in told}
        choice = {"prompt_logprobs": found.get("prompt_logprobs"), "logprobs": {"top_logprobs": [listed]}}
        return self._told(choice, count, top)

    def _choices(self, prompts: list[list[int]], body: Mapping[str, Any]) -> list[dict[str, Any]]:
        sent = {"model": self.model, "prompt": prompts if len(prompts) > 1 else prompts[0], "temperature": 0, **body}
        response = self.http.post("v1/completions", sent)
        found = body_of(response, "choices")
        if found is None:
            raise ConfigError(
                f"{self.http.url('v1/completions')} answered no completion but {said(response)}; mend backbone.base_url"
            )
        choices: list[dict[str, Any]] = sorted(found["choices"], key=lambda choice: int(choice.get("index", 0)))
        return choices

    def _next(self, choice: Mapping[str, Any], top: int) -> Top:
        """The place behind the prompt, from the log-probabilities of the token that was written there."""
        told = (choice.get("logprobs") or {}).get("top_logprobs") or []
        if not told or not all(name.startswith(_TOKEN_ID) for name in told[0]):
            raise ConfigError(self._without("gave no logprobs by token ids"))
        return Top.of(((int(name.removeprefix(_TOKEN_ID)), logp) for name, logp in told[0].items()), top)

    def _without(self, what: str) -> str:
        return (
            f"{self.http.url('v1/completions')} {what}, which contrast needs; use vLLM 0.10.2 or newer without "
            "options that switch log-probabilities off, another backbone.protocol, or decoder 'greedy'"
        )

    def _most(self) -> int | None:
        """The largest k that the server takes; None: the whole vocabulary."""
        first = self._probe(-1)
        if first is None:
            return None
        if told := _ALLOWED.search(first):
            return self._checked(int(told[1]))
        return self._checked(next((limit for limit in _LIMITS if self._probe(limit) is None), 0))

    def _probe(self, top: int) -> str | None:
        """None if a request with that k is answered, else what the server says."""
        body = {"model": self.model, "prompt": [1, 1], "max_tokens": 1, "temperature": 0, "prompt_logprobs": top}
        response = self.http.status_of("v1/completions", body)
        if response.status_code < 400:
            found = body_of(response, "choices")
            if found is None or not found["choices"][0].get("prompt_logprobs"):
                raise ConfigError(self._without("takes no prompt_logprobs"))
            return None
        return said(response)

    def _checked(self, most: int) -> int:
        if most < 1:
            raise ConfigError(self._without(f"takes no prompt_logprobs (its limit is {most})"))
        return most


def _pairs(place: Mapping[str, Any]) -> list[tuple[int, float]]:
    return [(int(token), float(told["logprob"])) for token, told in place.items()]


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
