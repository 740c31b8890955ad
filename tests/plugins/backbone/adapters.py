"""Small LoRA adapters with random weights, as PEFT itself writes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import peft
import torch

from tests.plugins.backbone import tiny


def save(folder: Path, model: Any = None, seed: int = 0, **changed: Any) -> Any:
    """Write an adapter for a model (the tiny one of texts); the model with it, not merged."""
    config = {"r": 2, "lora_alpha": 4, "target_modules": ["q_proj", "down_proj"], "task_type": "CAUSAL_LM"} | changed
    made = peft.get_peft_model(model or tiny.build("text_only")[0], peft.LoraConfig(**config))
    torch.manual_seed(seed)
    with torch.no_grad():
        for name, weight in made.named_parameters():
            if "lora_" in name:
                weight.normal_(0, 0.3)
    made.save_pretrained(folder)
    return made.eval()
