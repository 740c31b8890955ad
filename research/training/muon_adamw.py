"""Muon for the matrices and AdamW for the rest, in one optimizer with one state and fp32 masters.

Muon (Jordan et al., 2024): momentum whose matrix is made orthogonal by five Newton-Schulz steps. Convolutions are
matrices too, of (out, in * height * width).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor, nn

A, B, C = 3.4445, -4.7750, 2.0315


def orthogonal(g: Tensor, dtype: torch.dtype, steps: int = 5) -> Tensor:
    """The nearest semi-orthogonal matrices to a stack (..., m, n), roughly (singular values 0.7 to 1.2); computed in
    `dtype`, given in that of `g`."""
    x = g.to(dtype)
    tall = x.shape[-2] > x.shape[-1]
    x = x.mT if tall else x
    x = x / (x.norm(dim=(-2, -1), keepdim=True) + 1e-7)
    for _ in range(steps):
        gram = x @ x.mT
        x = A * x + (B * gram + C * gram @ gram) @ x
    found: Tensor = (x.mT if tall else x).to(g.dtype)
    return found


class Optimizer:
    """step(scale) with learning rates times scale; state_dict and load_state_dict for resuming."""

    def __init__(
        self,
        model: nn.Module,
        muon_lr: float,
        adam_lr: float,
        decay: float = 0.01,
        others: Mapping[str, nn.Module] | None = None,
    ) -> None:
        """`others` are further weights under names that begin with theirs; matrices of "heads" are stepped by AdamW."""
        self.muon_lr, self.adam_lr, self.decay = muon_lr, adam_lr, decay
        self.live = dict(model.named_parameters())
        for name, other in (others or {}).items():
            self.live |= {f"{name}.{k}": p for k, p in other.named_parameters()}
        named = {k: p.detach().to(torch.float32).clone().requires_grad_() for k, p in self.live.items()}
        self.master = named
        self.matrices = {
            k: p
            for k, p in named.items()
            if p.ndim >= 2 and "embed_tokens" not in k and "lm_head" not in k and not k.startswith("heads.")
        }
        rest = [p for k, p in named.items() if k not in self.matrices]
        self.momentum = {k: torch.zeros_like(p) for k, p in self.matrices.items()}
        self.adam = torch.optim.AdamW(rest, lr=adam_lr, betas=(0.9, 0.98), weight_decay=0.0)

    def step(self, scale: float, clip: float = 1.0) -> None:
        """One step on the fp32 masters, then the model's weights are set from them; clears its gradients."""
        for key, p in self.live.items():
            self.master[key].grad = None if p.grad is None else p.grad.float()
            p.grad = None
        nn.utils.clip_grad_norm_(self.master.values(), clip)
        for group in self.adam.param_groups:
            group["lr"] = self.adam_lr * scale
        self.adam.step()
        shapes: dict[tuple[int, ...], list[str]] = defaultdict(list)
        for key, matrix in self.matrices.items():
            if matrix.grad is not None:
                shapes[tuple(matrix.shape)].append(key)
        with torch.no_grad():
            for keys in shapes.values():
                self._muon(keys, scale)
            self.publish()

    def publish(self) -> None:
        """Masters to the model."""
        with torch.no_grad():
            for key, p in self.live.items():
                p.copy_(self.master[key])

    def _muon(self, keys: list[str], scale: float) -> None:
        """All matrices of one shape at once."""
        grads, dtype = [], self.live[keys[0]].dtype
        for key in keys:
            grad, momentum = self.matrices[key].grad, self.momentum[key]
            assert grad is not None  # noqa: S101 - step() chose these
            momentum.lerp_(grad, 0.05)
            grads.append(grad.lerp(momentum, 0.95).flatten(1))
        rows, columns = grads[0].shape
        updates = orthogonal(torch.stack(grads), dtype)
        rate = self.muon_lr * scale
        for key, update in zip(keys, updates, strict=True):
            p = self.matrices[key]
            p.mul_(1 - rate * self.decay)
            p.add_(update.view_as(p), alpha=-rate * max(1.0, rows / columns) ** 0.5)

    def state_dict(self) -> dict[str, Any]:
        """Everything that a resumed run needs."""
        return {
            "master": {k: p.detach() for k, p in self.master.items()},
            "momentum": self.momentum,
            "adam": self.adam.state_dict(),
        }

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Restore it."""
        for key, value in state["momentum"].items():
            self.momentum[key].copy_(value)
        with torch.no_grad():
            for key, value in state["master"].items():
                self.master[key].copy_(value)
        self.publish()
        self.adam.load_state_dict(state["adam"])
