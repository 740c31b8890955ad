"""A tiny Qwen2.5-VL trained for seconds: it reads lanes off words and a color off a picture.

Random models say much the same whatever they see, so equality on them proves less than it seems. This one has
learned four facts that stand in the narrative or in the picture, and beliefs about them for when neither does.
"""

from __future__ import annotations

import hashlib
import json
import random
from functools import cache
from typing import Any

import torch

from plugins.backbone.engine.families import Family, family_of
from plugins.backbone.engine.records import Picture, Prompt
from tests.plugins.backbone import tiny

BEARINGS, LANES, LIGHTS = ("N", "E", "S", "W"), (1, 2, 3, 4), ("day", "dark")
SHADES = ("black", "white")
SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {
        "bearing": {"enum": list(BEARINGS)},
        "lanes": {"enum": list(LANES)},
        "light": {"enum": list(LIGHTS)},
        "shade": {"enum": list(SHADES)},
    },
    "required": ["bearing", "lanes", "light", "shade"],
    "additionalProperties": False,
}
STEPS, BATCH = 220, 24


def sample(rng: random.Random, context: bool = True) -> tuple[Prompt, list[int], dict[str, Any]]:
    """A prompt (without evidence if `context` is False), the answer's tokens, and the answer.

    Some facts are commoner than others: the belief that context-aware decoding works against.
    """
    truth = {
        "bearing": rng.choices(BEARINGS, (4, 2, 1, 1))[0],
        "lanes": rng.choices(LANES, (1, 4, 2, 1))[0],
        "light": rng.choices(LIGHTS, (3, 1))[0],
        "shade": rng.choice(SHADES),
    }
    tokenizer = _tokenizer()
    ids: list[int] = tokenizer("road")["input_ids"]
    pictures = []
    if context:
        told = [200 + BEARINGS.index(truth["bearing"]), 210 + LANES.index(truth["lanes"])]
        told += [220 + LIGHTS.index(truth["light"])]
        pictures = [_picture(SHADES.index(truth["shade"]), rng.randrange(4))]
        ids = [*ids, 292, *[tiny.IMAGE_TOKEN] * 4, 293, *told]
    answer: list[int] = tokenizer(json.dumps(truth, separators=(",", ":")))["input_ids"]
    return Prompt([*ids, 9], pictures), answer, truth


@cache
def model() -> tuple[Any, Family]:
    """Train it; the same weights every time."""
    torch.manual_seed(1)
    made = tiny.qwen2_5_vl()
    rng = random.Random(0)
    optimizer = torch.optim.AdamW(made.parameters(), lr=4e-3, weight_decay=0.01)
    plan = torch.optim.lr_scheduler.OneCycleLR(optimizer, 4e-3, total_steps=STEPS, pct_start=0.1)
    made.train()
    for _ in range(STEPS):
        optimizer.zero_grad()
        _loss(made, [sample(rng, rng.random() > 0.15) for _ in range(BATCH)]).backward()
        optimizer.step()
        plan.step()
    return made.eval(), family_of(made)


def _loss(made: Any, batch: list[tuple[Prompt, list[int], dict[str, Any]]]) -> torch.Tensor:
    longest = max(len(p.ids) + len(a) for p, a, _ in batch)
    ids = torch.zeros(len(batch), longest, dtype=torch.long)
    labels = torch.full_like(ids, -100)
    seen = torch.zeros_like(ids)
    for i, (prompt, answer, _) in enumerate(batch):
        row = [*prompt.ids, *answer, 2][:longest]
        ids[i, : len(row)] = torch.tensor(row)
        seen[i, : len(row)] = 1
        labels[i, len(prompt.ids) : len(row)] = ids[i, len(prompt.ids) : len(row)]
    pictures = [p for prompt, _, _ in batch for p in prompt.pictures]
    made.model.rope_deltas = None
    loss: torch.Tensor = made(
        input_ids=ids, attention_mask=seen, labels=labels, use_cache=False,
        mm_token_type_ids=ids.eq(tiny.IMAGE_TOKEN).int(),
        pixel_values=torch.cat([p.inputs["pixel_values"] for p in pictures]),
        image_grid_thw=torch.cat([p.inputs["image_grid_thw"] for p in pictures]),
    ).loss  # fmt: skip
    return loss


@cache
def _tokenizer() -> Any:
    return tiny.tokenizer()


@cache
def _picture(shade: int, variant: int) -> Picture:
    noise = torch.randn(16, 96, generator=torch.Generator().manual_seed(variant))
    inputs = {"pixel_values": 0.2 * noise + (2.0 * shade - 1.0), "image_grid_thw": torch.tensor([[1, 4, 4]])}
    return Picture(hashlib.sha256(f"{shade}-{variant}".encode()).hexdigest(), inputs)
