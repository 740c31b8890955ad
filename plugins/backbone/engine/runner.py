"""Rows on a model: prefilled apart, stepped together, closed.

A row is one prompt and the tokens fed after it. Rows of one lane share a cache and a forward pass, whatever their
lengths. Knows no report, no decoder and no grammar.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import torch
from torch import Tensor

from plugins.backbone.engine.cache import SlotCache, Window
from plugins.backbone.engine.families import Family
from plugins.backbone.engine.prefix import SHORTEST, Key, PrefixStore, prompt_key
from plugins.backbone.engine.records import Prompt
from plugins.backbone.engine.supported import sliding_of, window_of


@dataclass(eq=False)
class Row:
    """One prompt in a slot; `length` tokens of it and of what was fed behind it are in the cache."""

    prompt: Prompt
    lane: Lane
    slot: int
    positions: Tensor
    behind: int
    """Position of the first token behind the prompt."""
    key: Key
    spans: list[tuple[int, int]]
    length: int = 0
    reused: int = 0


@dataclass(eq=False)
class Lane:
    """Rows that may share a batch; row i lies in slot i."""

    cache: SlotCache
    rows: list[Row] = field(default_factory=list)


class Runner:
    """The model and its lanes: one if `apart` is False, else one for rows with pictures and one for the others."""

    def __init__(self, model: Any, family: Family, apart: bool, prefix_bytes: int = 1 << 30) -> None:
        self.model = model
        self.family = family
        self.apart = apart
        self.lanes: dict[str, Lane] = {}
        self.prefixes = PrefixStore(prefix_bytes)
        self.calls = 0
        self.window = window_of(model)
        self.vocabulary = int(model.get_output_embeddings().weight.shape[0])
        text = model.config.get_text_config()
        self.layers = int(text.num_hidden_layers)
        self.sliding = sliding_of(model)
        self.bool_mask = getattr(text, "_attn_implementation", "sdpa") != "eager"
        self.last: Tensor | None = None
        """What the output embedding got in the last pass, (rows, width, hidden), once `watch` was called."""
        self.states: dict[int, Tensor] = {}
        """By id of a row that was stepped: (tokens, hidden)."""

    @property
    def computed_in(self) -> str:
        """Number type of the model's weights."""
        return str(self.model.dtype).removeprefix("torch.")

    def watch(self) -> None:
        """Keeps, from now on, the states that every step's logits are computed from."""

        def seen(_: Any, given: tuple[Tensor, ...]) -> None:
            self.last = given[0]

        self.model.get_output_embeddings().register_forward_pre_hook(seen)

    def open(self, prompt: Prompt, behind: Sequence[int] = ()) -> Row:
        """Opens a row for a prompt and prefills the prompt and `behind` except the last token."""
        lane = self._lane(prompt)
        spans = self.family.spans(prompt)
        positions, next_position = self.family.positions(prompt)
        key = prompt_key(prompt.ids, spans, [p.digest for p in prompt.pictures])
        row = Row(prompt, lane, len(lane.rows), positions, next_position, key, spans)
        if spans and spans[-1][1] >= len(prompt.ids):
            raise ValueError("the prompt ends in a picture; the answer must start behind text")
        lane.rows.append(row)
        try:
            self._fill(row, [*prompt.ids, *behind][:-1])
        except Exception:
            self.close(row)
            raise
        return row

    def keep(self, row: Row, behind: Sequence[int]) -> None:
        """Keeps the row's prompt and the tokens fed after it for a prompt that continues them."""
        if row.length > len(row.prompt.ids):
            self._keep(row, behind)

    def close(self, row: Row) -> None:
        """Frees the row's slot; the last row of the lane moves into it."""
        rows = row.lane.rows
        last = rows.pop()
        if last is not row:
            row.lane.cache.move(last.slot, row.slot, last.length)
            last.slot = row.slot
            rows[row.slot] = last

    def step(self, chunks: Sequence[tuple[Row, Sequence[int]]]) -> list[Tensor]:
        """Feeds tokens to rows, all rows of their lanes at once; returns logits (tokens, vocabulary) of each.

        The rows' lengths stay: the caller adds the accepted tokens, the rest is overwritten later.
        """
        found: dict[int, Tensor] = {}
        self.states = {}
        by_row = {id(row): tokens for row, tokens in chunks}
        for lane in {id(row.lane): row.lane for row, _ in chunks}.values():
            logits = self._forward(lane, [by_row[id(row)] for row in lane.rows])
            found |= {id(row): logits[i, : len(by_row[id(row)])] for i, row in enumerate(lane.rows)}
            if self.last is not None:
                self.states |= {id(row): self.last[i, : len(by_row[id(row)])] for i, row in enumerate(lane.rows)}
        return [found[id(row)] for row, _ in chunks]

    def reset(self) -> None:
        """Discards every row and every prefix: after memory ran out their content is not reliable."""
        self.lanes = {}
        self.prefixes.clear()

    def forget(self) -> None:
        """Discards every kept beginning."""
        self.prefixes.clear()

    def clear(self, row: Row) -> None:
        """Sets a row's keys and values, which may hold NaN, to zero."""
        row.lane.cache.clear(row.slot)

    def _lane(self, prompt: Prompt) -> Lane:
        name = self.family.lane(prompt) if self.apart else "all"
        if name not in self.lanes:
            self.lanes[name] = Lane(SlotCache(self.layers, self.family.cross_layers))
        return self.lanes[name]

    def _fill(self, row: Row, known: Sequence[int]) -> None:
        """Fills the row's slot: the kept beginning, the rest of the prompt, the known tokens after it."""
        prompt = row.prompt
        inside = min(len(prompt.ids), len(known))
        row.lane.cache.ensure(row.slot + 1, len(known) + 1)
        self._reuse(row, inside - bool(self.family.cross_layers))
        if row.length < inside:
            extra = self.family.prefill_inputs(prompt, row.length, inside)
            self._prefill(row, known[row.length : inside], extra)
        self._keep(row)
        if row.length < len(known):
            self._prefill(row, known[inside:], self.family.step_inputs([prompt], len(known) - inside))

    def _reuse(self, row: Row, limit: int) -> None:
        """Loads the longest kept beginning, cut before a picture that it holds only in part."""
        kept = self.prefixes.longest(self.family.salt(row.prompt), row.key)
        if kept is None:
            return
        length = min(kept[1], limit)
        for start, end in row.spans:
            length = start if start < length < end else length
        if length > 0:
            row.lane.cache.load(row.slot, kept[0], length)
            row.length = row.reused = length

    def _keep(self, row: Row, behind: Sequence[int] = ()) -> None:
        key = np.concatenate([row.key, np.asarray(behind, dtype=np.int64)])[: row.length]
        salt = self.family.salt(row.prompt)
        if self.prefixes.limit and len(key) >= SHORTEST and not self.prefixes.known(salt, key):
            self.prefixes.add(salt, key, row.lane.cache.save(row.slot, len(key)))

    def _prefill(self, row: Row, tokens: Sequence[int], extra: dict[str, Any]) -> None:
        start, end = row.length, row.length + len(tokens)
        cache = row.lane.cache
        base = row.slot * cache.capacity
        cache.look_at(Window(row.slot, 1, end, start, torch.arange(base + start, base + end)))
        plain = start == 0 and not (self.family.whole_pictures and row.spans)
        mask = None if plain else self._mask([start], len(tokens), end, row.spans)
        self._run([list(tokens)], self._positions([row], len(tokens)), mask, cache, {**extra, "logits_to_keep": 1})
        row.length = end

    def _forward(self, lane: Lane, chunks: Sequence[Sequence[int]]) -> Tensor:
        width = max(len(chunk) for chunk in chunks)
        lengths = [row.length for row in lane.rows]
        keys = max(lengths) + width
        lane.cache.ensure(len(lane.rows), keys)
        first = torch.tensor([row.slot * lane.cache.capacity + row.length for row in lane.rows])
        places = (first[:, None] + torch.arange(width)).flatten()
        lane.cache.look_at(Window(0, len(lane.rows), keys, 0, places))
        padded = [[*chunk, *[0] * (width - len(chunk))] for chunk in chunks]
        extra = self.family.step_inputs([row.prompt for row in lane.rows], width)
        mask = self._mask(lengths, width, keys)
        return self._run(padded, self._positions(lane.rows, width), mask, lane.cache, extra)

    def _run(
        self,
        ids: list[list[int]],
        positions: Tensor,
        mask: Tensor | dict[str, Tensor] | None,
        cache: SlotCache,
        extra: dict[str, Any],
    ) -> Tensor:
        self.calls += 1
        device = self.model.device
        found = self.model(
            input_ids=torch.tensor(ids, device=device),
            position_ids=positions.to(device),
            attention_mask=mask,
            past_key_values=cache,
            use_cache=True,
            **extra,
        )
        logits: Tensor = found.logits
        return logits

    def _positions(self, rows: Sequence[Row], width: int) -> Tensor:
        """(rows, width), or (3, rows, width) under M-RoPE: each row by its own count, never a shared delta."""
        found = torch.stack([_positions_from(row, row.length, width) for row in rows], dim=1)
        return found if self.family.dimensions > 1 else found[0]

    def _mask(
        self, lengths: Sequence[int], width: int, keys: int, spans: Sequence[tuple[int, int]] = ()
    ) -> Tensor | dict[str, Tensor]:
        """(rows, 1, width, keys), True where a key is seen: the row's own tokens up to the query.

        By kind of layer where some slide over the last tokens only. `spans`: pictures of the first row, whose tokens
        see each other where the family says so.
        """
        device = self.model.device
        last = torch.tensor(lengths, device=device)[:, None] + torch.arange(width, device=device)
        places = torch.arange(keys, device=device)
        seen = places <= last[:, None, :, None]
        if self.sliding is None:
            return self._typed(self._whole(seen, lengths[0], spans))
        near = seen & (places > last[:, None, :, None] - self.sliding)
        kinds = {"full_attention": seen, "sliding_attention": near}
        return {kind: self._typed(self._whole(mask, lengths[0], spans)) for kind, mask in kinds.items()}

    def _whole(self, seen: Tensor, start: int, spans: Sequence[tuple[int, int]]) -> Tensor:
        """The mask with the tokens of each picture of the stretch open to each other."""
        for first, end in spans if self.family.whole_pictures else ():
            if first >= start and end <= start + seen.shape[2]:
                seen[0, 0, first - start : end - start, first:end] = True
        return seen

    def _typed(self, seen: Tensor) -> Tensor:
        if self.bool_mask:
            return seen
        dtype = self.model.dtype
        return torch.zeros(seen.shape, dtype=dtype, device=seen.device).masked_fill(~seen, torch.finfo(dtype).min)


def _positions_from(row: Row, start: int, width: int) -> Tensor:
    """(dimensions, width) from the row's token number `start` on."""
    own = row.positions[:, start : start + width]
    first = row.behind + max(0, start - row.positions.shape[1])
    rest = torch.arange(first, first + width - own.shape[1])
    return torch.cat([own, rest.expand(row.positions.shape[0], -1)], dim=1)
