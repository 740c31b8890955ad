"""A GGUF file's own tokenizer in the place of a fast tokenizer of transformers: for prompts and for grammars.

Texts are spelled by llama.cpp, chat templates are rendered by transformers' own renderer. Knows no weights.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from plugins.backbone.engine.grammar import GrammarCompiler
from plugins.backbone.llama.library import Model
from sgcad_core.errors import ConfigError

_SPECIAL = b"\xff"
"""Marks special tokens in the table of llguidance, which no text may spell."""


@dataclass(frozen=True)
class Added:
    """A token that stands for no text, by the names that transformers gives its attributes."""

    content: str
    special: bool = True


class GgufWords:
    """The attributes of a tokenizer of transformers that `hf_prompt.Prompter` uses."""

    def __init__(self, model: Model) -> None:
        self.model = model
        api, vocab = model.api, model.vocab
        self.bos_token = self._name(api.llama_vocab_bos(vocab))
        self.eos_token_id = int(api.llama_vocab_eos(vocab))
        self.eos_token = self._name(self.eos_token_id)

    @cached_property
    def pieces(self) -> list[bytes]:
        """Every token's bytes."""
        return [self.model.piece(token) for token in range(self.model.vocabulary)]

    @cached_property
    def added_tokens_decoder(self) -> dict[int, Added]:
        """Special tokens by their ids."""
        special = [token for token in range(self.model.vocabulary) if self.model.is_special(token)]
        named = {token: self.pieces[token].decode("utf-8", errors="replace") for token in special}
        return {token: Added(name) for token, name in named.items() if name}

    def __call__(self, text: str, add_special_tokens: bool = True) -> dict[str, list[int]]:
        """A text's token ids."""
        return {"input_ids": self.model.tokens_of(text, add_special_tokens)}

    def __len__(self) -> int:
        return self.model.vocabulary

    def apply_chat_template(self, messages: Sequence[Mapping[str, Any]], chat_template: str, **options: Any) -> str:
        """A conversation as text, rendered as transformers renders it. Raises ConfigError for a broken template."""
        from jinja2.exceptions import TemplateError
        from transformers.utils.chat_template_utils import render_jinja_template

        options.pop("tokenize", None)
        try:
            rendered, _ = render_jinja_template(
                [list(messages)],
                chat_template=chat_template,
                bos_token=self.bos_token,
                eos_token=self.eos_token,
                **options,
            )
        except TemplateError as fault:
            raise ConfigError(
                f"backbone.model {self.model.file}: its chat template cannot be rendered: {fault}; use another file of "
                "the model"
            ) from fault
        return str(rendered[0])

    def _name(self, token: int) -> str:
        return self.model.piece(token).decode("utf-8", errors="replace") if token >= 0 else ""


def compiler(words: GgufWords, eos: Sequence[int]) -> GrammarCompiler:
    """Grammars over the file's vocabulary."""
    from llguidance import LLTokenizer

    model = words.model
    special = {t for t in range(model.vocabulary) if model.is_special(t)} | set(eos)
    table = [_SPECIAL + piece if token in special else piece for token, piece in enumerate(words.pieces)]
    spell = ctypes.cast(model.api._lib.llama_tokenize, ctypes.c_void_p).value
    tokens = LLTokenizer.from_llamacpp(
        tokens=table,
        vocab_ptr=model.vocab,
        tokenize_fptr=spell,
        eos_token=list(eos),
        slices=LLTokenizer.json_slices(),
    )
    return GrammarCompiler(tokens, model.vocabulary, list(eos))
