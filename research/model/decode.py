"""Free-running greedy answers of many reports at once, held to the walks of `answer_grammar`.

For measuring during and after training, with torch alone; the product decodes through its own engine. Every row
has its own cached keys and values and its own position, so rows of any length share a batch.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import Tensor
from torch.nn import functional as F

from research.model import answer_grammar
from research.model.fast_layers import norm, rotate
from research.model.model import Forward
from research.model.tokens import ROAD, SCENARIO, Coder
from research.rows.collate import collate, positions
from research.rows.report_rows import road_ids
from research.rows.row import Row


class Cache:
    """Keys and values of a batch: (layers, B, kv, length, d); `used` tokens of each row, `shift` of its positions."""

    def __init__(self, forward: Forward, rows: Sequence[Row], coder: Coder, room: int) -> None:
        self.forward = forward
        batch = collate(rows, coder)
        self.used = torch.tensor([len(row.ids) for row in rows])
        self.shift = torch.tensor([int(positions(row)[0, -1]) + 1 - len(row.ids) if row.ids else 0 for row in rows])
        self.keys: list[Tensor] = []
        self.values: list[Tensor] = []
        self.room = room
        self._prefill(batch)

    def _prefill(self, batch: Any) -> None:
        forward, text = self.forward, self.forward.text
        x, _ = forward.embedded(batch)
        cos, sin = forward._rope(batch.positions)
        length = x.shape[1]
        mask = torch.full((length, length), float("-inf"), dtype=x.dtype).triu(1)[None, None]
        for layer in text.layers:
            x = self._layer(layer, x, cos, sin, mask, None)

    def _layer(self, layer: Any, x: Tensor, cos: Tensor, sin: Tensor, mask: Tensor, index: int | None) -> Tensor:
        """One layer; `index` None fills the cache, else writes one token at each row's place."""
        forward, block = self.forward, layer.self_attn
        h = norm(layer.input_layernorm, x)
        b, length, dim = h.shape
        q = block.q_proj(h).view(b, length, forward.heads, -1).transpose(1, 2)
        k = block.k_proj(h).view(b, length, forward.kv, -1).transpose(1, 2)
        v = block.v_proj(h).view(b, length, forward.kv, -1).transpose(1, 2)
        q, k = rotate(q, cos, sin), rotate(k, cos, sin)
        if index is None:
            pad = (0, 0, 0, self.room)
            self.keys.append(F.pad(k, pad))
            self.values.append(F.pad(v, pad))
        else:
            rows = torch.arange(b)
            self.keys[index][rows, :, self.used] = k[:, :, 0]
            self.values[index][rows, :, self.used] = v[:, :, 0]
            k, v = self.keys[index], self.values[index]
        groups = forward.heads // forward.kv
        scores = q @ k.repeat_interleave(groups, 1).transpose(2, 3) * q.shape[-1] ** -0.5 + mask
        out = torch.softmax(scores, -1) @ v.repeat_interleave(groups, 1)
        x = x + block.o_proj(out.transpose(1, 2).reshape(b, length, dim))
        return x + forward._mlp(layer.mlp, norm(layer.post_attention_layernorm, x))

    def feed(self, tokens: Sequence[int], alive: Sequence[bool]) -> Tensor:
        """One token a row; logits (B, vocabulary). Rows that are not alive keep their place."""
        text = self.forward.text
        x = text.embed_tokens(torch.tensor(tokens))[:, None]
        places = (self.used + self.shift)[None, :, None].expand(3, -1, 1)
        cos, sin = self.forward._rope(places)
        total = self.keys[0].shape[2]
        mask = torch.zeros(len(tokens), total, dtype=x.dtype).masked_fill(
            torch.arange(total)[None] > self.used[:, None], float("-inf")
        )
        for index, layer in enumerate(text.layers):
            x = self._layer(layer, x, cos, sin, mask[:, None, None], index)
        self.used = self.used + torch.tensor(alive).long()
        return F.linear(norm(text.norm, x)[:, 0], self.forward.model.lm_head.weight).float()


