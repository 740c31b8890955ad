"""Whether a fault is the device's memory, and how work that may fail is tried without keeping that memory.

Knows no model and no report.
"""

from __future__ import annotations

from collections.abc import Callable

import torch

from plugins.backbone.engine.records import TooBig


def is_memory(fault: BaseException) -> bool:
    """True if memory ran out, on a GPU or in the allocator of the CPU."""
    said = str(fault).lower()
    full = isinstance(fault, RuntimeError) and "alloc" in said and "memory" in said
    return full or isinstance(fault, torch.OutOfMemoryError | MemoryError)


def tried(work: Callable[[], object]) -> Exception | None:
    """Do it; what it raised. Memory that ran out comes back as a TooBig without the frames that hold tensors."""
    try:
        work()
    except Exception as fault:  # noqa: BLE001 - the loop's boundary: models and decoders are others' code
        return TooBig(f"one report alone does not fit in memory: {fault}") if is_memory(fault) else fault
    return None
