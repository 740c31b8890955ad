"""A language model cut in two: lower layers that stay as they are and run once, upper ones with a LoRA adapter.

What the lower layers make of a text never changes while only upper layers learn, so it is kept (fp16 would lose the
large values that models of this kind have in single places: bf16). Knows texts as token ids alone.
"""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save_file
from torch import Tensor, nn

from plugins.backbone.hf_adapter import CONFIG, WEIGHTS, library
from research.adapters.adapter_rows import Example

TARGETS = ("q_proj", "k_proj", "v_proj", "o_proj", "gate_proj", "up_proj", "down_proj")
CLOSE = 0.05
"""How far, in logits' standard deviations, the two halves may be from the whole in bfloat16."""


class Halves:
    """`below(ids)` are states (tokens, width) in front of the upper layers; `loss` is of an example behind them."""

    def __init__(self, model: Any, first: int, rank: int, dropout: float) -> None:
        peft = library("research.adapters.train_adapter")
        layers = model.config.num_hidden_layers
        if not 0 <= first < layers:
            raise ValueError(f"layer {first} is none of the model's {layers}; use 0 to {layers - 1}")
        config = peft.LoraConfig(
            r=rank, lora_alpha=2 * rank, lora_dropout=dropout, target_modules=list(TARGETS), task_type="CAUSAL_LM",
            layers_to_transform=list(range(first, layers)), layers_pattern="layers",
        )  # fmt: skip
        self.peft = peft.get_peft_model(model, config)
        core = model.model
        self.lower = _part(core, core.layers[:first], nn.Identity())
        self.upper = _part(core, core.layers[first:], core.norm)
        self.head = model.get_output_embeddings()
        self.whole = model

    def parameters(self) -> list[nn.Parameter]:
        """What is learned, in a fixed order."""
        return [p for _, p in sorted(self.peft.named_parameters()) if p.requires_grad]

    @torch.no_grad()
    def below(self, ids: Sequence[int]) -> Tensor:
        """(tokens, width), in the model's dtype."""
        found: Tensor = self.lower(input_ids=torch.tensor([ids]), use_cache=False).last_hidden_state[0]
        return found

    def losses(self, states: Tensor, example: Example) -> Tensor:
        """-log of what the model gives to all allowed tokens together, of each choice, weighed; fp32."""
        at = [choice.at - 1 for choice in example.choices]
        rows = self.upper(inputs_embeds=states[None], use_cache=False).last_hidden_state[0, at]
        log_p = self.head(rows).float().log_softmax(-1)
        lost = [
            -choice.weight * log_p[i, list(choice.allowed)].logsumexp(-1) for i, choice in enumerate(example.choices)
        ]
        return torch.stack(lost)

    @torch.no_grad()
    def check(self, example: Example) -> None:
        """Raises ValueError where both halves are not the whole: a model that does more between its layers."""
        ids = torch.tensor([example.ids])
        whole = self.whole(input_ids=ids, use_cache=False).logits[0].float()
        states = self.below(example.ids)
        halves = self.head(self.upper(inputs_embeds=states[None], use_cache=False).last_hidden_state[0]).float()
        if (off := float((whole - halves).abs().mean() / whole.std())) > CLOSE:
            raise ValueError(
                f"{type(self.whole).__name__}: cut in two it answers otherwise (by {off:.2g}); use Llama's"
            )

    def save(self, folder: Path, base: str) -> None:
        """The adapter in PEFT's format, in bfloat16; each file is replaced whole."""
        folder.mkdir(parents=True, exist_ok=True)
        weights = library("research.adapters.train_adapter").get_peft_model_state_dict(self.peft)
        fresh = folder / f".{WEIGHTS}"
        save_file({key: value.to(torch.bfloat16).contiguous() for key, value in weights.items()}, fresh)
        os.replace(fresh, folder / WEIGHTS)
        config = self.peft.peft_config["default"].to_dict()
        config = {k: sorted(v) if isinstance(v, set) else v for k, v in config.items()} | {
            "base_model_name_or_path": base,
            "inference_mode": True,
        }
        text = json.dumps(config, indent=1, sort_keys=True, default=str)
        (folder / f".{CONFIG}").write_text(text + "\n", encoding="utf-8")
        os.replace(folder / f".{CONFIG}", folder / CONFIG)


def _part(core: Any, layers: Any, norm: nn.Module) -> Any:
    """The same modules under a second roof: some of the layers, and what stands behind them."""
    part = copy.copy(core)
    part._modules = dict(core._modules)
    part.config = copy.copy(core.config)
    part.config.num_hidden_layers = len(layers)
    part.layers, part.norm = nn.ModuleList(layers), norm
    return part
