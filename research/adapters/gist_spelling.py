"""How a tokenizer spells the answer to the gist, field by field: what the grammar writes, and where a value branches.

Values are JSON texts as in `research.rows.partial_labels.OPTIONS`. Knows no weights and no report.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from research.rows.partial_labels import OPTIONS

FIELDS = tuple(OPTIONS)
Tokens = tuple[int, ...]


class GistSpelling:
    """Leads and values of all fields as tokens; raises ValueError for a tokenizer that spells an answer otherwise."""

    def __init__(self, tokenizer: Any) -> None:
        self.tokenizer = tokenizer
        self.leads = {key: self._tokens(_lead(key)) for key in OPTIONS}
        self.values = {key: {value: self._tokens(_bare(value)) for value in some} for key, some in OPTIONS.items()}
        for place in range(max(map(len, OPTIONS.values()))):
            answer = {key: some[place % len(some)] for key, some in OPTIONS.items()}
            text = "".join(_lead(key) + _bare(value) for key, value in answer.items())
            if self._tokens(text) != tuple(token for key in OPTIONS for token in self.piece(key, answer[key])):
                raise ValueError(f"the tokenizer does not spell {text!r} piece by piece; use another model")

    def piece(self, key: str, value: str) -> Tokens:
        """A field with its value, and what stands in front of it behind the field before."""
        return self.leads[key] + self.values[key][value]

    def branches(self, key: str, value: str) -> list[int]:
        """Numbers of those tokens of a value where another value would go on otherwise."""
        own, some = self.values[key][value], self.values[key].values()
        return [depth for depth in range(len(own)) if len(following(some, own[:depth])) > 1]

    def _tokens(self, text: str) -> Tokens:
        return tuple(self.tokenizer(text, add_special_tokens=False)["input_ids"])


def following(spelled: Iterable[Tokens], begun: Sequence[int]) -> set[int]:
    """Tokens behind a beginning in those spellings that have it."""
    depth = len(begun)
    return {one[depth] for one in spelled if len(one) > depth and list(one[:depth]) == list(begun)}


def _lead(key: str) -> str:
    """What the grammar writes in front of a field's value: the quotes of strings are no choice."""
    at = FIELDS.index(key)
    closing = '"' if at and _quoted(FIELDS[at - 1]) else ""
    return closing + ("," if at else "{") + f'"{key}":' + ('"' if _quoted(key) else "")


def _bare(value: str) -> str:
    return value.strip('"')


def _quoted(key: str) -> bool:
    return OPTIONS[key][0].startswith('"')
