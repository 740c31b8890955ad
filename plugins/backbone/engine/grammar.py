"""A JSON schema as a grammar over tokens: which token may come next, and which must.

llguidance parses; it is imported only here, and only if a schema is given. Objects are written compactly, their keys in
the schema's order. Knows token ids and text; no model, no decoder.
"""

from __future__ import annotations

import json
import threading
from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from plugins.backbone.engine.faults import DoesNotFit

Mask = NDArray[np.int32]
"""(rows, words): bit t of a row set if token t may come next."""

_OPTIONS = {"whitespace_flexible": False}
_KEPT_GRAMMARS = 64
_STRUCTURE = '{"}[]:,0123456789.-'


class GrammarCompiler:
    """Compiles schemas for one tokenizer: a fast tokenizer of transformers, or a ready `LLTokenizer`."""

    def __init__(self, tokenizer: Any, vocabulary: int, eos: Sequence[int]) -> None:
        self.vocabulary = vocabulary
        self.tokens = _token_table(tokenizer, vocabulary, list(eos))
        self.kept: OrderedDict[str, Grammar] = OrderedDict()
        self.lock = threading.Lock()

    def grammar(self, schema: Mapping[str, Any]) -> Grammar:
        """The grammar of a JSON schema, compiled once. Raises DoesNotFit naming the path that cannot be met."""
        text = json.dumps(schema)
        with self.lock:
            if text not in self.kept:
                self.kept[text] = self._compiled(schema)
                if len(self.kept) > _KEPT_GRAMMARS:
                    self.kept.popitem(last=False)
            self.kept.move_to_end(text)
            return self.kept[text]

    def _compiled(self, schema: Mapping[str, Any]) -> Grammar:
        grammar = Grammar(self, schema)
        if fault := grammar.fault:
            shared = {k: schema[k] for k in ("$defs", "definitions") if k in schema}
            path = next((p for p, s in _subschemas(schema) if Grammar(self, {**shared, **s}).fault), "$")
            raise DoesNotFit(f"no answer can meet the schema at {path}: {fault}; mend the schema", path)
        return grammar


class Grammar:
    """A compiled schema; `track` gives the state of a new answer."""

    def __init__(self, maker: GrammarCompiler, schema: Mapping[str, Any]) -> None:
        from llguidance import LLMatcher

        self.maker = maker
        self.schema = schema
        try:
            text = LLMatcher.grammar_from_json_schema(dict(schema), overrides=_OPTIONS)
        except ValueError as fault:
            self.fault, self.start = str(fault), None
            return
        self.start = LLMatcher(maker.tokens, text, log_level=0)
        self.fault = self.start.get_error() if self.start.is_error() else ""

    def track(self) -> GrammarState:
        """The grammar's state at the beginning of an answer."""
        return GrammarState(self)

    def text(self, ids: Sequence[int]) -> str:
        """Tokens as text; what is no UTF-8 yet becomes U+FFFD."""
        return self.bytes(ids).decode("utf-8", errors="replace")

    def bytes(self, ids: Sequence[int]) -> bytes:
        """Tokens as bytes."""
        return bytes(self.maker.tokens.decode_bytes(list(ids)))

    def spelled(self, text: str) -> list[int]:
        """A text's tokens in the tokenizer's spelling."""
        return list(self.maker.tokens.tokenize_str(text))


