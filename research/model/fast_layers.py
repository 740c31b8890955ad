"""Pieces of a fast way through Qwen2.5-VL: rotary embedding, attention in blocks, RMS norm with few passes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import torch
from torch import Tensor


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
    apply: Callable[..., Tensor] = _RmsNorm.apply
    return apply(x, layer.weight, layer.variance_epsilon)
