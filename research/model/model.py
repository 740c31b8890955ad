"""The architecture: Qwen2.5-VL from its config, small, and a forward made for training on padded batches.

The modules are transformers' own, so that names, initialization, saving and loading are theirs; only the way
through them is written anew: attention as two batched matrix products (faster than SDPA at these shapes on a
CPU), pictures padded to one length, logits only where a loss is wanted.
"""

from __future__ import annotations

import math
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional as F
from transformers import Qwen2_5_VLConfig, Qwen2_5_VLForConditionalGeneration

from plugins.backbone.mini.patch_convnet import CHANNELS, SIDE, Eye
from research.model.batch import Batch, Lesson, Pass, Taggers
from research.model.fast_layers import attend, causal, norm, rotate

MERGE = 2


def make_config(vocabulary: int, special: dict[str, int], size: str = "mini") -> Qwen2_5_VLConfig:
    """The config of a size: "mini" (about 8.5 M parameters) or "tiny" for tests."""
    hidden, layers, heads, inner, depth, vision = {"mini": (192, 16, 4, 512, 6, 128), "tiny": (64, 2, 2, 96, 1, 32)}[
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
            "patch_size": SIDE,
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


class Forward:
    """A fast way through a Qwen2_5_VLForConditionalGeneration and the eye before it, in the dtype of its weights."""

    def __init__(self, model: Qwen2_5_VLForConditionalGeneration, eye: Eye) -> None:
        self.model, self.eye = model, eye
        self.text = model.model.language_model
        self.vision = model.model.visual
        self.heads = model.config.text_config.num_attention_heads
        self.kv = model.config.text_config.num_key_value_heads
        self.text_inv = self.text.rotary_emb.original_inv_freq.float().clone()
        self.middle = max(1, round(len(self.text.layers) * 0.59))
        """Layers after which a sentence's end is asked what it told; the rest carry it to the answers. Of six to
        fourteen layers that grow by two (`research.training.deepen_weights`), and of twelve that grow by four, they end
        with the same old one as before."""
        self.early = max(1, round(self.middle * 0.6))
        """Layers after which the end of a phrase is asked, so that the sentence's end may put phrases together. A model
        that grows (`research.training.deepen_weights`) may be asked at another old layer than before."""
        self.vision_inv = self.vision.rotary_pos_emb.original_inv_freq.float().clone()

    @property
    def dtype(self) -> torch.dtype:
        """Of the weights."""
        dtype: torch.dtype = self.model.lm_head.weight.dtype
        return dtype

    def hidden(self, batch: Batch) -> Tensor:
        """Last hidden states (B, L, hidden), normed."""
        return self.run(batch).last

    def seen(self, batch: Batch) -> Tensor:
        """Tokens of all pictures in the order of `patch_index`, (sum of picture tokens, hidden)."""
        if not batch.sheets:
            return torch.zeros(0, self.model.lm_head.weight.shape[1], dtype=self.dtype, device=batch.ids.device)
        found = self.pictures(self.patches(batch), batch.grids, batch.lengths)
        return found.reshape(-1, found.shape[-1])[batch.patch_index]

    def patches(self, batch: Batch) -> Tensor:
        """Patches of all pictures, padded, (N, P, CHANNELS * SIDE * SIDE)."""
        room = batch.grids.shape[1]
        seen = [self.eye.patches(sheets) for sheets in batch.sheets]
        return torch.cat([F.pad(patches, (0, 0, 0, room - patches.shape[1])) for patches in seen])

    def embedded(self, batch: Batch) -> tuple[Tensor, Tensor]:
        """What the first layer is given, (B, L, hidden), and the picture tokens in it as `seen` gives them."""
        x, seen = self.text.embed_tokens(batch.ids), self.seen(batch)
        if len(seen):
            x = x.view(-1, x.shape[-1]).index_copy(0, batch.image_index, seen).view(x.shape)
        return x, seen

    def run(self, batch: Batch, places: Tensor | None = None) -> Pass:
        """The whole way; last states at flat `places` only, (M, hidden), if they are given."""
        x, seen = self.embedded(batch)
        early, middle, queries, keys = x, x, None, None
        cos, sin = self._rope(batch.positions)
        mask = torch.full((x.shape[1], x.shape[1]), float("-inf"), device=x.device, dtype=x.dtype).triu(1)
        for number, layer in enumerate(self.text.layers, 1):
            q, k, v = self._projected(layer.self_attn, norm(layer.input_layernorm, x), cos, sin)
            if number == self.middle + 1:
                queries, keys = q[:, : self.heads // self.kv], k[:, 0]
            x = x + self._attention(layer.self_attn, q, k, v, mask)
            if places is not None and layer is self.text.layers[-1]:
                x = x.view(-1, x.shape[-1])[places]
            x = x + self._mlp(layer.mlp, norm(layer.post_attention_layernorm, x))
            early = x if number == self.early else early
            middle = x if number == self.middle else middle
        return Pass(norm(self.text.norm, x), early, middle, seen, queries, keys)

    def _rope(self, positions: Tensor) -> tuple[Tensor, Tensor]:
        """cos and sin, (B, 1, L, D / 2)."""
        angles = positions[..., None].float() * self.text_inv.to(positions.device)
        parts = angles.split(list(self.text.rotary_emb.mrope_section), dim=-1)
        one = torch.cat([part[i % 3] for i, part in enumerate(parts)], dim=-1)[:, None]
        return one.cos().to(self.dtype), one.sin().to(self.dtype)

    def _projected(self, block: Any, x: Tensor, cos: Tensor, sin: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Queries (B, heads, L, d), scaled, keys and values (B, kv, L, d), turned by their positions."""
        b, length, _ = x.shape
        projections = (block.q_proj, block.k_proj, block.v_proj)
        weight, bias = torch.cat([p.weight for p in projections]), torch.cat([p.bias for p in projections])
        parts = F.linear(x, weight, bias).view(b, length, self.heads + 2 * self.kv, -1).transpose(1, 2)
        q, k, v = parts.split((self.heads, self.kv, self.kv), dim=1)
        d = q.shape[-1]
        return rotate(q, cos * d**-0.5, sin * d**-0.5), rotate(k, cos, sin), v

    def _attention(self, block: Any, q: Tensor, k: Tensor, v: Tensor, mask: Tensor) -> Tensor:
        b, _, length, d = q.shape
        dim = self.heads * d
        k, v = (part.reshape(b * self.kv, length, d) for part in (k, v))
        out = causal(q.reshape(b * self.kv, self.heads // self.kv, length, d), k, v, mask)
        given: Tensor = block.o_proj(out.view(b, self.heads, length, d).transpose(1, 2).reshape(b, length, dim))
        return given

    @staticmethod
    def _mlp(block: Any, x: Tensor) -> Tensor:
        bias = None if block.gate_proj.bias is None else torch.cat((block.gate_proj.bias, block.up_proj.bias))
        gate, up = F.linear(x, torch.cat((block.gate_proj.weight, block.up_proj.weight)), bias).chunk(2, dim=-1)
        given: Tensor = block.down_proj(F.silu(gate) * up)
        return given

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
        """The losses of answers, sentences, phrases, drawings and pointers."""
        way = self.run(batch, batch.picks)
        answers, right = self._answers(batch, way.last, candidates)
        return Lesson(
            answers,
            right,
            taggers.sentences(way.middle.flatten(0, 1)[batch.ends], batch.sentence_tags),
            taggers.phrases(way.early.flatten(0, 1)[batch.phrases], batch.noted),
            taggers.drawings(way.seen, batch.drawn),
            self._pointers(batch, way),
        )

    @staticmethod
    def _pointers(batch: Batch, way: Pass) -> Tensor:
        """Mean -log of the attention that values pay to what tells them; the first group of heads behind `middle`."""
        assert way.queries is not None  # noqa: S101 - lesson() ran all layers
        assert way.keys is not None  # noqa: S101
        if not len(batch.pointing):
            return way.queries.sum() * 0
        length = batch.ids.shape[1]
        row, at = batch.pointing // length, batch.pointing % length
        queries, keys = way.queries[row, :, at], way.keys[row]
        scores = torch.einsum("qgd,qld->qgl", queries, keys).float()
        later = torch.arange(length, device=at.device)[None] > at[:, None]
        shares = scores.masked_fill(later[:, None], float("-inf")).log_softmax(dim=-1)
        return -shares.masked_fill(~batch.sources[:, None], float("-inf")).logsumexp(dim=-1).mean()

    def _answers(self, batch: Batch, picked: Tensor, candidates: Tensor | None) -> tuple[Tensor, Tensor]:
        """-log of what all tokens allowed have together, weighted mean; and the share of sure picks that are right."""
        weight, allowed = self.model.lm_head.weight, batch.allowed
        known = allowed >= 0
        if candidates is not None:
            weight, allowed = weight[candidates], torch.searchsorted(candidates, allowed.clamp(min=0))
        logits = F.linear(picked, weight).float()
        within = logits.gather(1, allowed.clamp(min=0)).masked_fill(~known, float("-inf")).logsumexp(-1)
        each = logits.logsumexp(-1) - within
        sure = batch.weights >= 1
        hit = (logits.argmax(-1, keepdim=True) == allowed) & known
        right = hit.any(-1)[sure].float().mean()
        return (each * batch.weights).sum() / batch.weights.sum(), right.detach()
