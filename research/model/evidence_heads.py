"""The file of heads that say whether the evidence tells a value, and how they are fitted. Knows no report.

A head is a logistic regression on the state before a value's first token, (hidden,): weights (hidden + 1,), the
constant last. The file names the weights of the model that it was fitted on, since it means nothing with others.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import torch
from safetensors.torch import save_file
from torch import Tensor
from torch.nn import functional as F

from sgcad_core.system.digest import file_sha256

FILE = "told.safetensors"
MODEL = "model.safetensors"
DECAY = 1e-3


def save(heads: Mapping[str, Tensor], folder: Path) -> None:
    """Write the heads beside the weights that they were fitted on."""
    save_file(dict(heads), folder / FILE, metadata={"format": "pt", "model": file_sha256(folder / MODEL)})


def fit(seen: Tensor, told: Tensor) -> Tensor:
    """Weights of a logistic regression (L2) of `told` (values,) on `seen` (values, hidden)."""
    scale, middle = seen.std(dim=0).clamp(min=1e-6), seen.mean(dim=0)
    x, y = (seen - middle) / scale, told.float()
    weights = torch.zeros(seen.shape[1] + 1, requires_grad=True)
    optimizer = torch.optim.LBFGS([weights], max_iter=100, line_search_fn="strong_wolfe")

    def closure() -> Tensor:
        optimizer.zero_grad()
        loss = F.binary_cross_entropy_with_logits(x @ weights[:-1] + weights[-1], y)
        loss = loss + DECAY * weights[:-1].square().sum()
        loss.backward()
        return loss

    optimizer.step(closure)
    found = weights.detach()
    slope = found[:-1] / scale
    return torch.cat([slope, (found[-1] - slope @ middle)[None]])


def right_and_ordered(weights: Tensor, seen: Tensor, told: Tensor) -> tuple[float, float]:
    """Share of values that a head has right, and the share of pairs of a told and an untold one in order (AUC)."""
    logits = seen @ weights[:-1] + weights[-1]
    yes, no = logits[told], logits[~told]
    ordered = (yes[:, None] > no[None]).float().mean() + (yes[:, None] == no[None]).float().mean() / 2
    return float(((logits > 0) == told).float().mean()), float(ordered)
