"""The eye: cells stand where pixels stood, patches come in the tower's order, weights come back as they went."""

from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image, ImageDraw

from plugins.backbone.mini import drawing_view, patch_convnet
from sgcad_core.errors import ConfigError


def a_drawing(size: tuple[int, int] = (300, 260)) -> Image.Image:
    image = Image.new("RGB", size, "white")
    ImageDraw.Draw(image).rectangle((4, 4, size[0] - 5, size[1] - 5), outline=(200, 0, 0), width=3)
    ImageDraw.Draw(image).line((0, size[1] // 3, size[0], size[1] // 3), fill=(0, 0, 0), width=2)
    return image


@settings(max_examples=25, deadline=None)
@given(rows=st.integers(1, 6), columns=st.integers(1, 6))
def test_patches_come_in_blocks_of_two_by_two(rows: int, columns: int) -> None:
    rows, columns = 2 * rows, 2 * columns
    sheets = torch.zeros(1, 3, rows * drawing_view.PATCH, columns * drawing_view.PATCH, dtype=torch.uint8)
    found = (
        patch_convnet.Eye()
        .patches(sheets)[0]
        .detach()
        .view(rows * columns, patch_convnet.CHANNELS, patch_convnet.SIDE, patch_convnet.SIDE)
    )
    x, y = found[:, -2].mean(dim=(1, 2)).numpy(), found[:, -1].mean(dim=(1, 2)).numpy()
    at = drawing_view.places((rows, columns))
    assert np.array_equal(np.unique(x, return_inverse=True)[1], at[:, 1])
    assert np.array_equal(np.unique(y, return_inverse=True)[1], at[:, 0])


@settings(max_examples=10, deadline=None)
@given(row=st.integers(0, 7), column=st.integers(0, 7))
def test_a_mark_is_seen_where_it_is(row: int, column: int) -> None:
    torch.manual_seed(0)
    looker = patch_convnet.Eye()
    blank = torch.zeros(1, 3, 8 * drawing_view.PATCH, 8 * drawing_view.PATCH, dtype=torch.uint8)
    marked = blank.clone()
    top, left = row * drawing_view.PATCH, column * drawing_view.PATCH
    marked[:, :, top + 8 : top + 16, left + 8 : left + 16] = 255
    for scale in (*looker.norms, *looker.scales):  # statistics of the whole sheet would let a mark be felt everywhere
        scale.forward = lambda x: x  # type: ignore[method-assign]
    differs = (looker(marked) - looker(blank)).abs().amax(dim=1)[0].detach()
    y, x = np.unravel_index(int(differs.argmax()), differs.shape)
    assert abs(y - (row * patch_convnet.SIDE + 1)) <= 1
    assert abs(x - (column * patch_convnet.SIDE + 1)) <= 1


def test_pictures_seen_together_are_seen_alone() -> None:
    sheets = torch.from_numpy(np.stack([drawing_view.look(a_drawing((300 - i, 260)))[0] for i in range(3)]))
    looker = patch_convnet.Eye().eval()
    together = looker.patches(sheets)
    for sheet, patches in zip(sheets, together, strict=True):
        assert torch.allclose(looker.patches(sheet[None])[0], patches, atol=1e-5)


def test_weights_come_back(tmp_path: Path) -> None:
    looker = patch_convnet.Eye().to(torch.bfloat16).float()
    patch_convnet.save(looker, tmp_path)
    patches, grid = patch_convnet.load(tmp_path).patches(a_drawing())
    sheet, its = drawing_view.look(a_drawing())
    assert grid == its
    assert torch.allclose(patches, looker.patches(torch.from_numpy(sheet)[None])[0], atol=1e-6)
    assert not patches.requires_grad


def test_a_folder_without_an_eye_is_told(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"has no eye\.safetensors.*export/"):
        patch_convnet.load(tmp_path)


def test_a_backbone_without_its_eye_says_what_to_do(tmp_path: Path) -> None:
    from plugins.backbone.hf_load import _prepare

    (tmp_path / "preprocessor_config.json").write_text('{"image_processor_type": "MiniImageProcessor"}')
    with pytest.raises(ConfigError, match=r"backbone\.model .* has no eye\.safetensors"):
        _prepare(str(tmp_path), None)