@dataclass
class Course:
    """One row's answers while they are written."""

    walk: answer_grammar.Walk
    queue: list[int] = field(default_factory=list)
    pick: answer_grammar.Pick | None = None
    text: str = ""
    road: Any = None
    behavior: Any = None
    stage: str = ROAD
    done: bool = False


class Answerer:
    """Greedy answers for evidence rows."""

    def __init__(self, forward: Forward, coder: Coder) -> None:
        self.forward, self.coder = forward, coder

    @torch.no_grad()
    def answer(
        self,
        rows: Sequence[Row],
        roads: Sequence[Any] | None = None,
        most: int = 400,
        views: Sequence[Sequence[Row]] = (),
    ) -> list[tuple[Any, Any]]:
        """(road, behavior) for every evidence row; behavior is None behind a refused road.

        With `roads` the road answers are given and only the behavior is written. `views` are the same rows with their
        drawings laid out otherwise; what they predict is averaged, as the product does.
        """
        count = 1 + len(views)
        cache = Cache(self.forward, [row for some in (rows, *views) for row in some], self.coder, most)
        courses = [Course(answer_grammar.road_walk(), [self.coder.special[ROAD]]) for _ in rows]
        if roads is not None:
            for course, road in zip(courses, roads, strict=True):
                self._given(course, road)
        for _ in range(most):
            tokens = [course.queue.pop(0) if course.queue else 0 for course in courses]
            alive = [not course.done for course in courses]
            if not any(alive):
                break
            logits = cache.feed(tokens * count, alive * count)
            logits = logits.log_softmax(-1).view(count, len(rows), -1).mean(0)
            for course, row in zip(courses, logits, strict=True):
                if not course.done and not course.queue:
                    self._next(course, row)
        return [(course.road, course.behavior) for course in courses]

    def _given(self, course: Course, road: Any) -> None:
        text = json.dumps(road, separators=(",", ":"))
        pieces = answer_grammar.write(answer_grammar.road_walk(), road)
        course.queue = [self.coder.special[ROAD], *(i for piece, _ in pieces for i in self.coder.piece(piece))]
        course.text, course.walk = text, iter(())  # type: ignore[assignment]
        course.road, course.stage = road, "given"
        if "refuse" in road:
            course.done = True
            return
        course.queue.append(self.coder.special[SCENARIO])
        course.walk, course.text, course.stage = answer_grammar.behavior_walk(road_ids(road)), "", SCENARIO

    def _next(self, course: Course, logits: Tensor) -> None:
        """Choose at a pick with the logits behind what was fed, then run on to the next pick."""
        sent: str | None = None
        if course.pick is not None:
            sent = self._choose(course.pick, logits)
            self._say(course, sent)
        self._advance(course, sent, logits if course.pick is None else None)

    def _advance(self, course: Course, sent: str | None, logits: Tensor | None) -> None:
        while True:
            try:
                step = course.walk.send(sent)
            except StopIteration:
                self._finish(course)
                return
            if isinstance(step, answer_grammar.Force):
                self._say(course, step.text)
                sent, logits = None, None
                continue
            course.pick = step
            if course.queue or logits is None:
                return
            sent = self._choose(step, logits)
            self._say(course, sent)
            logits = None

    def _choose(self, pick: answer_grammar.Pick, logits: Tensor) -> str:
        firsts = torch.tensor([self.coder.piece(option)[0] for option in pick.options])
        return pick.options[int(logits[firsts].argmax())]

    def _say(self, course: Course, text: str) -> None:
        course.text += text
        course.queue += self.coder.piece(text)

    def _finish(self, course: Course) -> None:
        answer = json.loads(course.text)
        course.pick, course.text = None, ""
        if course.stage == ROAD:
            course.road = answer
            if "refuse" in answer:
                course.done = True
                return
            course.stage = SCENARIO
            course.queue.append(self.coder.special[SCENARIO])
            course.walk = answer_grammar.behavior_walk(road_ids(answer))
            return
        course.behavior, course.done = answer, True
