"""The architecture: Qwen2.5-VL from its config, small, and a forward made for training on padded batches.

The modules are transformers' own, so that names, initialization, saving and loading are theirs; only the way
through them is written anew: attention as two batched matrix products (faster than SDPA at these shapes on a
CPU), pictures padded to one length, logits only where a loss is wanted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional as F
from transformers import Qwen2_5_VLConfig, Qwen2_5_VLForConditionalGeneration

PATCH = 14
CHANNELS = 5
MERGE = 2


def make_config(vocabulary: int, special: dict[str, int], size: str = "mini") -> Qwen2_5_VLConfig:
    """The config of a size: "mini" (about 4 M parameters) or "tiny" for tests."""
    hidden, layers, heads, inner, depth, vision = {"mini": (192, 6, 4, 512, 4, 128), "tiny": (64, 2, 2, 96, 1, 32)}[
        size
    ]
    head = hidden // heads
    return Qwen2_5_VLConfig(
        text_config={
            "vocab_size": vocabulary,
            "hidden_size": hidden,
            "intermediate_size": inner,
            "num_hidden_layers": layers,
            "num_attention_heads": heads,
            "num_key_value_heads": max(1, heads // 2),
            "rms_norm_eps": 1e-6,
            "max_position_embeddings": 4096,
            "rope_parameters": {
                "rope_type": "default",
                "rope_theta": 10000.0,
                "mrope_section": [head // 6, head // 6, head // 2 - 2 * (head // 6)],
            },
            "bos_token_id": None,
            "eos_token_id": special["<|im_end|>"],
            "pad_token_id": special["<|pad|>"],
            "tie_word_embeddings": True,
        },
        vision_config={
            "depth": depth,
            "hidden_size": vision,
            "intermediate_size": vision * 5 // 2,
            "num_heads": 4,
            "in_channels": CHANNELS,
            "patch_size": PATCH,
            "spatial_merge_size": MERGE,
            "temporal_patch_size": 1,
            "window_size": 1792,
            "out_hidden_size": hidden,
            "fullatt_block_indexes": list(range(depth)),
        },
        image_token_id=special["<|image_pad|>"],
        video_token_id=special["<|video_pad|>"],
        vision_start_token_id=special["<|vision_start|>"],
        vision_end_token_id=special["<|vision_end|>"],
        tie_word_embeddings=True,
    )


def make_model(config: Qwen2_5_VLConfig) -> Qwen2_5_VLForConditionalGeneration:
    """A model with fresh weights."""
    model = Qwen2_5_VLForConditionalGeneration(config)
    for name, weight in model.named_parameters():
        if weight.ndim == 2 and "embed" not in name:
            nn.init.normal_(weight, std=0.5 / math.sqrt(weight.shape[1]))
        if name.endswith(("o_proj.weight", "down_proj.weight", "attn.proj.weight")):
            nn.init.zeros_(weight)
    return model


@dataclass
class Batch:
    """Padded rows.

    ids (B, L); positions (3, B, L); patches (N, P, 5 * 14 * 14), grids (N, P, 2) row and column of each patch, lengths
    (N,) real patches; image_index flat places of picture tokens, patch_index which tokens stand there; picks (M,) flat
    places before a value, wanted (M,) its token, weights (M,); ends (S,) flat places of sentence ends, told (S, T) what
    those sentences tell; drawn (sum of picture tokens, D) what each of `patch_index` shows.
    """

    ids: Tensor
    positions: Tensor
    patches: Tensor
    grids: Tensor
    lengths: Tensor
    image_index: Tensor
    patch_index: Tensor
    picks: Tensor
    wanted: Tensor
    weights: Tensor
    ends: Tensor
    told: Tensor
    drawn: Tensor

    def to(self, device: str) -> Batch:
        """The batch on another device."""
        return Batch(**{key: value.to(device) for key, value in vars(self).items()})


def rotate(x: Tensor, cos: Tensor, sin: Tensor) -> Tensor:
    """Rotary embedding of (..., L, D); cos and sin are (..., L, D / 2)."""
    first, second = x.chunk(2, dim=-1)
    return torch.cat(
        (torch.addcmul(first * cos, second, sin, value=-1), torch.addcmul(second * cos, first, sin)), dim=-1
    )


def causal(q: Tensor, k: Tensor, v: Tensor, mask: Tensor, block: int = 128) -> Tensor:
    """Causal attention: q (N, G, L, D) scaled, k and v (N, L, D), mask (L, L); queries in blocks, each of which looks
    only at keys that it can see (half the work of a full square at these lengths)."""
    n, groups, length, d = q.shape
    out = []
    for start in range(0, length, block):
        end = min(start + block, length)
        some = q[:, :, start:end].reshape(n, -1, d)
        out.append(attend(some, k[:, :end], v[:, :end], mask[start:end, :end].repeat(groups, 1)).view(n, groups, -1, d))
    return torch.cat(out, dim=2)


def attend(q: Tensor, k: Tensor, v: Tensor, mask: Tensor) -> Tensor:
    """Attention by two batched products: q (N, G * L, D) scaled, k and v (N, L, D), mask broadcast to (N, G * L, L)."""
    scores = torch.baddbmm(mask, q, k.transpose(1, 2))
    return torch.bmm(torch.softmax(scores, dim=-1), v)


@dataclass
class Pass:
    """States on one way through: last (B, L, hidden) or (M, hidden), middle (B, L, hidden), seen (tokens, hidden)."""

    last: Tensor
    middle: Tensor
    seen: Tensor


@dataclass
class Lesson:
    """Losses of one batch, and the share of sure answers that are right."""

    answers: Tensor
    right: Tensor
    sentences: Tensor
    drawings: Tensor


class Taggers(nn.Module):
    """The heads that ask what a sentence told and what a picture token shows; used in training only."""

    def __init__(self, hidden: int, sentence_tags: int, picture_tags: int, blank: float = 0.2) -> None:
        super().__init__()
        self.sentence, self.picture = nn.Linear(hidden, sentence_tags), nn.Linear(hidden, picture_tags)
        self.blank = blank
        """Weight of a picture token that shows nothing."""
        for head in (self.sentence, self.picture):
            nn.init.zeros_(head.weight)
            nn.init.constant_(head.bias, -4.0)

    def sentences(self, states: Tensor, told: Tensor) -> Tensor:
        """Mean over sentences of the summed binary cross-entropies; states (S, hidden), told (S, T)."""
        if not len(states):
            return states.sum()
        return self._loss(self.sentence, states, told).mean()

    def drawings(self, states: Tensor, drawn: Tensor) -> Tensor:
        """The same over picture tokens, blank ones with less weight; states (N, hidden), drawn (N, D)."""
        if not len(states):
            return states.sum()
        weight = torch.where(drawn.any(dim=1), 1.0, self.blank)
        return (self._loss(self.picture, states, drawn) * weight).sum() / weight.sum()

    @staticmethod
    def _loss(head: nn.Linear, states: Tensor, wanted: Tensor) -> Tensor:
        logits = head(F.rms_norm(states, states.shape[-1:])).float()
        return F.binary_cross_entropy_with_logits(logits, wanted, reduction="none").sum(dim=1)


class _RmsNorm(torch.autograd.Function):
    """RMS norm with few passes over the activations; statistics in fp32."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, weight: Tensor, eps: float) -> Tensor:
        scale = torch.rsqrt(
            torch.linalg.vector_norm(x, dim=-1, keepdim=True, dtype=torch.float32).square_().div_(x.shape[-1]).add_(eps)
        ).to(x.dtype)
        ctx.save_for_backward(x, weight, scale)
        return (x * scale).mul_(weight)

    @staticmethod
    def backward(ctx: Any, *grads: Tensor) -> tuple[Tensor, Tensor, None]:
        x, weight, scale = ctx.saved_tensors
        grad, normed = grads[0], x * scale
        inner = grad * normed
        weight_grad = inner.reshape(-1, x.shape[-1]).sum(0)
        mean = (inner @ weight[:, None]).div_(x.shape[-1])
        out = (grad * weight).addcmul_(normed, mean, value=-1).mul_(scale)
        return out, weight_grad, None


