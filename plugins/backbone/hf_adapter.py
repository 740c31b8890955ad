"""A LoRA adapter in PEFT's format, merged into a model's weights when they are loaded: afterwards it costs nothing.

Hu et al. 2021, "LoRA: Low-Rank Adaptation of Large Language Models". Takes the package `peft`, which is imported only
where an adapter is named. Weights are read from safetensors alone, never from a pickle. Knows no prompt, no training.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool

CONFIG, WEIGHTS = "adapter_config.json", "adapter_model.safetensors"
KIND = "LORA"


def folder_of(name: str) -> Path:
    """An adapter's folder, relative ones also from the project's root. Raises ConfigError if it holds no adapter."""
    folder = Path(name) if Path(name).is_dir() else settings.ROOT / name
    if not folder.is_dir():
        raise ConfigError(
            f"backbone.adapter {name}: there is no folder {folder}; name one that exists, or leave it out"
        )
    if missing := [file for file in (CONFIG, WEIGHTS) if not (folder / file).is_file()]:
        raise ConfigError(
            f"backbone.adapter {name}: {folder} has no {' and no '.join(missing)}; name a folder that PEFT's "
            "save_pretrained has written (a whole model is named by backbone.model)"
        )
    return folder


def merged(model: Any, name: str) -> Any:
    """The model with the adapter in its weights. Raises MissingTool, or ConfigError if the adapter does not fit."""
    folder = folder_of(name)
    _check_kind(name, folder)
    peft = library(f"backbone.adapter {name}")
    from safetensors import SafetensorError
    from safetensors.torch import load_file

    try:
        config = peft.PeftConfig.from_pretrained(str(folder))
        with_adapter = peft.get_peft_model(model, config)
        weights = load_file(folder / WEIGHTS)
        found = peft.set_peft_model_state_dict(with_adapter, weights)
    except (ValueError, TypeError, KeyError, RuntimeError, SafetensorError) as fault:
        raise _does_not_fit(name, type(model).__name__, str(fault)) from fault
    left = [*found.unexpected_keys, *(key for key in found.missing_keys if "lora_" in key)]
    if left:
        raise _does_not_fit(name, type(model).__name__, f"{len(left)} weights have no counterpart: {_few(left)}")
    return with_adapter.merge_and_unload()


def library(wanted_by: str) -> Any:
    """Imports PEFT. Raises MissingTool with the command that installs it."""
    if find_spec("peft") is None:
        raise MissingTool(f"{wanted_by} needs the package peft: pip install 'sg-cadvlm[adapters]'")
    import peft

    return peft


def _check_kind(name: str, folder: Path) -> None:
    try:
        kind = json.loads((folder / CONFIG).read_text(encoding="utf-8"))["peft_type"]
    except (ValueError, KeyError, TypeError) as fault:
        raise ConfigError(
            f"backbone.adapter {name}: {folder / CONFIG} is no adapter's ({fault!r}); name a folder that PEFT's "
            "save_pretrained has written"
        ) from fault
    if kind != KIND:
        raise ConfigError(f"backbone.adapter {name}: its peft_type is {kind!r}; only {KIND!r} can be merged here")


def _does_not_fit(name: str, model: str, said: str) -> ConfigError:
    short = " ".join(said.split())[:300]
    return ConfigError(
        f"backbone.adapter {name} does not fit the model ({model}): {short}; use the base model that its "
        f"{CONFIG} names, or an adapter of this one"
    )


def _few(keys: Iterable[str]) -> str:
    return ", ".join(list(keys)[:2])
