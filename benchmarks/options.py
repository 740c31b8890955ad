"""A language model's answers to closed questions: one of a few options, token by token, under any decoder.

The decoder's own `scores` sees whole rows of logits, with the report and without it; then every token that continues no
option is excluded, as a grammar would. The logits of all options are computed once, so that any number of decoders are
compared on the very same numbers. Knows a model of transformers and the project's decoders; no report and no truth.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from plugins.backbone.hf_load import Loaded
from sgcad_core.interfaces import Decoder

Spelling = tuple[int, ...]
"""The tokens of an option, the end token last."""


@dataclass(frozen=True)
class Heard:
    """Logits in front of every beginning of an option: (vocabulary,) each, in fp32."""

    options: Mapping[str, Spelling]
    after: Mapping[Spelling, Tensor]

    def log_p(self, option: str) -> float:
        """log p of the whole option, nats."""
        spelling = self.options[option]
        return sum(float(self.after[spelling[:i]].log_softmax(-1)[t]) for i, t in enumerate(spelling))


class Listener:
    """Asks one loaded model; narratives stand in front of the question, so that their keys are computed once."""

    def __init__(self, loaded: Loaded) -> None:
        self.model, self.tokenizer = loaded.model, loaded.tokenizer
        self.end = int(self.tokenizer.eos_token_id)

    @torch.inference_mode()
    def hear(self, context: str, questions: Mapping[str, Sequence[str]]) -> list[Heard]:
        """Logits for every question's options behind one context ("" = none)."""
        texts = [self._prompt(context, question) for question in questions]
        ids = [self.tokenizer(text, add_special_tokens=False)["input_ids"] for text in texts]
        shared = _common(ids)
        cache = self.model(torch.tensor([ids[0][:shared]]), use_cache=True, logits_to_keep=1).past_key_values
        found = []
        for own, options in zip(ids, questions.values(), strict=True):
            found.append(self._options(own[shared:], options, cache))
        return found

    def _prompt(self, context: str, question: str) -> str:
        told = f"{context}\n\n" if context else ""
        said: str = self.tokenizer.apply_chat_template(
            [{"role": "user", "content": told + question}], tokenize=False, add_generation_prompt=True
        )
        return said

    def _options(self, rest: Sequence[int], options: Sequence[str], cache: Any) -> Heard:
        spelled = {
            option: (*self.tokenizer(option, add_special_tokens=False)["input_ids"], self.end) for option in options
        }
        longest = max(map(len, spelled.values()))
        kept = deepcopy(cache)
        first = self.model(torch.tensor([rest]), past_key_values=kept, logits_to_keep=1, use_cache=True).logits[0, -1]
        kept.batch_repeat_interleave(len(spelled))
        rows = [[*s[:-1], *([self.end] * (longest - len(s)))] for s in spelled.values()]  # the end token is not read
        logits = self.model(torch.tensor(rows), past_key_values=kept, use_cache=True).logits.float()
        after: dict[Spelling, Tensor] = {(): first.float()}
        for row, spelling in zip(logits, spelled.values(), strict=True):
            for i in range(1, len(spelling)):
                after.setdefault(spelling[:i], row[i - 1])
        return Heard(spelled, after)


def _common(ids: Sequence[Sequence[int]]) -> int:
    """How many tokens all begin with, at least one short of the shortest."""
    same = 0
    while same < min(map(len, ids)) - 1 and len({row[same] for row in ids}) == 1:
        same += 1
    return same


def decode(decoder: Decoder, with_context: Heard, without_context: Heard) -> str:
    """The option that the decoder takes, token by token; at temperature 0."""
    said: Spelling = ()
    names = {spelling: option for option, spelling in with_context.options.items()}
    while said not in names:
        allowed = sorted({s[len(said)] for s in names if s[: len(said)] == said})
        rows = with_context.after[said][None], without_context.after[said][None]
        scores = decoder.scores(*rows)[0]
        masked = torch.full_like(scores, -math.inf)
        masked[allowed] = scores[allowed]
        if not torch.isfinite(masked).any():  # plausible tokens, none of which continues an option
            masked[allowed] = rows[0][0][allowed]
        said = (*said, int(masked.argmax()))
    return names[said]
