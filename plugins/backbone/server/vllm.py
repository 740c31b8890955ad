"""vLLM's completions: prompts as token ids, `prompt_logprobs` for a given text, `structured_outputs` for drafts.

The server's limit of the top k is its option --max-logprobs (20 unless set, -1 the whole vocabulary). A request with
prompt_logprobs does not read the server's prefix cache: it computes its prompt again. So drafts are asked for with
their own log-probabilities, values outside the top k by `logprob_token_ids` where the server knows that field, and a
few places behind a long text as the next tokens of its beginnings, which the cache holds. Pictures need the server's
scale-out pages (VLLM_ENABLE_SCALE_OUT_ENDPOINTS=1), which render a chat into token ids with features and take both
back.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

from plugins.backbone.server.http import ServerHttp, body_of, listed, said, tokenized
from plugins.backbone.server.pictures import Content, Shown, sampling
from plugins.backbone.server.protocol import Offer, Schema, Speaker, Top
from sgcad_core.errors import ConfigError

_LIMITS = (5000, 1000, 500, 200, 100, 50, 20, 10, 5, 1)
_ALLOWED = re.compile(r"max(?:imum)? allowed:? (\d+)")
_RENDER, _GENERATE = "v1/chat/completions/render", "inference/v1/generate"
_TOKEN_ID = "token_id:"  # noqa: S105 - vLLM's spelling of a token's number
_BLOCK = 16
"""Tokens of a block of vLLM's prefix cache: what a next token may cost behind a cached text."""
_NAMED = 128
"""vLLM's limit of logprob_token_ids."""
_REMEMBERED = 64
_CERTAIN = -1e-3
"""Of two tokens in nats at least one is below this, unless a mask made each the only one."""


