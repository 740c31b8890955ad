"""A trained model as a folder that transformers loads: bf16 safetensors, config, tokenizer, image processor."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import torch

from plugins.backbone.mini import drawing_view, patch_convnet

PREPROCESSOR = {
    "image_processor_type": "MiniImageProcessor",
    "processor_class": "MiniProcessor",
    "patch_size": drawing_view.PATCH,
    "merge_size": 2,
}


def export(model: Any, seen_by: patch_convnet.Eye, tokenizer: Any, folder: Path) -> None:
    """Write the folder; files are replaced one by one, weights first."""
    folder.mkdir(parents=True, exist_ok=True)
    half = copy.deepcopy(model).to("cpu", torch.bfloat16)
    half.config.dtype = torch.bfloat16
    half.generation_config.eos_token_id = tokenizer.eos_token_id
    half.generation_config.pad_token_id = tokenizer.pad_token_id
    half.generation_config.bos_token_id = None
    half.save_pretrained(folder)
    patch_convnet.save(seen_by, folder)
    tokenizer.save_pretrained(folder)
    (folder / "preprocessor_config.json").write_text(json.dumps(PREPROCESSOR, indent=1) + "\n", encoding="utf-8")
