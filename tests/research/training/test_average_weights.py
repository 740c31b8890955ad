"""Weights between two trainings: the ends are the ends, the middle is the mean, and what does not fit is refused."""

from pathlib import Path

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.torch import load_file, save_file
from torch import Tensor

from plugins.backbone.mini import patch_convnet
from research.training.average_weights import MODEL, STACKS, blend, blended
from research.training.deepen_weights import SILENT

LAYERS, BLOCKS = STACKS


def weights_of(layers: int, seed: int) -> dict[str, Tensor]:
    torch.manual_seed(seed)
    parts = {f"{LAYERS}{i}.{part}": torch.randn(3, 3) for i in range(layers) for part in (*SILENT, "norm.weight")}
    return {"embed": torch.randn(4, 3), **parts}


@settings(max_examples=30, deadline=None)
@given(share=st.floats(0.0, 1.0), seed=st.integers(0, 1000))
def test_a_blend_lies_between_both(share: float, seed: int) -> None:
    before, after = weights_of(2, seed), weights_of(2, seed + 1)
    for name, value in blended(before, after, share).items():
        wanted = (1 - share) * before[name] + share * after[name]
        assert torch.allclose(value, wanted, atol=1e-5)


def test_a_shallower_one_is_deepened_first() -> None:
    before, after = weights_of(2, 0), weights_of(3, 1)
    found = blended(before, after, 0.0)
    assert found.keys() == after.keys()
    assert torch.equal(found[f"{LAYERS}2.norm.weight"], before[f"{LAYERS}1.norm.weight"])
    assert not any(found[f"{LAYERS}1.{part}"].any() for part in SILENT)
    half = blended(before, after, 0.5)[f"{LAYERS}1.{SILENT[0]}"]
    assert torch.allclose(half, after[f"{LAYERS}1.{SILENT[0]}"] / 2)


def test_of_towers_too_the_shallower_one_is_deepened_first() -> None:
    before, after = ({**weights_of(2, k), **_blocks(2 + k, k)} for k in (0, 1))
    found = blended(before, after, 0.0)
    assert found.keys() == after.keys()
    assert torch.equal(found[f"{BLOCKS}2.norm.weight"], before[f"{BLOCKS}1.norm.weight"])
    assert not any(found[f"{BLOCKS}1.{part}"].any() for part in SILENT)


def _blocks(count: int, seed: int) -> dict[str, Tensor]:
    return {k.replace(LAYERS, BLOCKS): v for k, v in weights_of(count, seed + 9).items() if k.startswith(LAYERS)}


def test_weights_of_two_architectures_are_refused() -> None:
    with pytest.raises(ValueError, match="different architectures"):
        blended(weights_of(2, 0), {**weights_of(2, 1), "embed": torch.randn(5, 3)}, 0.5)
    with pytest.raises(ValueError, match="different architectures"):
        blended({"embed": torch.randn(4, 3)}, weights_of(2, 1), 0.5)
    with pytest.raises(ValueError, match="start from smaller ones"):
        blended(weights_of(3, 0), weights_of(2, 1), 0.5)


def test_folders_are_blended_and_the_rest_is_kept(tmp_path: Path) -> None:
    for name, seed in (("before", 0), ("after", 1)):
        folder = tmp_path / name
        folder.mkdir()
        save_file(weights_of(2 + seed, seed), folder / MODEL)
        save_file({"conv": torch.full((2,), float(seed)).to(torch.bfloat16)}, folder / patch_convnet.FILE)
        (folder / "config.json").write_text(name)
    (tmp_path / "before" / "north.safetensors").write_text("kept")
    (tmp_path / "before" / "told.safetensors").write_text("of the weights before")
    blend(tmp_path / "before", tmp_path / "after", tmp_path / "out", 0.25)
    assert load_file(tmp_path / "out" / patch_convnet.FILE)["conv"].tolist() == [0.25, 0.25]
    assert load_file(tmp_path / "out" / patch_convnet.FILE)["conv"].dtype == torch.bfloat16
    assert load_file(tmp_path / "out" / MODEL).keys() == weights_of(3, 1).keys()
    assert (tmp_path / "out" / "config.json").read_text() == "after"
    assert (tmp_path / "out" / "north.safetensors").read_text() == "kept"
    assert not (tmp_path / "out" / "told.safetensors").exists(), "no head fits the mean of two states"
