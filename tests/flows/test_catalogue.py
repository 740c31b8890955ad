"""Whether a model fits, told from its folder or its name before anything is loaded."""

from pathlib import Path

import pytest

from flows import catalogue
from plugins.backbone.hf_vision import weights_gb
from sgcad_core.config import load

CARDS = {"gpus": ["NVIDIA H100 80GB HBM3, 81559 MiB", "NVIDIA H100 80GB HBM3, 81559 MiB"], "memory_gib": 128.0}
LAPTOP = {"gpus": [], "memory_gib": 16.0}


@pytest.mark.parametrize(
    ("name", "dtype", "quantization", "gb"),
    [
        ("Qwen/Qwen2.5-VL-72B-Instruct", "bfloat16", "none", 144),
        ("Qwen/Qwen2.5-VL-7B-Instruct", "float32", "none", 28),
        ("Qwen/Qwen2.5-VL-72B-Instruct", "bfloat16", "int4", 44.64),
        ("llava-hf/llava-1.5-7b-hf", "auto", "none", 14),
        ("HuggingFaceTB/SmolVLM-Instruct", "auto", "none", None),
    ],
)
def test_parameters_are_read_off_the_name(name, dtype, quantization, gb):
    found = weights_gb(Path("/no/such/folder"), name, dtype, quantization)
    assert found == (pytest.approx(gb) if gb else None)


def test_a_folder_is_weighed(tmp_path):
    (tmp_path / "model.safetensors").write_bytes(b"x" * 4000)
    assert weights_gb(tmp_path, "72B", "auto", "none") == pytest.approx(4e-6)
    assert weights_gb(tmp_path, "72B", "float32", "none") == pytest.approx(8e-6)


def test_two_large_cards_hold_what_a_laptop_does_not():
    config = load("qwen2_5_vl_72b.yaml")
    assert catalogue.memory_warning(config, CARDS) == ""
    assert "there is no graphics card, and 17 GB of memory; try --set" in catalogue.memory_warning(config, LAPTOP)
    assert (
        catalogue.memory_warning(load("mini.yaml"), LAPTOP)
        == catalogue.memory_warning(load("template.yaml"), LAPTOP)
        == ""
    )


def test_a_packed_file_is_weighed_with_its_keys_and_told_without_a_setting_that_it_has_not():
    config = load("qwen3_vl_8b_gguf.yaml")
    assert catalogue.memory_warning(config, LAPTOP) == ""
    small = catalogue.memory_warning(config, {"gpus": CARDS["gpus"], "memory_gib": 4.0})
    assert "the config asks for the processor, and 4 GB of memory; choose a smaller model" in small
