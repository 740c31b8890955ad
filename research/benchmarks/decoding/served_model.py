"""A model as a server holds it: writes tokens, scores given ones, over the engine's rows and caches.

What a request would cost is counted: passes over the weights and tokens fed. Knows no protocol and no HTTP.
"""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from PIL import Image
from torch import Tensor

from plugins.backbone.engine.families import family_of
from plugins.backbone.engine.grammar import GrammarCompiler, GrammarState, allowed
from plugins.backbone.engine.prefix import prompt_key
from plugins.backbone.engine.records import Picture, Prompt
from plugins.backbone.engine.runner import Row, Runner
from plugins.backbone.hf_load import load
from plugins.backbone.hf_prompt import Prompter
from plugins.backbone.hf_run import end_tokens
from sgcad_core.case.records import Diagram


class ServedModel:
    """One model on one thread at a time. `most` is the largest top k, None the whole vocabulary."""

    def __init__(self, folder: Path, window: int = 4096, most: int | None = None, dtype: str = "float32") -> None:
        options = {"dtype": getattr(torch, dtype), "attn_implementation": "sdpa"}
        self.loaded = load(str(folder), None, options, "cpu", "none")
        self.tokenizer = self.loaded.tokenizer
        self.runner = Runner(self.loaded.model, family_of(self.loaded.model), apart=False)
        self.prompter = Prompter(self.loaded, self.runner.family)
        self.vocabulary = int(self.loaded.model.get_output_embeddings().weight.shape[0])
        self.eos = end_tokens(self.loaded.model.generation_config, self.tokenizer)
        self.maker = GrammarCompiler(self.tokenizer, self.vocabulary, sorted(self.eos))
        self.window = window
        self.most = most
        self.tells_named = True
        """Whether values of tokens are told by name, as newer servers of vLLM do."""
        self.lock = threading.Lock()
        self.seconds = 0.0
        """Processor seconds of the thread that ran the model."""

    @property
    def limit(self) -> int:
        """The largest top k."""
        return self.vocabulary if self.most is None else self.most

    @property
    def passes(self) -> int:
        """Passes over the weights so far."""
        return self.runner.calls

    def rendered(self, blocks: list[str | bytes]) -> list[int]:
        """A user's turn of texts and pictures (PNG) as token ids, every picture's placeholders in place."""
        shown = [self.picture(block) for block in blocks if isinstance(block, bytes)]
        found: list[int] = self.prompter.turn([None if isinstance(b, bytes) else b for b in blocks], shown)
        return found

    def picture(self, png: bytes) -> Picture:
        """A picture prepared for the model."""
        with Image.open(io.BytesIO(png)) as opened:
            return self.prompter.picture(Diagram(png=png, width_px=opened.width, height_px=opened.height))

    def scored(self, ids: Sequence[int], count: int, pictures: Sequence[Picture] = ()) -> Tensor:
        """Log-probabilities at the last `count` places of a text, (count, vocabulary) in nats."""
        return self.scored_all([(ids, count)], pictures)[0]

    def scored_all(self, texts: Sequence[tuple[Sequence[int], int]], pictures: Sequence[Picture] = ()) -> list[Tensor]:
        """The same of several texts in one batch, as far as their beginnings are in the cache."""
        with self.lock, torch.inference_mode():
            started = time.thread_time()
            chunks = [self._opened(ids, count, pictures) for ids, count in texts]
            logits = self.runner.step([(row, list(rest)) for row, rest in chunks])
            for (row, rest), (ids, _) in zip(chunks, texts, strict=True):
                row.length += len(rest)
                self.runner.keep(row, ids[len(row.prompt.ids) :])
            for row, _ in reversed(chunks):
                self.runner.close(row)
            self.seconds += time.thread_time() - started
            return [one[-count:].float().log_softmax(-1) for one, (_, count) in zip(logits, texts, strict=True)]

    def _opened(self, ids: Sequence[int], count: int, pictures: Sequence[Picture]) -> tuple[Row, Sequence[int]]:
        """A row with what is cached of a text, before its last `count` places at most, and the tokens to feed."""
        start = len(ids) - count + 1
        start = start if pictures else min(start, self._kept(ids) + 1)
        return self.runner.open(Prompt(list(ids[:start]), pictures)), ids[start - 1 :]

    def _kept(self, ids: Sequence[int]) -> int:
        """How many first tokens of a text are in the cache."""
        prompt = Prompt(list(ids), ())
        found = self.runner.prefixes.longest(self.runner.family.salt(prompt), prompt_key(ids, [], []))
        return found[1] if found else 0

    def written(
        self,
        ids: Sequence[int],
        limit: int,
        schema: Mapping[str, Any] | None = None,
        text: Sequence[int] = (),
        pictures: Sequence[Picture] = (),
        told: bool = False,
    ) -> tuple[list[int], list[Tensor]]:
        """Greedy tokens behind a text, the end token included, with the log-probabilities before the mask at each.

        A schema, or tokens that alone may be written, masks the choice. Forced tokens of a schema cost no pass of their
        own; those at the end have log-probabilities only if all are to be `told`, by one more pass.
        """
        with self.lock, torch.inference_mode():
            started = time.thread_time()
            found = self._write(Prompt(list(ids), pictures), limit, schema, text, told)
            self.seconds += time.thread_time() - started
            return found

    def _write(
        self, prompt: Prompt, limit: int, schema: Mapping[str, Any] | None, text: Sequence[int], told: bool
    ) -> tuple[list[int], list[Tensor]]:
        track = self.maker.grammar(schema).track() if schema is not None else None
        row = self.runner.open(prompt)
        found, rows = list[int](), list[Tensor]()
        pending = [prompt.ids[-1]]
        forced = track.forced() if track else []
        found, pending = [*forced], [*pending, *forced]
        while len(found) < limit and not (track and track.done):
            (logits,) = self.runner.step([(row, pending)])
            row.length += len(pending)
            rows += logits.float().log_softmax(-1)
            token = int(self._masked(rows[-1], track, text, len(found)).argmax())
            pending = [token]
            found.append(token)
            if token in self.eos or (track and not track.take(token)):
                break
            if track:
                forced = track.forced()
                found, pending = [*found, *forced], [*pending, *forced]
        if told and len(rows) < len(found):
            (logits,) = self.runner.step([(row, pending)])
            row.length += len(pending)
            rows += logits[:-1].float().log_softmax(-1)
        self.runner.keep(row, found)
        self.runner.close(row)
        return found[:limit], rows[:limit]

    def _masked(self, row: Tensor, track: GrammarState | None, text: Sequence[int], written: int) -> Tensor:
        may = torch.ones(self.vocabulary, dtype=torch.bool)
        if track is not None:
            mask = np.zeros((1, (self.vocabulary + 31) // 32), np.int32)
            track.fill(mask[0])
            may = allowed(mask, self.vocabulary, row.device)[0]
        elif text:
            may = torch.zeros(self.vocabulary, dtype=torch.bool)
            may[text[written] if written < len(text) else list(self.eos)] = True
        return row.masked_fill(~may, float("-inf"))

    def bytes(self, ids: Sequence[int]) -> bytes:
        """Tokens as bytes; special tokens have none."""
        plain = [token for token in ids if token not in self.eos]
        return bytes(self.maker.tokens.decode_bytes(plain))

    def tokens(self, text: str) -> list[int]:
        """A text's tokens."""
        found: list[int] = self.tokenizer(text, add_special_tokens=False)["input_ids"]
        return found
