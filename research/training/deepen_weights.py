"""Deeper models out of trained ones, equal to them at first: training goes on where the smaller one stopped."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

LAYERS = "model.language_model.layers."
BLOCKS = "model.visual.blocks."
"""What a model calls its text layers and the blocks of its vision tower."""
SILENT = ("self_attn.o_proj.weight", "attn.proj.weight", "attn.proj.bias", "mlp.down_proj.weight", "mlp.down_proj.bias")
"""What a layer adds to its input comes through these."""


def depth(weights: Mapping[str, Tensor], prefix: str = LAYERS) -> int:
    """Layers in weights by name; 0 where no name starts with `prefix` and a number."""
    return 1 + max(
        (int(name[len(prefix) :].partition(".")[0]) for name in weights if name.startswith(prefix)), default=-1
    )


def places(found: int, layers: int) -> list[int]:
    """Where `found` old layers stand among `layers`: in order, spread evenly, the first and the last at the ends."""
    return [i * (layers - 1) // max(1, found - 1) for i in range(found)]


def deepened(weights: Mapping[str, Tensor], layers: int, prefix: str = LAYERS) -> dict[str, Tensor]:
    """`weights` by parameter name, with `layers` layers, at least as many as there are; their names start with `prefix`
    and a number.

    The old layers keep their order and spread evenly; each new one copies the one before it and adds nothing yet
    (its outputs are zero), so that the answers stay the same and gradients find features at once.

    Raises:
        ValueError: fewer layers are asked for than the weights have.
    """
    found = depth(weights, prefix)
    if layers < found:
        raise ValueError(
            f"weights of {found} layers ({prefix}) cannot begin a model of {layers}: start from smaller ones"
        )
    old = places(found, layers)
    grown = {name: value for name, value in weights.items() if not name.startswith(prefix)}
    for place in range(layers):
        source = max(i for i in range(found) if old[i] <= place)
        own = f"{prefix}{source}."
        for name, value in weights.items():
            if name.startswith(own):
                part = name.removeprefix(own)
                silent = part in SILENT and old[source] != place
                grown[f"{prefix}{place}.{part}"] = torch.zeros_like(value) if silent else value.clone()
    return grown
