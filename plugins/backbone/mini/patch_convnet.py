"""The eye: a few convolutions between the pixels of a drawing and the patches of the vision tower.

A lane line may cross a patch anywhere, so a model that gets patches of pixels learns lines slowly. Convolutions do not
depend on the place; with them the vision tower learned as much from 9,000 drawings as from 100,000 without. The tower
is unchanged: the eye gives "pictures" of many channels, cut into patches of 3 x 3 cells, so that model and loader see a
Qwen2.5-VL. The eye is trained with the weights and stored beside them.
"""

from __future__ import annotations

from pathlib import Path

import torch
from PIL import Image
from safetensors.torch import load_file, save_file
from torch import Tensor, nn
from torch.nn import functional as F

from plugins.backbone.mini import drawing_view, north_arrow

CELL = 8
"""Pixels of a drawing's sheet along a cell, the stride of the eye."""
SIDE = drawing_view.PATCH // CELL
"""Cells along a patch."""
WIDTH = 64
CHANNELS = WIDTH + 2
"""Channels of a cell: the eye's features and the cell's place."""
FILE = "eye.safetensors"


class Eye(nn.Module):
    """Sheets to cells; weights in any floating dtype."""

    def __init__(self) -> None:
        super().__init__()
        plan = ((3, WIDTH // 4, 5), (WIDTH // 4, WIDTH // 2, 3), (WIDTH // 2, WIDTH, 3))
        self.down = nn.ModuleList(nn.Conv2d(a, b, k, 2, k // 2) for a, b, k in plan)
        self.norms = nn.ModuleList(nn.GroupNorm(4, b) for _, b, _ in plan)
        self.across = nn.Conv2d(WIDTH, WIDTH, 3, 1, 1)
        self.around = nn.ModuleList(nn.Conv2d(WIDTH, WIDTH, 3, 1, d, dilation=d) for d in (2, 4))
        """With these a cell sees 129 pixels around it: a whole road, whose lanes it can count."""
        scales = [nn.GroupNorm(4, WIDTH) for _ in self.around]
        for scale in scales:
            nn.init.zeros_(scale.weight)
        self.scales = nn.ModuleList(scales)

    def forward(self, sheets: Tensor) -> Tensor:
        """Sheets (N, 3, H, W) of bytes to cells (N, CHANNELS, H / 8, W / 8)."""
        x = sheets.to(self.across.weight.dtype) / 255
        for down, scale in zip(self.down, self.norms, strict=True):
            x = F.relu(scale(down(x)))
        x = x + F.relu(self.across(x))
        for around, scale in zip(self.around, self.scales, strict=True):
            x = x + scale(F.relu(around(x)))
        place = torch.from_numpy(drawing_view.place(*x.shape[2:])).to(x)
        return torch.cat((x, place.expand(len(x), -1, -1, -1)), dim=1)

    def patches(self, sheets: Tensor) -> Tensor:
        """Patches (N, P, CHANNELS * SIDE * SIDE) in the order that the tower merges them: blocks of 2 x 2."""
        cells = self(sheets)
        n, channels, height, width = cells.shape
        cut = cells.view(n, channels, height // (2 * SIDE), 2, SIDE, width // (2 * SIDE), 2, SIDE)
        found: Tensor = cut.permute(0, 2, 5, 3, 6, 1, 4, 7).reshape(n, -1, channels * SIDE * SIDE)
        return found


class Sight:
    """The steps between a drawing and the vision tower: the north finder, if there is one, and the eye."""

    def __init__(self, eye: Eye, finder: north_arrow.NorthFinder | None = None) -> None:
        self.eye, self.finder = eye, finder

    def upright(self, image: Image.Image) -> Image.Image:
        """The drawing with north up, as far as that is found."""
        return self.finder.upright(image) if self.finder else image

    @torch.no_grad()
    def patches(self, image: Image.Image, view: int = 0) -> tuple[Tensor, tuple[int, int]]:
        """Patches (P, CHANNELS * SIDE * SIDE) of a drawing as it was drawn, and its grid (rows, columns)."""
        sheet, grid = drawing_view.look(self.upright(image), view)
        return self.eye.patches(torch.from_numpy(sheet)[None])[0], grid


def save(eye: Eye, folder: Path) -> None:
    """Writes the eye, in bf16, beside a model's weights."""
    weights = {k: v.detach().to("cpu", torch.bfloat16).contiguous() for k, v in eye.state_dict().items()}
    save_file(weights, folder / FILE)


def load(folder: Path) -> Sight:
    """Eye and north finder of a folder of weights, in fp32. Raises FileNotFoundError if the folder has no eye."""
    if not (folder / FILE).is_file():
        raise FileNotFoundError(
            f"{folder} has no {FILE}, without which this model sees no drawing; take the whole folder that training "
            "wrote (export/)"
        )
    eye = Eye().eval()
    eye.load_state_dict({k: v.float() for k, v in load_file(folder / FILE).items()})
    return Sight(eye, north_arrow.load(folder))
