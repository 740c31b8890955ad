"""The text in a picture's place: that of transformers' own processors, where they load without torchvision."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import torch
from transformers.models.aya_vision.processing_aya_vision import AyaVisionProcessor
from transformers.models.gemma3.processing_gemma3 import Gemma3Processor

from plugins.backbone.engine.records import Picture
from plugins.backbone.hf_placeholders import spelling_of
from plugins.backbone.hf_prompt import thought
from research.benchmarks.decoding.family_models import FAMILIES, tokenizer

BY_NAME = {family.name: family for family in FAMILIES}


def spelled(name: str, count: int, **inputs: Any) -> tuple[str, Any]:
    family = BY_NAME[name]
    words = tokenizer(family.specials)
    made = spelling_of(family.config(), words)
    return made.spell(family.specials[0], count, Picture("one", inputs)), words


@pytest.mark.parametrize(("name", "sizes", "rows", "each"), [
    ("Pixtral", (20, 32), 5, 8), ("Mistral 3 (Small 3.1, 3.2)", (16, 32), 2, 4), ("Pixtral", (4, 4), 1, 1),
])  # fmt: skip
def test_rows_of_a_picture_end_in_breaks_and_the_last_in_an_end(
    name: str, sizes: tuple[int, int], rows: int, each: int
) -> None:
    text, _ = spelled(name, rows * each, image_sizes=torch.tensor([sizes]))
    assert text == "[IMG_BREAK]".join(["[IMG]" * each] * rows) + "[IMG_END]"


def test_a_picture_is_framed_as_gemmas_processor_does() -> None:
    family = BY_NAME["Gemma 3"]
    words = tokenizer(family.specials)
    words.boi_token, words.eoi_token, words.image_token = "<start_of_image>", "<end_of_image>", "<image>"
    words.boi_token_id, words.image_token_id = 292, 290
    theirs = Gemma3Processor(family.pixels.made(), words, image_seq_length=4)  # type: ignore[union-attr]
    ours, _ = spelled("Gemma 3", 4)
    assert ours == theirs.replace_image_token({"num_crops": [0]}, 0)
    assert spelling_of(family.config(), words).shown == theirs.image_token


@pytest.mark.parametrize("tiles", [1, 3, 5])
def test_tiles_are_spelled_as_ayas_processor_does(tiles: int) -> None:
    family = BY_NAME["Aya Vision"]
    text, words = spelled("Aya Vision", 4 * tiles, pixel_values=torch.zeros(tiles, 3, 16, 16))
    theirs = AyaVisionProcessor(family.pixels.made(), words, patch_size=4, img_size=16, downsample_factor=2)  # type: ignore[union-attr]
    assert text == theirs.replace_image_token({"num_patches": [tiles]}, 0)


def test_other_families_repeat_their_placeholder(tmp_path: Path) -> None:
    assert spelled("Qwen3-VL", 3)[0] == "<image>" * 3
    assert spelled("InternVL3, InternVL3.5", 3)[0] == f"<img>{'<image>' * 3}</img>"


@pytest.mark.parametrize(("prompt", "closed"), [
    ("user: x\nassistant: ", "user: x\nassistant: "),
    ("user: <think> is a word\nassistant: ", "user: <think> is a word\nassistant: "),
    ("user: x\nassistant: <think>\n", "user: x\nassistant: <think>\n\n</think>\n\n"),
])  # fmt: skip
def test_a_block_of_thoughts_that_a_template_opens_is_closed_before_the_answer(prompt: str, closed: str) -> None:
    assert thought(prompt) == closed
