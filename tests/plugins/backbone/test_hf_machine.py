"""What `sgcad check` says of a model that this machine cannot run yet, or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch
from pydantic import ValidationError

from plugins.backbone import hf_machine
from plugins.backbone.engine import packing
from plugins.backbone.hf_vision import HfVision
from plugins.decoder.cad import Cad
from research.benchmarks.decoding.family_models import FAMILIES, save
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.settings import ROOT
from tests.plugins.backbone import folders

BY_NAME = {family.name: family for family in FAMILIES}


def test_weights_that_are_not_here_are_told_with_the_command() -> None:
    (line,) = HfVision(model="nobody/no-such-model-7B").offers(Cad())
    assert line == (
        "backbone: the weights of nobody/no-such-model-7B are not on this machine: hf download nobody/no-such-model-7B"
    )


def test_packages_that_are_missing_are_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(packing, "find_spec", lambda _: None)
    folder = str(folders.save("text_only", tmp_path))
    found = hf_machine.lacks(folder, None, "auto", "int4")
    assert [line.split(" is not")[0] for line in found] == [
        "backbone: the package accelerate", "backbone: the package bitsandbytes"
    ]  # fmt: skip
    assert all("pip install 'sg-cadvlm[gpu]'" in line for line in found)


def packed(folder: Path, method: str) -> str:
    """A folder whose config says that its weights are packed."""
    file = folders.save("text_only", folder) / "config.json"
    known = json.loads(file.read_text()) | {"quantization_config": {"quant_method": method, "bits": 4}}
    file.write_text(json.dumps(known))
    return str(folder)


@pytest.mark.parametrize(
    ("method", "missing"),
    [("gptq", "gptqmodel"), ("awq", "gptqmodel"), ("compressed-tensors", "compressed-tensors"), ("fp8", "accelerate")],
)
def test_packages_of_packed_weights_are_told_before_they_load(
    method: str, missing: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(packing, "find_spec", lambda _: None)
    folder = packed(tmp_path, method)
    assert any(missing in line for line in HfVision(model=folder).offers(Cad()))
    with pytest.raises(MissingTool, match="is not installed: pip install"):
        HfVision(model=folder, device="cpu").load()


def test_weights_are_not_packed_twice_nor_by_a_method_that_was_never_tried(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"int4: the weights of .* are packed already \(awq\); set none"):
        HfVision(model=packed(tmp_path / "a", "awq"), quantization="int4").offers(Cad())
    with pytest.raises(ConfigError, match="packed by vptq, which was never tried here; use one of awq, gptq, fp8"):
        HfVision(model=packed(tmp_path / "b", "vptq")).offers(Cad())


@pytest.mark.parametrize(
    ("there", "told"), [(None, "there is none here"), ((8, 0), "the one here has 8.0"), ((9, 0), "")]
)
def test_fp8_names_the_card_that_it_needs(
    there: tuple[int, int] | None, told: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(torch.cuda, "is_available", lambda: there is not None)
    monkeypatch.setattr(torch.cuda, "get_device_capability", lambda: there)
    lines = hf_machine.lacks(str(folders.save("text_only", tmp_path)), None, None, "fp8")
    assert [line for line in lines if "compute capability 8.9 or higher" in line] == [
        line for line in lines if told and told in line
    ]
    assert len([line for line in lines if "capability" in line]) == bool(told)
    if told:
        with pytest.raises(MissingTool, match="fp8 computes on a graphics card"):
            HfVision(model=str(tmp_path), quantization="fp8", device="cpu").load()


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"tp_plan": "auto"}, "one process a card.*--tensor-parallel-size.*openai_server"),
        ({"attn_implementation": "flash_attention_2"}, "masks that flash attention 2 and 3 do not know; use sdpa"),
    ],
)
def test_settings_that_the_loop_cannot_follow_are_refused_with_their_reason(
    fields: dict[str, str], reason: str
) -> None:
    with pytest.raises(ValidationError, match=reason):
        HfVision.model_validate({"model": "x", **fields})


def test_a_file_that_is_not_here_is_told(tmp_path: Path) -> None:
    (line,) = hf_machine.lacks(str(tmp_path / "none.gguf"), None, None, "none")
    assert "there is no file" in line


def test_nothing_is_said_of_a_model_that_is_here_and_runs(tmp_path: Path) -> None:
    assert hf_machine.lacks(str(folders.save("llava", tmp_path)), None, None, "none") == ()
    assert hf_machine.lacks(str(ROOT / "plugins/backbone/mini/weights"), None, None, "none") == ()


def test_a_family_that_cannot_run_is_refused_by_the_check(tmp_path: Path) -> None:
    folder = save(BY_NAME["PaliGemma"], tmp_path)
    with pytest.raises(ConfigError, match="paligemma reads its whole prompt in both directions"):
        HfVision(model=str(folder)).offers(Cad())
