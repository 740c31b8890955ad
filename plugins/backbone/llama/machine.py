"""What this machine has and lacks for a GGUF file: the package, the file, memory, and the seconds to expect.

Times are estimates from two short measurements: a row's token reads all weights once, a prompt computes two operations
a parameter and token. Loads no weights.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from plugins.backbone import hf_gguf, hf_machine
from plugins.backbone.llama import header, library
from plugins.backbone.llama.rows import cells
from sgcad_core.errors import ConfigError, MissingTool

_PER_PARAMETER = {"Q2": 0.42, "Q3": 0.5, "Q4": 0.62, "Q5": 0.72, "Q6": 0.83, "Q8": 1.07, "F16": 2.0, "BF16": 2.0}
"""Bytes a parameter by the packing that stands in a file's name."""
_PACKED = re.compile(r"(?<![A-Za-z])(BF16|F16|Q[2-8])(?![0-9])", re.IGNORECASE)
_PROMPT, _ANSWER = 3000, 300
"""Tokens of a question and an answer that the expectation is told for."""
_PROJECTOR = "clip"
"""The architecture that projector files name."""
_OUTPUTS = ("mm.", "resampler.", "adapter.")
"""Beginnings of the names of the tensors behind the vision tower; the last of them gives the model's width."""
_PRODUCTS, _READING = 0.7, 0.25
"""Shares of the rates of plain matrix products and of plain reading that packed weights reach, for prompts and for
answers: fitted on one model (SmolLM2-135M, Q4_1, one thread), so an order of magnitude for others."""


def lacks(model: str, projector: str | None = None) -> tuple[str, ...]:
    """What has to be installed, fetched or renamed before the files run here, a line each.

    Raises ConfigError for a file that is no GGUF file.
    """
    lines = (
        [] if library.installed() else [f"backbone: the package llama-cpp-python is not installed: {library.REMEDY}"]
    )
    found = {}
    for field, name in (("model", model), ("projector", projector)):
        if name is None:
            continue
        try:
            file = hf_gguf.file_of(name, field)
        except (MissingTool, ConfigError) as fault:
            lines.append(f"backbone: {fault}")
        else:
            found[field] = header.read(file)
    if "projector" in found and (wrong := _unfit(found.get("model"), found["projector"])):
        lines.append(f"backbone.projector {projector}: {wrong}")
    return tuple(lines)


def _unfit(model: header.Header | None, projector: header.Header) -> str:
    """Why a file cannot be the projector of a model; "" where nothing in the files' beginnings says so."""
    remedy = "name the mmproj file that was published with the model"
    if projector.architecture != _PROJECTOR:
        return f"is a model of kind {projector.architecture!r}, no projector (kind {_PROJECTOR!r}); {remedy}"
    if projector.told.get("clip.has_vision_encoder") is False:
        return f"knows sound and no pictures; {remedy}"
    width = model.number("embedding_length") if model else 0
    last = [shape for name, shape in projector.shapes.items() if name.startswith(_OUTPUTS) and len(shape) > 1]
    if width and last and not any(width in shape for shape in last):
        widths = sorted({size for shape in last for size in shape})
        return f"none of its widths {widths} is that of the model's vectors, {width}; {remedy}"
    return ""


def pictures(model: str, projector: str | None) -> tuple[str, ...]:
    """What becomes of diagrams, a line; nothing where a model reads text only."""
    if projector is not None:
        return (f"backbone: diagrams are shown by {Path(projector).name}; the seconds that pictures take are not told",)
    found = _header(model)
    if found is None:
        return ()
    beside = sorted(one.name for one in hf_gguf.file_of(model).parent.glob("*mmproj*.gguf"))
    if not beside and "vl" not in found.architecture:
        return ()
    which = f"; {beside[0]} lies beside it" if beside else ""
    return (f"backbone: diagrams are left out: backbone.projector names no mmproj file of {Path(model).name}{which}",)


def weights_gb(model: str, projector: str | None, window: int, reports: int) -> float | None:
    """Memory of the packed weights, a projector that is here, keys and values, decimal GB; None if unknown."""
    found = _header(model)
    if found is None:
        name = Path(model).name
        packed, billions = _PACKED.search(name), hf_machine.billions_in(name)
        return billions * _PER_PARAMETER.get(packed[1].upper(), 0.62) if packed and billions else None
    shown = _header(projector, "projector") if projector else None
    more = shown.size if shown else 0
    return (found.size + more + found.cell_bytes * cells(_window(found, window), reports)) / 1e9


def expectation(model: str, window: int, reports: int, rows: int, gpu_layers: int) -> tuple[str, ...]:
    """Memory and the seconds to expect on this machine's processor, in words; nothing where there is no file."""
    found = _header(model)
    if found is None or not found.parameters:
        return ()
    memory = found.cell_bytes * cells(_window(found, window), reports) / 1e9
    lines = [f"backbone: memory: {found.size / 1e9:.2f} GB of packed weights and {memory:.2f} GB of keys and values"]
    if gpu_layers:
        return (*lines, "backbone: seconds are not estimated for layers on a graphics card")
    read, computed = _measured()
    token = rows * found.size / read
    prompt = 2 * _PROMPT * found.parameters / computed
    kind = "two rows" if rows > 1 else "one row"
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    lines.append(
        f"backbone: expected: about {_rounded(prompt)} s for a prompt of {_PROMPT} tokens and "
        f"{_rounded(token * _ANSWER)} s for {_ANSWER} tokens of answer in {kind}, at {read / 1e9:.2g} GB/s of weights "
        f"and {computed / 1e9:.2g} GFLOP/s by a measurement just now, with {processors} processors; kept beginnings "
        "and forced tokens cost less"
    )
    return tuple(lines)


def _header(name: str, field: str = "model") -> header.Header | None:
    try:
        return header.read(hf_gguf.file_of(name, field))
    except (MissingTool, ConfigError):
        return None


def _window(found: header.Header, window: int) -> int:
    return min(window, found.number("context_length", window) or window)


def _measured() -> tuple[float, float]:
    """Bytes of packed weights that are read a second, and operations a second of packed products."""
    large = np.ones(1 << 25, np.float32)
    left = np.ones((768, 768), np.float32)
    read = _READING * large.nbytes / _best(lambda: large.sum())
    computed = _PRODUCTS * 2 * 768**3 / _best(lambda: left @ left)
    return read, computed


def _best(work: Callable[[], object]) -> float:
    found = []
    for _ in range(3):
        started = time.perf_counter()
        work()
        found.append(time.perf_counter() - started)
    return max(min(found), 1e-9)


def _rounded(seconds: float) -> str:
    return f"{seconds:.2g}" if seconds < 10 else f"{round(seconds, -1 if seconds > 100 else 0):.0f}"