class GrammarState:
    """The state of the grammar after the tokens of one answer so far."""

    def __init__(self, grammar: Grammar) -> None:
        assert grammar.start is not None  # noqa: S101 -- a grammar with a fault is never handed out
        self.matcher = grammar.start.deep_copy()
        self.words = (grammar.maker.tokens.vocab_size + 31) // 32
        """Words of a mask that the tokenizer fills; the model's vocabulary may have more."""

    @property
    def done(self) -> bool:
        """True if only the end of the text may follow."""
        return bool(self.matcher.is_stopped())

    @property
    def complete(self) -> bool:
        """True if the answer so far is valid."""
        return bool(self.matcher.is_stopped() or self.matcher.is_accepting())

    def fill(self, row: Mask) -> None:
        """Write the tokens that may come next into one row of a mask, at least `words` long."""
        self.matcher.unsafe_compute_mask_ptr(row.ctypes.data, 4 * self.words)
        if self.matcher.is_error():
            row[:] = 0

    def take(self, token: int) -> bool:
        """Advances by a token; False, without a change, if it may not come next."""
        return bool(self.matcher.try_consume_tokens([token]) == 1)

    def back(self, tokens: int) -> None:
        """Goes back by that many tokens."""
        if tokens:
            self.matcher.rollback(tokens)

    def forced(self) -> list[int]:
        """Advances by the tokens that leave no choice, in the tokenizer's spelling, and returns them."""
        found = list(self.matcher.compute_ff_tokens())
        taken = self.matcher.try_consume_tokens(found) if found else 0
        return found[:taken]


def allowed(mask: Mask, vocabulary: int, device: torch.device) -> Tensor:
    """A mask unpacked: (rows, vocabulary), True for tokens that may come next."""
    if device.type == "cpu":
        bits = np.unpackbits(mask.view(np.uint8), axis=-1, count=vocabulary, bitorder="little")
        return torch.from_numpy(bits).view(torch.bool)
    words = torch.from_numpy(mask).to(device, non_blocking=True)
    shifts = torch.arange(32, device=device, dtype=torch.int32)
    return ((words[..., None] >> shifts) & 1).bool().flatten(1)[:, :vocabulary]


def choice_counts(mask: Mask) -> NDArray[np.int64]:
    """The number of tokens that may come next, for each row."""
    counted: NDArray[np.int64] = np.bitwise_count(mask.view(np.uint32)).sum(-1, dtype=np.int64)
    return counted


def single_choices(mask: Mask) -> NDArray[np.int64]:
    """The only token of each row that leaves one."""
    word = mask.view(np.uint32).argmax(-1)
    bits = mask.view(np.uint32)[np.arange(len(mask)), word]
    tokens: NDArray[np.int64] = word.astype(np.int64) * 32 + np.log2(bits.astype(np.float64)).astype(np.int64)
    return tokens


def collisions(added: Sequence[str], schema: Mapping[str, Any]) -> list[str]:
    """Special tokens whose text every answer of the schema must contain.

    A tokenizer reads such text as the special token, which no grammar may produce, so the answer could not be spelled
    as the model learned it.
    """
    said = json.dumps(schema, ensure_ascii=False, separators=(",", ":"))
    return [text for text in added if text and (text in said or text in _STRUCTURE)]


def _token_table(tokenizer: Any, vocabulary: int, eos: list[int]) -> Any:
    from llguidance import LLTokenizer

    if isinstance(tokenizer, LLTokenizer):
        return tokenizer
    from llguidance.hf import from_tokenizer

    size = max(vocabulary, tokens_in(tokenizer))
    known = [token for token in eos if token < tokens_in(tokenizer)]
    return from_tokenizer(tokenizer, n_vocab=size, eos_token=known or eos, slices=LLTokenizer.json_slices())


def tokens_in(tokenizer: Any) -> int:
    """The number after a tokenizer's largest token id."""
    return max(tokenizer.get_vocab().values(), default=-1) + 1


def _subschemas(schema: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Sub-schemas with their paths, innermost first."""
    for name, part in (schema.get("properties") or {}).items():
        if isinstance(part, Mapping):
            yield from _subschemas(part, f"{path}.{name}" if path else name)
    if isinstance(schema.get("items"), Mapping):
        yield from _subschemas(schema["items"], f"{path}[]")
    for part in schema.get("anyOf") or ():
        if isinstance(part, Mapping):
            yield from _subschemas(part, path)
    yield path or "$", schema
