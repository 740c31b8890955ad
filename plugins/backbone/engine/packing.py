"""Packed weights (int8, int4, FP8, AWQ, GPTQ, ...): the packages and cards that transformers needs for them.

Told by a setting, or by a folder's config.json, before any weight is read. Knows no model.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

from sgcad_core.errors import ConfigError

PACKED = {
    "awq": ("gptqmodel", "accelerate"),
    "gptq": ("gptqmodel", "optimum"),
    "fp8": ("accelerate",),
    "fbgemm_fp8": ("accelerate", "fbgemm_gpu"),
    "compressed-tensors": ("compressed_tensors",),
    "bitsandbytes": ("bitsandbytes", "accelerate"),
}
"""Packages that transformers needs for weights packed by a method, as its config.json names it."""
_PACKING = {"none": (), "int8": PACKED["bitsandbytes"], "int4": PACKED["bitsandbytes"], "fp8": PACKED["fp8"]}
_ON_A_CARD = {"fp8": (8, 9), "fbgemm_fp8": (9, 0)}
"""Compute capability that a packing computes with."""
_IN_GPU = ("accelerate", "bitsandbytes")


def stored_lacks(model: str, place: str, quantization: str) -> tuple[str, ...]:
    """What weights that are stored packed (AWQ, GPTQ, FP8, ...) need and this machine has not, a line each.

    Raises ConfigError for a packing that is not known, or where they shall be packed a second time.
    """
    method = stored_packing(place)
    if not method:
        return ()
    if quantization != "none":
        raise ConfigError(
            f"backbone.quantization {quantization}: the weights of {model} are packed already ({method}); set none"
        )
    if method not in PACKED:
        raise ConfigError(
            f"backbone.model {model}: its weights are packed by {method}, which was never tried here; use one of "
            f"{', '.join(PACKED)}, or plain weights"
        )
    return (*packages(PACKED[method]), *_card(method))


def lacks(quantization: str) -> tuple[str, ...]:
    """What packing plain weights while they load needs and this machine has not, a line each."""
    return (*packages(_PACKING[quantization]), *_card(quantization))


def stored_packing(place: str) -> str:
    """The method by which a folder's weights are packed, "" for plain ones."""
    try:
        known = json.loads((Path(place) / "config.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    found = known.get("quantization_config") or (known.get("text_config") or {}).get("quantization_config") or {}
    return str(found.get("quant_method", ""))


def packages(needed: Iterable[str]) -> list[str]:
    """A line for each package that is not installed, with its command."""
    missing = [package for package in sorted(needed) if find_spec(package) is None]
    how = {package: f"pip install {package.replace('_', '-')}" for package in missing}
    how |= dict.fromkeys(_IN_GPU, "pip install 'sg-cadvlm[gpu]'")
    return [f"backbone: the package {package} is not installed: {how[package]}" for package in missing]


def _card(packing: str) -> list[str]:
    """A line if a packing computes on cards that are not here."""
    wanted = _ON_A_CARD.get(packing)
    if wanted is None:
        return []
    import torch

    there = torch.cuda.get_device_capability() if torch.cuda.is_available() else None
    if there is not None and there >= wanted:
        return []
    told = f"the one here has {there[0]}.{there[1]}" if there else "there is none here"
    return [
        f"backbone: {packing} computes on a graphics card of compute capability {wanted[0]}.{wanted[1]} or higher, "
        f"{told}: use int8 or int4, a GGUF file (backbone llama_cpp), or a server"
    ]
