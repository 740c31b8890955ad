"""What `sgcad check` says of a model that this machine cannot run yet, or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from plugins.backbone import hf_machine
from plugins.backbone.hf_vision import HfVision
from plugins.decoder.cad import Cad
from research.benchmarks.decoding.family_models import FAMILIES, save
from sgcad_core.errors import ConfigError
from sgcad_core.settings import ROOT
from tests.plugins.backbone import folders

BY_NAME = {family.name: family for family in FAMILIES}


def test_weights_that_are_not_here_are_told_with_the_command() -> None:
    (line,) = HfVision(model="nobody/no-such-model-7B").offers(Cad())
    assert line == (
        "backbone: the weights of nobody/no-such-model-7B are not on this machine: hf download nobody/no-such-model-7B"
    )


def test_packages_that_are_missing_are_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(hf_machine, "find_spec", lambda _: None)
    folder = str(folders.save("text_only", tmp_path))
    found = hf_machine.lacks(folder, None, "auto", "int4")
    assert [line.split(" is not")[0] for line in found] == [
        "backbone: the package accelerate", "backbone: the package bitsandbytes"
    ]  # fmt: skip
    assert all("pip install 'sg-cadvlm[gpu]'" in line for line in found)


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
