"""llama.cpp's server: /completion gives log-probabilities of the tokens that it writes, none of its prompt.

A given text is scored nevertheless: a grammar of token numbers (`root ::= <[5]> <[92]>`, since December 2025) makes the
server write it, and `n_probs` tells the model's own values at every place, before the grammar. So a text costs a pass
for each of its tokens, behind a prompt in the cache. The top k has no limit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from plugins.backbone.server.http import ServerHttp, body_of, listed, said, tokenized
from plugins.backbone.server.protocol import Offer, Schema, Speaker, Top
from sgcad_core.errors import ConfigError

_OLD = "use llama.cpp of December 2025 or newer (token numbers in grammars), or decoder 'greedy'"


class LlamaCpp(Speaker):
    """Speaks to one server of llama.cpp."""

    named = 4
    guided = False

    def __init__(self, http: ServerHttp, model: str) -> None:
        self.http = http
        self.model = model

    def offer(self) -> Offer:
        """Asks for the model's name and window, then makes the server write a token that is not its own choice."""
        name, window = listed(self.http, self.model)
        token = (self.spelled("a") or [1])[-1]
        self.tops([token, token], (), 2, 1)
        return Offer(name, window, None)

    def spelled(self, text: str) -> list[int] | None:
        """Tokens by the page /tokenize."""
        return tokenized(self.http, {"content": text, "add_special": False, "parse_special": False})

    def draft(self, prompt: Sequence[int], behind: Sequence[int], limit: int, schema: Schema) -> list[int]:
        """Greedy tokens without a grammar: the server's own allows white space that answers do not have."""
        told = self._completion([*prompt, *behind], limit, 1)
        return [int(entry["id"]) for entry in told]

    def tops(self, prompt: Sequence[int], behind: Sequence[int], count: int, top: int) -> list[Top]:
        """One request: the server writes the last `count` - 1 tokens, then one of its own."""
        known = [*prompt, *behind]
        start = len(known) - count + 1
        told = self._completion(known[:start], count, top, known[start:])
        return [Top.of([*_pairs(entry["top_logprobs"]), *_pairs([entry])], top) for entry in told]

    def exact(self, prompt: Sequence[int], behind: Sequence[int], tokens: Sequence[int]) -> dict[int, float]:
        """A request for each token, which the server then writes."""
        known = [*prompt, *behind]
        return {token: float(self._completion(known, 1, 1, [token])[0]["logprob"]) for token in tokens}

    def _completion(self, ids: Sequence[int], limit: int, top: int, text: Sequence[int] = ()) -> list[dict[str, Any]]:
        body: dict[str, Any] = {"prompt": list(ids), "n_predict": limit, "n_probs": top, "temperature": 0}
        body |= {"cache_prompt": True, "return_tokens": True}
        if text:
            body["grammar"] = "root ::= " + " ".join(f"<[{token}]>" for token in text)
        response = self.http.post("completion", body)
        found = body_of(response, "completion_probabilities")
        told: list[dict[str, Any]] = found["completion_probabilities"] if found else []
        if not told or [entry["id"] for entry in told[: len(text)]] != list(text) or (text and len(told) < limit):
            raise ConfigError(
                f"{self.http.url('completion')} did not write the tokens {list(text)[:4]} with their log-probabilities "
                f"but {said(response)}; {_OLD}"
            )
        return told


def _pairs(entries: Sequence[Mapping[str, Any]]) -> list[tuple[int, float]]:
    return [(int(entry["id"]), float(entry["logprob"])) for entry in entries]
