"""An adapter in the weights: the same logits as PEFT's own, and every way in which a folder is none that fits."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import torch
from pydantic import ValidationError

from plugins.backbone import hf_adapter
from plugins.backbone.hf_load import load
from plugins.backbone.hf_vision import HfVision
from plugins.decoder.greedy import Greedy
from sgcad_core.case.records import Query
from sgcad_core.errors import ConfigError, MissingTool
from tests.plugins.backbone import folders, tiny

pytest.importorskip("peft", reason="the extra adapters is not there")
from tests.plugins.backbone import adapters

QUERY = Query(task="Describe the road.", answer_schema=tiny.SCHEMA)


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folders.save("text_only", tmp_path_factory.mktemp("base"))


@pytest.fixture
def adapter(tmp_path: Path) -> Path:
    adapters.save(tmp_path / "adapter")
    return tmp_path / "adapter"


@torch.no_grad()
def test_merged_weights_answer_as_peft_does_and_otherwise_than_the_base(base: Path, tmp_path: Path) -> None:
    reference = adapters.save(tmp_path / "adapter")
    ids = torch.tensor([tiny.words(12, 3)])
    told = load(str(base), None, {}, "cpu", "none", str(tmp_path / "adapter")).model(ids).logits
    assert torch.allclose(told, reference(ids).logits, atol=1e-4)
    assert not torch.allclose(told, load(str(base), None, {}, "cpu", "none").model(ids).logits, atol=0.1)


def test_nothing_of_peft_is_left_in_a_merged_model(base: Path, adapter: Path) -> None:
    model = load(str(base), None, {}, "cpu", "none", str(adapter)).model
    assert type(model).__name__ == "LlamaForCausalLM"
    assert not [name for name, _ in model.named_parameters() if "lora" in name]


def test_a_folder_is_also_found_from_the_projects_root(adapter: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hf_adapter.settings, "ROOT", adapter.parent)
    assert hf_adapter.folder_of("adapter") == adapter


def test_a_missing_folder_is_told_before_the_model_is_loaded(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"there is no folder .*nowhere; name one that exists"):
        hf_adapter.folder_of(str(tmp_path / "nowhere"))


def test_a_folder_without_adapter_is_told(base: Path) -> None:
    with pytest.raises(ConfigError, match=r"has no adapter_config\.json and no adapter_model\.safetensors"):
        load(str(base), None, {}, "cpu", "none", str(base))


@pytest.mark.parametrize("text", ["no JSON", "{}", "[]"])
def test_a_config_that_is_no_adapters_is_told(base: Path, adapter: Path, text: str) -> None:
    (adapter / "adapter_config.json").write_text(text)
    with pytest.raises(ConfigError, match="is no adapter's"):
        load(str(base), None, {}, "cpu", "none", str(adapter))


def test_another_kind_of_adapter_is_told(base: Path, adapter: Path) -> None:
    config = json.loads((adapter / "adapter_config.json").read_text()) | {"peft_type": "PREFIX_TUNING"}
    (adapter / "adapter_config.json").write_text(json.dumps(config))
    with pytest.raises(ConfigError, match="its peft_type is 'PREFIX_TUNING'; only 'LORA'"):
        load(str(base), None, {}, "cpu", "none", str(adapter))


def test_broken_weights_are_told(base: Path, adapter: Path) -> None:
    (adapter / "adapter_model.safetensors").write_bytes(b"no weights")
    with pytest.raises(ConfigError, match="does not fit the model"):
        load(str(base), None, {}, "cpu", "none", str(adapter))


def _llama(**changed: int) -> object:
    import transformers as tf

    return tf.LlamaForCausalLM(tf.LlamaConfig(**{**tiny._TEXT, **changed}))


@pytest.mark.parametrize("changed", [{"hidden_size": 32}, {"num_hidden_layers": 5}, {"num_hidden_layers": 1}])
def test_an_adapter_of_another_base_is_told(base: Path, tmp_path: Path, changed: dict[str, int]) -> None:
    adapters.save(tmp_path, _llama(**changed))
    with pytest.raises(ConfigError, match=r"does not fit the model \(LlamaForCausalLM\): .*use the base model"):
        load(str(base), None, {}, "cpu", "none", str(tmp_path))


def test_modules_that_the_base_has_not_are_told(base: Path, adapter: Path) -> None:
    config = json.loads((adapter / "adapter_config.json").read_text()) | {"target_modules": ["c_attn"]}
    (adapter / "adapter_config.json").write_text(json.dumps(config))
    with pytest.raises(ConfigError, match=r"does not fit the model .*c_attn"):
        load(str(base), None, {}, "cpu", "none", str(adapter))


def test_a_missing_peft_is_told_with_its_command(base: Path, adapter: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hf_adapter, "find_spec", lambda name: None)
    with pytest.raises(MissingTool, match=r"needs the package peft: pip install 'sg-cadvlm\[adapters\]'"):
        load(str(base), None, {}, "cpu", "none", str(adapter))


def test_quantized_weights_take_no_adapter() -> None:
    with pytest.raises(ValidationError, match="set quantization none, not int4"):
        HfVision(model="x", adapter="y", quantization="int4")


def test_backbones_of_other_adapters_share_no_model(base: Path, adapter: Path, tmp_path: Path) -> None:
    adapters.save(tmp_path / "second", seed=1)
    names = [None, str(adapter), str(tmp_path / "second")]
    some = [HfVision(model=str(base), device="cpu", adapter=name, max_new_tokens=120) for name in [*names, names[1]]]
    plain, first, second, again = (one._loaded() for one in some)
    assert first is again
    assert len({id(one) for one in (plain, first, second)}) == 3
    assert len({one.stamp for one in some}) == 3
    said = [one.generate(folders.context(pictures=0), QUERY, Greedy()) for one in some[:3]]
    assert len({tuple(token.logp_with_context for token in one.tokens) for one in said}) == 3


def test_the_stamp_follows_the_adapters_files(base: Path, adapter: Path) -> None:
    before = HfVision(model=str(base), adapter=str(adapter)).stamp
    shutil.rmtree(adapter)
    adapters.save(adapter, seed=1)
    assert HfVision(model=str(base), adapter=str(adapter)).stamp != before
