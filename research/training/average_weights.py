"""The mean of two trainings: weights before a training and behind it, blended, read better than either.

A training of two hours drifts from what a longer one had settled; the straight way between both states keeps what
both know (Wortsman et al. 2022, "Robust fine-tuning of zero-shot models"). A shallower model is deepened first, which
changes none of its answers.
"""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file
from torch import Tensor

from plugins.backbone.mini import patch_convnet
from research.model import evidence_heads
from research.model.evidence_heads import MODEL as MODEL
from research.training.deepen_weights import deepened, depth

STACKS = ("model.layers.", "visual.blocks.")
"""What a saved model calls its text layers and the blocks of its vision tower."""


def blended(before: Mapping[str, Tensor], after: Mapping[str, Tensor], share: float) -> dict[str, Tensor]:
    """Weights by name: `share` of those after, the rest of those before; dtypes are those after.

    Raises:
        ValueError: both are not weights of one architecture, however deep.
    """
    early = dict(before)
    for stack in STACKS:
        layers = depth(after, stack)
        early = deepened(early, layers, stack) if layers and depth(early, stack) else early
    if early.keys() != after.keys() or any(early[name].shape != after[name].shape for name in after):
        raise ValueError("the two folders hold weights of different architectures: blend states of one training")
    mean = {name: torch.lerp(early[name].float(), value.float(), share) for name, value in after.items()}
    return {name: value.to(after[name].dtype).contiguous() for name, value in mean.items()}


def blend(before: Path, after: Path, out: Path, share: float) -> None:
    """Write a folder of weights between two exported ones; other files come from `after`, then `before`."""
    for folder in (before, after):
        shutil.copytree(folder, out, dirs_exist_ok=True)
    (out / evidence_heads.FILE).unlink(missing_ok=True)  # heads are of the weights that they were fitted on
    for name in (MODEL, patch_convnet.FILE):
        mean = blended(load_file(before / name), load_file(after / name), share)
        save_file(mean, out / name, metadata={"format": "pt"})


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m research.training.average_weights", description=__doc__)
    parser.add_argument("before", type=Path, help="exported weights that a training began with")
    parser.add_argument("after", type=Path, help="the export of that training")
    parser.add_argument("out", type=Path)
    parser.add_argument("--share", type=float, default=0.5, help="of the weights after the training (0 to 1)")
    options = parser.parse_args(arguments)
    blend(options.before, options.after, options.out, options.share)


if __name__ == "__main__":
    main()
