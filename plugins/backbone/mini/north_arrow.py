"""Finds the north arrow of a drawing with a small convolutional network.

A model that cuts a drawing into patches hardly learns to read an arrow of fifteen pixels at any place, and every
compass bearing depends on it. Convolutions find it after a few minutes of training; the drawing is then turned by
quarters until north is up, before the model gets it.

`python -m research.training.train_north --out plugins/backbone/mini/weights` trains it on made drawings.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image
from safetensors.torch import load_file
from torch import Tensor, nn

from plugins.backbone.mini import drawing_view

SHEET = 512
"""Pixels along the longer side of a drawing as the network sees it: more than on the model's sheet, on which an arrow
of ten pixels fades. Smaller drawings keep their size: enlarged, their lines are softer than those of real ones."""
STRIDE = 8
FILE = "north.safetensors"
PRIOR = (0.66, 0.16, 0.04, 0.14)
"""How often drawings are turned by 0 to 3 quarters; an arrow alone is sometimes read backwards, and few drawings hang
upside down."""
Floats = NDArray[np.float32]


def sheet(image: Image.Image, shrink: float = 1.0) -> tuple[Floats, float]:
    """Ink of a drawing at the network's size, (SHEET, SHEET) with white beyond its edges, and the scale (at most
    `shrink`, 1 or less)."""
    scale = shrink * min(1.0, SHEET / max(image.size))
    size = (max(1, round(image.width * scale)), max(1, round(image.height * scale)))
    small = image.convert("L").resize(size, Image.Resampling.BOX)
    out = np.zeros((SHEET, SHEET), np.float32)
    out[: size[1], : size[0]] = (1 - np.asarray(small, np.float32) / 255) ** drawing_view.GAMMA
    return out, scale


class NorthFinder(nn.Module):
    """A map of scores, one for each quarter turn, over places of STRIDE pixels."""

    seen: Tensor
    """Made drawings that it was trained on; further training begins behind them."""

    def __init__(self, width: int = 8) -> None:
        super().__init__()
        plan = ((1, 1, 5, 2), (1, 2, 5, 2), (2, 4, 5, 2), (4, 4, 3, 1), (4, 4, 3, 1), (4, 6, 3, 1))
        layers: list[nn.Module] = []
        for before, after, kernel, stride in plan:
            inputs = 1 if not layers else before * width
            layers.append(nn.Conv2d(inputs, after * width, kernel, stride, kernel // 2, bias=False))
            layers += [nn.BatchNorm2d(after * width), nn.ReLU()]
        self.register_buffer("seen", torch.tensor(0))
        self.layers = nn.Sequential(*layers, nn.Conv2d(6 * width, 5, 1))

    def forward(self, sheets: Tensor) -> Tensor:
        """Logits (B, 5, SHEET / 8, SHEET / 8) of sheets (B, SHEET, SHEET): four quarter turns and "no arrow here"."""
        return self.layers(sheets[:, None])  # type: ignore[no-any-return]

    def scores(self, sheets: Tensor) -> Tensor:
        """Log-odds of an arrow at each quarter turn, (B, 4), summed over places; against 0 for no arrow anywhere."""
        logits: Tensor = self(sheets)
        return (logits[:, :4] - logits[:, 4:]).flatten(2).logsumexp(dim=2)

    @torch.inference_mode()
    def quarters(self, image: Image.Image) -> int:
        """Quarter turns counter-clockwise by which a drawing is turned; one without an arrow counts as upright."""
        found = self.scores(torch.from_numpy(sheet(image)[0])[None])[0] + torch.tensor(PRIOR).log()
        found[0] = torch.logaddexp(found[0], torch.zeros(()))
        return int(found.argmax())

    def upright(self, image: Image.Image) -> Image.Image:
        """The drawing with north up, as far as quarter turns reach."""
        return drawing_view.turn_upright(image, self.quarters(image))


def load(folder: Path) -> NorthFinder | None:
    """The network that lies beside a model's weights, if there is one."""
    if not (folder / FILE).is_file():
        return None
    finder = NorthFinder().eval()
    finder.load_state_dict(load_file(folder / FILE))
    return finder
