"""The faults of the token loop, and how work that may fail is run without keeping the memory of its tensors.

    EngineFault
    ├── DoesNotFit    no valid answer within the limits: the field's path, so that it can be asked again
    ├── BadLogits     the model gave NaN or inf at a step: this report stops, the others go on
    ├── BadScores     the decoder gave no usable scores or tokens: this report stops, the others go on
    ├── TooLong       prompt and answer exceed the model's window
    ├── TooBig        one report alone does not fit in memory
    └── WrongBatch    the start-up self-check found no batching that gives this model's own logits

Knows no model and no report.
"""

from __future__ import annotations

from collections.abc import Callable

import torch

from sgcad_core.errors import PluginFault


class EngineFault(Exception):
    """Root of the tree; never raised itself."""


class DoesNotFit(EngineFault):
    """No valid answer can be finished; `path` is the JSON path of the field at fault ("$" = the whole)."""

    def __init__(self, message: str, path: str = "$") -> None:
        super().__init__(message)
        self.path = path


class BadLogits(EngineFault):
    """NaN or inf in a row's logits."""


class BadScores(EngineFault):
    """A decoder's scores are NaN, inf or of another shape, or its draw is no token."""


class TooLong(EngineFault):
    """The prompt and the longest answer do not fit in the model's window."""


class TooBig(EngineFault):
    """Memory ran out for a single report."""


class WrongBatch(EngineFault):
    """Neither one batch nor two caches give the logits of separate forwards."""


def is_memory(fault: BaseException) -> bool:
    """True if memory ran out, on a GPU or in the allocator of the CPU."""
    if isinstance(fault, PluginFault) and fault.__cause__:  # a decoder's
        fault = fault.__cause__
    said = str(fault).lower()
    full = isinstance(fault, RuntimeError) and "alloc" in said and "memory" in said
    return full or isinstance(fault, torch.OutOfMemoryError | MemoryError)


def tried(work: Callable[[], object]) -> Exception | None:
    """Runs `work` and returns what it raised; TooBig, without the frames that hold tensors, if memory ran out."""
    try:
        work()
    except Exception as fault:  # noqa: BLE001 - models and decoders are third-party code: the loop must survive them
        return TooBig(f"one report alone does not fit in memory: {fault}") if is_memory(fault) else fault
    return None