class Vllm(Speaker):
    """Speaks to one vLLM server."""

    def __init__(self, http: ServerHttp, model: str) -> None:
        self.http = http
        self.model = model
        self.at_once = False
        self.named = 0
        """Without logprob_token_ids each value takes a prompt of its own, computed from its beginning."""
        self.unmasked = False
        """Whether log-probabilities of a masked choice are those before the mask (logprobs_mode raw_logprobs)."""
        self.read: deque[int] = deque(maxlen=_REMEMBERED)
        """Hashes of the prompts that the server has read lately: their beginnings are in its cache."""

    def offer(self) -> Offer:
        """Asks for the model's name and window, then for prompt log-probabilities with ever smaller k."""
        name, window = listed(self.http, self.model)
        offer = Offer(name, window, self._most())
        self.at_once = self._tells_named()
        self.named = _NAMED if self.at_once else 0
        self.unmasked = self._tells_unmasked()
        return offer

    def spelled(self, text: str) -> list[int] | None:
        """Tokens by the page /tokenize."""
        return tokenized(self.http, {"model": self.model, "prompt": text, "add_special_tokens": False})

    def draft(self, prompt: Sequence[int], behind: Sequence[int], limit: int, schema: Schema) -> list[int]:
        """Greedy tokens, at the start of an answer guided by the schema in compact JSON."""
        if isinstance(prompt, Shown):
            found = self._seen(prompt, behind, sampling(limit, _guide(behind, schema)))
            return [int(token) for token in found["choices"][0]["token_ids"]]
        return self._drafted(prompt, behind, limit, _guide(behind, schema))[0]

    def draft_told(
        self, prompt: Sequence[int], behind: Sequence[int], limit: int, schema: Schema, top: int
    ) -> tuple[list[int], list[Top]]:
        """A draft and its places, if the server tells values before the mask; not with pictures."""
        if isinstance(prompt, Shown) or not self.unmasked:
            return self.draft(prompt, behind, limit, schema), []
        more = {"logprobs": top, "return_tokens_as_token_ids": True}
        ids, choice = self._drafted(prompt, behind, limit, {**_guide(behind, schema), **more})
        told = (choice.get("logprobs") or {}).get("top_logprobs") or []
        tops = [Top.of(self._named_pairs(place), top) for place in told]
        return ids, tops if len(tops) == len(ids) else []

    def _drafted(
        self, prompt: Sequence[int], behind: Sequence[int], limit: int, more: Mapping[str, Any]
    ) -> tuple[list[int], Mapping[str, Any]]:
        (choice,) = self._choices([[*prompt, *behind]], {**more, "max_tokens": limit, "return_token_ids": True})
        self.read.append(hash(tuple(prompt)))
        if (ids := choice.get("token_ids")) is None:
            raise ConfigError(
                f"{self.http.url('v1/completions')} returned no token_ids though return_token_ids was set; use vLLM "
                "0.10.2 or newer, or backbone 'hf_vision'"
            )
        return [int(token) for token in ids], choice

    def tops(self, prompt: Sequence[int], behind: Sequence[int], count: int, top: int) -> list[Top]:
        """One request: the last `count` - 1 tokens by prompt_logprobs, the next one by logprobs."""
        return self.tops_of([prompt], behind, count, top)[0]

    def tops_of(self, prompts: Sequence[Sequence[int]], behind: Sequence[int], count: int, top: int) -> list[list[Top]]:
        """One request with a prompt for each row; rows that differ in what is cheapest have a request each."""
        kinds = {self._way(prompt, behind, count) for prompt in prompts}
        if len(prompts) > 1 and (len(kinds) > 1 or any(isinstance(prompt, Shown) for prompt in prompts)):
            return super().tops_of(prompts, behind, count, top)
        if isinstance(prompts[0], Shown):
            return [self._seen_tops(prompts[0], behind, count, top)]
        texts = [[*prompt, *behind] for prompt in prompts]
        if kinds == {"beginnings"}:
            return self._by_beginnings(texts, count, top)
        choices = self._choices(texts, _next_told(top) | ({"prompt_logprobs": top} if count > 1 else {}))
        self.read.extend(hash(tuple(prompt)) for prompt in prompts)
        return [self._told(choice, count, top) for choice in choices]

    def _by_beginnings(self, texts: Sequence[list[int]], count: int, top: int) -> list[list[Top]]:
        """The last places of texts as next tokens, with the tokens that stand there by name where they are rare."""
        ends = [text[: len(text) - count + 1 + i] for text in texts for i in range(count)]
        found = [self._next(choice, top) for choice in self._choices(ends, _next_told(top))]
        stands = [texts[i // count][len(end) : len(end) + 1] for i, end in enumerate(ends)]
        rare = [i for i, token in enumerate(stands) if token and token[0] not in found[i].known]
        for some in (rare[i : i + self.named] for i in range(0, len(rare), self.named)):
            told = self.exact_of([ends[i] for i in some], sorted({stands[i][0] for i in some}))
            for i, values in zip(some, told, strict=True):
                found[i] = found[i].with_known({stands[i][0]: values[stands[i][0]]})
        return [found[i * count : (i + 1) * count] for i in range(len(texts))]

    def _way(self, prompt: Sequence[int], behind: Sequence[int], count: int) -> str:
        """Whether some places of a text cost less as next tokens of its cached beginnings than by reading it all."""
        cached = self.named and not isinstance(prompt, Shown) and hash(tuple(prompt)) in self.read
        return "beginnings" if cached and 1 < count * _BLOCK < len(prompt) + len(behind) else "whole"

    def _told(self, choice: Mapping[str, Any], count: int, top: int) -> list[Top]:
        places = (choice.get("prompt_logprobs") or [])[1 - count :] if count > 1 else []
        if len(places) != count - 1 or None in places:
            raise ConfigError(self._without("gave no prompt_logprobs"))
        return [*(Top.of(_pairs(place), top) for place in places), self._next(choice, top)]

    def exact(self, prompt: Sequence[int], behind: Sequence[int], tokens: Sequence[int]) -> dict[int, float]:
        """One request for all by logprob_token_ids; without that field one with a prompt for each token."""
        known = [*prompt, *behind]
        if isinstance(prompt, Shown):
            return {token: self._seen_tops(prompt, [*behind, token], 2, 1)[0].known[token] for token in tokens}
        if 0 < len(tokens) <= self.named:
            return self.exact_of([known], tokens)[0]
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

    def _choices(self, prompts: Sequence[list[int]], body: Mapping[str, Any]) -> list[dict[str, Any]]:
        sent = {
            "model": self.model,
            "prompt": list(prompts) if len(prompts) > 1 else prompts[0],
            "temperature": 0,
            **body,
        }
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
        if not told:
            raise ConfigError(self._without("gave no logprobs by token ids"))
        return Top.of(self._named_pairs(told[0]), top)

    def _named_pairs(self, place: Mapping[str, float]) -> list[tuple[int, float]]:
        if not all(name.startswith(_TOKEN_ID) for name in place):
            raise ConfigError(self._without("gave no logprobs by token ids"))
        return [(int(name.removeprefix(_TOKEN_ID)), logp) for name, logp in place.items()]

    def exact_of(self, texts: Sequence[list[int]], tokens: Sequence[int]) -> list[dict[int, float]]:
        """One request for all texts and tokens, of which there may be at most `named`."""
        choices = self._choices(texts, _next_told(1) | {"logprob_token_ids": list(tokens)})
        found = [self._next(choice, 0).known for choice in choices]
        return [{token: told[token] for token in tokens} for told in found]

    def _tells_named(self) -> bool:
        """Whether the server knows logprob_token_ids (vLLM of mid-2026): older ones refuse or ignore it."""
        return {0, 1, 2, 3} <= set(self._probed({"logprob_token_ids": [0, 1, 2, 3]}))

    def _tells_unmasked(self) -> bool:
        """Whether a token that alone is allowed keeps its own value: with logprobs_mode processed it has 0."""
        told = [self._probed({"allowed_token_ids": [token]}).get(token, 0.0) for token in (0, 1)]
        return min(told) < _CERTAIN

    def _probed(self, field: Mapping[str, Any]) -> dict[int, float]:
        """Log-probabilities at the one token of a request with a field; empty if the server does not take it."""
        body = {"model": self.model, "prompt": [1, 1], "temperature": 0, **_next_told(1), **field}
        response = self.http.status_of("v1/completions", body)
        found = body_of(response, "choices") if response.status_code < 400 else None
        return dict(self._next(found["choices"][0], 0).known) if found else {}

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


def _next_told(top: int) -> dict[str, Any]:
    """The fields of a request for one token and its `top` log-probabilities by token ids."""
    return {"max_tokens": 1, "logprobs": top, "return_tokens_as_token_ids": True}


def _guide(behind: Sequence[int], schema: Schema) -> dict[str, Any]:
    if schema is None or behind:
        return {}
    return {"structured_outputs": {"json": dict(schema), "disable_any_whitespace": True}}


def _pairs(place: Mapping[str, Any]) -> list[tuple[int, float]]:
    return [(int(token), float(told["logprob"])) for token, told in place.items()]