def norm(layer: Any, x: Tensor) -> Tensor:
    """RMS norm with a module's weight."""
    return _RmsNorm.apply(x, layer.weight, layer.variance_epsilon)  # type: ignore[no-any-return]


class Forward:
    """A fast way through a Qwen2_5_VLForConditionalGeneration, in the dtype of its weights."""

    def __init__(self, model: Qwen2_5_VLForConditionalGeneration) -> None:
        self.model = model
        self.text = model.model.language_model
        self.vision = model.model.visual
        self.heads = model.config.text_config.num_attention_heads
        self.kv = model.config.text_config.num_key_value_heads
        self.text_inv = self.text.rotary_emb.original_inv_freq.float().clone()
        self.eyes_fixed = False
        """Whether the vision tower is only looked through, not trained."""
        self.middle = max(1, len(self.text.layers) * 2 // 3)
        """Layers after which a sentence's end is asked what it told; the rest carry it to the answers."""
        self.vision_inv = self.vision.rotary_pos_emb.original_inv_freq.float().clone()

    @property
    def dtype(self) -> torch.dtype:
        """Of the weights."""
        return self.model.lm_head.weight.dtype

    def hidden(self, batch: Batch) -> Tensor:
        """Last hidden states (B, L, hidden), normed."""
        return self.run(batch).last

    def seen(self, batch: Batch) -> Tensor:
        """Tokens of all pictures in the order of `patch_index`, (sum of picture tokens, hidden)."""
        if not batch.patches.shape[0]:
            return torch.zeros(0, self.model.lm_head.weight.shape[1], dtype=self.dtype, device=batch.ids.device)
        with torch.set_grad_enabled(torch.is_grad_enabled() and not self.eyes_fixed):
            found = self.pictures(batch.patches.to(self.dtype), batch.grids, batch.lengths)
        return found.reshape(-1, found.shape[-1])[batch.patch_index]

    def run(self, batch: Batch, places: Tensor | None = None) -> Pass:
        """The whole way; last states at flat `places` only, (M, hidden), if they are given."""
        x = self.text.embed_tokens(batch.ids)
        seen = self.seen(batch)
        if len(seen):
            x = x.view(-1, x.shape[-1]).index_copy(0, batch.image_index, seen).view(x.shape)
        middle = x
        cos, sin = self._rope(batch.positions)
        mask = torch.full((x.shape[1], x.shape[1]), float("-inf"), device=x.device, dtype=x.dtype).triu(1)
        for number, layer in enumerate(self.text.layers, 1):
            x = x + self._attention(layer.self_attn, norm(layer.input_layernorm, x), cos, sin, mask)
            if places is not None and layer is self.text.layers[-1]:
                x = x.view(-1, x.shape[-1])[places]
            x = x + self._mlp(layer.mlp, norm(layer.post_attention_layernorm, x))
            if number == self.middle:
                middle = x
        return Pass(norm(self.text.norm, x), middle, seen)

    def _rope(self, positions: Tensor) -> tuple[Tensor, Tensor]:
        """cos and sin, (B, 1, L, D / 2)."""
        angles = positions[..., None].float() * self.text_inv.to(positions.device)
        parts = angles.split(list(self.text.rotary_emb.mrope_section), dim=-1)
        one = torch.cat([part[i % 3] for i, part in enumerate(parts)], dim=-1)[:, None]
        return one.cos().to(self.dtype), one.sin().to(self.dtype)

    def _attention(self, block: Any, x: Tensor, cos: Tensor, sin: Tensor, mask: Tensor) -> Tensor:
        b, length, dim = x.shape
        projections = (block.q_proj, block.k_proj, block.v_proj)
        weight, bias = torch.cat([p.weight for p in projections]), torch.cat([p.bias for p in projections])
        parts = F.linear(x, weight, bias).view(b, length, self.heads + 2 * self.kv, -1).transpose(1, 2)
        q, k, v = parts.split((self.heads, self.kv, self.kv), dim=1)
        d = q.shape[-1]
        q, k = rotate(q, cos * d**-0.5, sin * d**-0.5), rotate(k, cos, sin)
        k, v = (part.reshape(b * self.kv, length, d) for part in (k, v))
        out = causal(q.reshape(b * self.kv, self.heads // self.kv, length, d), k, v, mask)
        return block.o_proj(out.view(b, self.heads, length, d).transpose(1, 2).reshape(b, length, dim))

    @staticmethod
    def _mlp(block: Any, x: Tensor) -> Tensor:
        bias = None if block.gate_proj.bias is None else torch.cat((block.gate_proj.bias, block.up_proj.bias))
        gate, up = F.linear(x, torch.cat((block.gate_proj.weight, block.up_proj.weight)), bias).chunk(2, dim=-1)
        return block.down_proj(F.silu(gate) * up)

    def pictures(self, patches: Tensor, grids: Tensor, lengths: Tensor) -> Tensor:
        """Tokens of padded pictures, (N, P/4, hidden)."""
        vision = self.vision
        x = F.linear(patches, vision.patch_embed.proj.weight.flatten(1))
        angles = (grids[..., None].float() * self.vision_inv.to(grids.device)).flatten(2)[:, None]
        cos, sin = angles.cos().to(x.dtype), angles.sin().to(x.dtype)
        beyond = torch.arange(patches.shape[1], device=x.device)[None] >= lengths[:, None]
        mask = torch.zeros(beyond.shape, device=x.device, dtype=x.dtype).masked_fill(beyond, float("-inf"))
        mask = mask[:, None, None].repeat(1, vision.blocks[0].attn.num_heads, 1, 1).flatten(0, 1)
        for block in vision.blocks:
            x = x + self._look(block.attn, norm(block.norm1, x), cos, sin, mask)
            x = x + self._mlp(block.mlp, norm(block.norm2, x))
        merged = norm(vision.merger.ln_q, x).view(x.shape[0], -1, x.shape[-1] * MERGE * MERGE)
        return vision.merger.mlp(merged)  # type: ignore[no-any-return]

    @staticmethod
    def _look(block: Any, x: Tensor, cos: Tensor, sin: Tensor, mask: Tensor) -> Tensor:
        n, length, dim = x.shape
        h, d = block.num_heads, dim // block.num_heads
        q, k, v = block.qkv(x).view(n, length, 3, h, d).permute(2, 0, 3, 1, 4)
        q, k = rotate(q, cos * d**-0.5, sin * d**-0.5), rotate(k, cos, sin)
        out = attend(q.reshape(n * h, length, d), k.reshape(n * h, length, d), v.reshape(n * h, length, d), mask)
        return block.proj(out.view(n, h, length, d).transpose(1, 2).reshape(n, length, dim))  # type: ignore[no-any-return]

    def loss(self, batch: Batch, candidates: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Weighted mean cross-entropy over the picks, and the share of sure picks that are right.

        `candidates` (sorted token ids with all wanted ones among them) narrows the softmax.
        """
        return self._answers(batch, self.run(batch, batch.picks).last, candidates)

    def lesson(self, batch: Batch, candidates: Tensor | None, taggers: Taggers) -> Lesson:
        """The losses of answers, sentences and drawings."""
        way = self.run(batch, batch.picks)
        answers, right = self._answers(batch, way.last, candidates)
        middle = way.middle.view(-1, way.middle.shape[-1])[batch.ends]
        return Lesson(answers, right, taggers.sentences(middle, batch.told), taggers.drawings(way.seen, batch.drawn))

    def _answers(self, batch: Batch, picked: Tensor, candidates: Tensor | None) -> tuple[Tensor, Tensor]:
        weight, wanted = self.model.lm_head.weight, batch.wanted
        if candidates is not None:
            weight, wanted = weight[candidates], torch.searchsorted(candidates, wanted)
        logits = F.linear(picked, weight).float()
        each = F.cross_entropy(logits, wanted, reduction="none")
        sure = batch.weights >= 1
        right = (logits.argmax(-1) == wanted)[sure].float().mean()
        return (each * batch.weights).sum() / batch.weights.sum(), right.detach()
