"""SGLang's own /generate: token ids in and out, log-probabilities of a given text from a place on.

`logprob_start_len` says where in the prompt they begin, so that the server reads the beginning from its cache. It has
no limit of the top k and tells the values of given tokens (`token_ids_logprob`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from plugins.backbone.server.http import ServerHttp, body_of, listed, said, tokenized
from plugins.backbone.server.protocol import Offer, Schema, Speaker, Top
from sgcad_core.errors import ConfigError


class SgLang(Speaker):
    """Speaks to one SGLang server."""

    def __init__(self, http: ServerHttp, model: str) -> None:
        self.http = http
        self.model = model

    def offer(self) -> Offer:
        """Asks for the model's name and window, then scores two tokens."""
        name, window = listed(self.http, self.model)
        self.tops([1, 1, 1], (), 2, 1)
        return Offer(name, window, None)

    def spelled(self, text: str) -> list[int] | None:
        """Tokens by the page /tokenize of newer servers."""
        return tokenized(self.http, {"model": self.model, "prompt": text, "add_special_tokens": False})

    def draft(self, prompt: Sequence[int], behind: Sequence[int], limit: int, schema: Schema) -> list[int]:
        """Greedy tokens, at the start of an answer guided by the schema."""
        sampling: dict[str, Any] = {"max_new_tokens": limit, "temperature": 0}
        if schema is not None and not behind:
            sampling["json_schema"] = json.dumps(dict(schema))
        found = self._generate(prompt, behind, sampling, {})
        return [int(token) for token in found.get("output_ids") or []]

    def tops(self, prompt: Sequence[int], behind: Sequence[int], count: int, top: int) -> list[Top]:
        """One request: the last `count` - 1 tokens as input, the next one as output."""
        start = max(0, len(prompt) + len(behind) - count - 1)
        asked = {"return_logprob": True, "logprob_start_len": start, "top_logprobs_num": top}
        meta = self._generate(prompt, behind, {"max_new_tokens": 1, "temperature": 0}, asked)["meta_info"]
        given = list(zip(meta.get("input_token_logprobs") or [], meta.get("input_top_logprobs") or [], strict=False))
        inside = given[1 - count :] if count > 1 else []
        behind_it = (meta.get("output_top_logprobs") or [None])[0]
        if len(inside) != count - 1 or behind_it is None or any(tops is None for _, tops in inside):
            raise ConfigError(
                f"{self.http.url('generate')} gave no input_top_logprobs, which contrast needs; use another "
                "backbone.protocol, or decoder 'greedy'"
            )
        return [*(Top.of([*_pairs(tops), *_pairs([own])], top) for own, tops in inside), Top.of(_pairs(behind_it), top)]

    def exact(self, prompt: Sequence[int], behind: Sequence[int], tokens: Sequence[int]) -> dict[int, float]:
        """The values of given tokens for the next one."""
        asked = {"return_logprob": True, "logprob_start_len": -1, "token_ids_logprob": list(tokens)}
        meta = self._generate(prompt, behind, {"max_new_tokens": 1, "temperature": 0}, asked)["meta_info"]
        return dict(Top.of(_pairs((meta.get("output_token_ids_logprobs") or [[]])[0]), 0).known)

    def _generate(
        self, prompt: Sequence[int], behind: Sequence[int], sampling: Mapping[str, Any], more: Mapping[str, Any]
    ) -> dict[str, Any]:
        body = {"input_ids": [*prompt, *behind], "sampling_params": dict(sampling), **more}
        response = self.http.post("generate", body)
        found = body_of(response, "meta_info")
        if found is None:
            raise ConfigError(
                f"{self.http.url('generate')} answered no generation but {said(response)}; mend backbone.base_url"
            )
        return found


def _pairs(entries: Sequence[Sequence[Any]]) -> list[tuple[int, float | None]]:
    """SGLang's entries are [log-probability, token, text]."""
    return [(int(entry[1]), entry[0]) for entry in entries]
