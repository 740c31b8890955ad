"""Tiny models saved as folders, as a user would have them: weights, config, tokenizer, image processor, template."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from transformers.models.clip.image_processing_pil_clip import CLIPImageProcessorPil
from transformers.models.idefics3.image_processing_pil_idefics3 import Idefics3ImageProcessorPil
from transformers.models.mllama.image_processing_pil_mllama import MllamaImageProcessorPil
from transformers.models.qwen2_vl.image_processing_pil_qwen2_vl import Qwen2VLImageProcessorPil

from sgcad_core.case.records import Context, Diagram
from tests.plugins.backbone import tiny

TEMPLATE = (
    "<bos>{% for m in messages %}{{ m.role }}: {% for c in m.content %}{% if c.type == 'image' %}<vision_start><image>"
    "<vision_end>{% else %}{{ c.text }}{% endif %}{% endfor %}{% endfor %}"
    "{% if add_generation_prompt %}\nanswer: {% endif %}"
)


def _image_processor(name: str) -> Any:
    if name.startswith("qwen"):
        return Qwen2VLImageProcessorPil(
            patch_size=4, temporal_patch_size=2, merge_size=2, size={"shortest_edge": 64, "longest_edge": 1024}
        )
    if name == "llava":
        return CLIPImageProcessorPil(size={"shortest_edge": 16}, crop_size={"height": 16, "width": 16})
    if name == "idefics3":
        return Idefics3ImageProcessorPil(size={"longest_edge": 48}, max_image_size={"longest_edge": 16})
    return MllamaImageProcessorPil(size={"height": 16, "width": 16}, max_image_tiles=2)


def save(name: str, folder: Path, template: str | None = TEMPLATE) -> Path:
    """Write a tiny random model of an architecture."""
    model, _ = tiny.build(name)
    model.generation_config.eos_token_id = 2
    model.save_pretrained(folder)
    tokenizer = tiny.tokenizer()
    tokenizer.chat_template = template
    tokenizer.save_pretrained(folder)
    if name != "text_only":
        _image_processor(name).save_pretrained(folder)
    return folder


def diagram(seed: int = 0, width: int = 40, height: int = 24) -> Diagram:
    """A random picture."""
    pixels = np.random.default_rng(seed).integers(0, 255, (height, width, 3), dtype=np.uint8)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format="PNG")
    return Diagram(png=out.getvalue(), width_px=width, height_px=height)


def context(seed: int = 0, pictures: int = 1) -> Context:
    """A short report."""
    heading = ("north", "south", "east", "west")[seed % 4]
    return Context(
        narrative=f"V{seed} drove {heading} and struck V{seed + 1} at the crossing.",
        diagrams=tuple(diagram(seed + i) for i in range(pictures)),
    )
