"""What this machine lacks for a model of transformers: files, packages, cards, a family that runs. Loads no weights."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from plugins.backbone import hf_gguf
from plugins.backbone.engine import packing
from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool

_BILLIONS = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)[bB](?![a-zA-Z])")


def billions_in(name: str) -> float | None:
    """The number of parameters that a model's name tells ("Qwen3-VL-8B"), 1e9; None where it tells none."""
    found = _BILLIONS.findall(name)
    return float(found[-1]) if found else None


def lacks(model: str, revision: str | None, device_map: Any, quantization: str) -> tuple[str, ...]:
    """What has to be fetched or installed before a model runs here, a line each.

    Raises ConfigError for a family that cannot run, where its config.json is at hand.
    """
    lines = [*packing.lacks(quantization)]
    if device_map and quantization == "none":
        lines += packing.packages(["accelerate"])
    if hf_gguf.is_gguf(model):
        return (*lines, *_file(model))
    place = _place(model, revision)
    if place is None:
        return (*lines, f"backbone: the weights of {model} are not on this machine: hf download {model}")
    _refused(model, place)
    return (*lines, *packing.stored_lacks(model, str(place), quantization))


def _file(model: str) -> tuple[str, ...]:
    try:
        hf_gguf.file_of(model)
    except (MissingTool, ConfigError) as fault:
        return (f"backbone: {fault}",)
    return ()


def _place(model: str, revision: str | None) -> Path | None:
    """The folder of a model: named by its path, from the project's root, or fetched before; None if it is not here."""
    for folder in (Path(model), settings.ROOT / model):
        if folder.is_dir():
            return folder
    from huggingface_hub import try_to_load_from_cache
    from huggingface_hub.errors import HFValidationError

    try:
        file = try_to_load_from_cache(model, "config.json", revision=revision)
    except HFValidationError:
        return None
    return Path(file).parent if isinstance(file, str) else None


def _refused(model: str, place: Path) -> None:
    """Raises ConfigError if the family of a folder cannot run; the project's own models are known to."""
    if place.resolve().is_relative_to(settings.ROOT / "plugins") or not (place / "config.json").is_file():
        return
    from plugins.backbone.hf_load import config_of

    config_of(model, str(place), None)
