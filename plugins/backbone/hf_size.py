"""How much memory a model's weights will take, told before anything is loaded: from its folder, or from its name.

Knows files and names; imports no torch.
"""

from __future__ import annotations

import re
from pathlib import Path

BYTES = {"float32": 4.0, "bfloat16": 2.0, "float16": 2.0, "native": 2.0, "auto": 2.0}
QUANTIZED = {"int8": 1.1, "int4": 0.62}
"""Bytes a parameter; what is kept in 16 bits (embeddings, norms, the vision tower) adds to a byte and a half byte."""
_BILLIONS = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)[bB](?![a-zA-Z])")


def weights_gb(folder: Path, name: str, dtype: str, quantization: str) -> float | None:
    """Decimal gigabytes of weights in memory; None where neither a folder nor the name tells.

    A folder's files are taken as stored in 16 bits unless its weights are asked for as they are ("auto").
    """
    per_parameter = QUANTIZED.get(quantization, BYTES.get(dtype, 2.0))
    stored = sum(file.stat().st_size for file in folder.glob("*.safetensors")) if folder.is_dir() else 0
    if stored:
        as_stored = dtype == "auto" and quantization == "none"
        return stored / 1e9 * (1.0 if as_stored else per_parameter / 2.0)
    found = _BILLIONS.findall(Path(name).name)
    return float(found[-1]) * per_parameter if found else None
