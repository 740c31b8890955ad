"""Several training processes that share every step: gradients are averaged, numbers come from the first.

One thread a process and one exchange a step lose far less on a busy machine than threads that wait for each
other in every product. Uses torch.distributed with gloo over a file.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence

import torch
import torch.distributed as dist
from torch import Tensor, nn


class Ranks:
    """Rank `rank` of `count`; with one rank everything is a no-op."""

    def __init__(self, rank: int, count: int, meeting: str = "") -> None:
        self.rank, self.count = rank, count
        if count > 1:
            os.environ.setdefault("GLOO_SOCKET_IFNAME", "lo")
            dist.init_process_group("gloo", init_method=f"file://{meeting}", rank=rank, world_size=count)

    def average(self, parameters: Iterable[nn.Parameter]) -> None:
        """Gradients to their mean over the ranks, in place; what has none on any rank gets none, since an optimizer
        decays whatever has one."""
        if self.count == 1:
            return
        asked = [p for p in parameters if p.requires_grad]
        having = torch.tensor([float(p.grad is not None) for p in asked])
        dist.all_reduce(having)
        owners = [p for p, ranks in zip(asked, having.tolist(), strict=True) if ranks]
        for p in owners:
            p.grad = torch.zeros_like(p) if p.grad is None else p.grad
        flat = torch.cat([p.grad.float().flatten() for p in owners])  # type: ignore[union-attr]
        dist.all_reduce(flat)
        flat /= self.count
        at = 0
        for p in owners:
            p.grad.copy_(flat[at : at + p.numel()].view_as(p))  # type: ignore[union-attr]
            at += p.numel()

    def from_first(self, *values: float) -> list[float]:
        """The first rank's numbers, on every rank."""
        if self.count == 1:
            return list(values)
        sent: Tensor = torch.tensor(values, dtype=torch.float64)
        dist.broadcast(sent, 0)
        return [float(v) for v in sent]

    def gathered(self, values: Sequence[float]) -> list[list[float]]:
        """Every rank's numbers, by rank and on every rank; each gives as many."""
        if self.count == 1:
            return [list(values)]
        found = [torch.empty(len(values), dtype=torch.float64) for _ in range(self.count)]
        dist.all_gather(found, torch.tensor(values, dtype=torch.float64))
        return [one.tolist() for one in found]

    def close(self) -> None:
        """Leave the group."""
        if self.count > 1:
            dist.destroy_process_group()
