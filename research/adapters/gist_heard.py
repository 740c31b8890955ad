"""A model's logits at every value of a gist's answer, with a report and without it, as contrastive decoding sees them.

The prompt is that of a second opinion, and the answer goes by the values that greedy decoding with the report takes, in
both rows: so any number of decoders are compared, field by field, on the very same numbers. What a grammar forces is
fed and never asked. Knows no truth and no decoder.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from plugins.backbone.engine.families import family_of
from plugins.backbone.hf_load import Loaded
from plugins.backbone.hf_prompt import Prompter
from plugins.backbone.prompt import Parts
from research.adapters.gist_spelling import FIELDS, GistSpelling, Tokens, following


@dataclass(frozen=True)
class Heard:
    """Logits in front of every beginning of an option: (vocabulary,) each, in fp32."""

    options: Mapping[str, Tokens]
    after: Mapping[Tokens, Tensor]

    def log_p(self, option: str) -> float:
        """log p of the whole option, nats."""
        spelling = self.options[option]
        return sum(float(self.after[spelling[:i]].log_softmax(-1)[t]) for i, t in enumerate(spelling))


class GistListener:
    """Asks one loaded model for the gist; `task` is the text of a prompt file."""

    def __init__(self, loaded: Loaded, task: str) -> None:
        self.model, self.task = loaded.model, task
        self.prompter = Prompter(loaded, family_of(loaded.model))
        self.spelling = GistSpelling(loaded.tokenizer)

    @torch.inference_mode()
    def hear(self, narrative: str, said: Mapping[str, str] | None = None) -> tuple[dict[str, Heard], dict[str, str]]:
        """Logits by field, and the values by which the answer went: `said`, or the likeliest ones."""
        parts = Parts(task=self.task, passages=(), narrative=narrative.strip(), diagrams=(), repair="")
        fed: list[int] = list(self.prompter.prompt(parts).ids)
        cache, found, went = None, {}, {}
        for key in FIELDS:
            first, cache = self._feed([*fed, *self.spelling.leads[key]], cache)
            found[key] = self._field(key, first, cache)
            went[key] = said[key] if said else likeliest(found[key])
            fed = list(self.spelling.values[key][went[key]])
        return found, went

    def _field(self, key: str, first: Tensor, cache: Any) -> Heard:
        """Logits at each place where values branch: the first one, and behind each beginning that several share."""
        after: dict[Tokens, Tensor] = {(): first}
        options = {}
        for value, tokens in self.spelling.values[key].items():
            chosen: Tokens = ()
            for depth in self.spelling.branches(key, value):
                if chosen not in after:
                    after[chosen], _ = self._feed(list(tokens[:depth]), deepcopy(cache))
                chosen = (*chosen, tokens[depth])
            options[value] = chosen
        return Heard(options, after)

    def _feed(self, ids: list[int], cache: Any) -> tuple[Tensor, Any]:
        told = self.model(torch.tensor([ids]), past_key_values=cache, use_cache=True, logits_to_keep=1)
        return told.logits[0, -1].float(), told.past_key_values


def likeliest(heard: Heard) -> str:
    """The value that greedy decoding takes."""
    said: Tokens = ()
    names = {spelling: value for value, spelling in heard.options.items()}
    while said not in names:
        allowed = sorted(following(names, said))
        said = (*said, allowed[int(heard.after[said][allowed].argmax())])
    return names[said]
