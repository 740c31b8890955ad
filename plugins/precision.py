"""Which floating point a device is fast in. Loads torch only."""

from __future__ import annotations

import torch


def native_dtype(device: str) -> torch.dtype:
    """bf16 where a device has instructions for it, else fp32, which is then several times as fast.

    x86 processors say so (AVX512-BF16, AMX) and so do CUDA cards; other processors are not asked and get fp32, other
    accelerators bf16.
    """
    if device.startswith("cpu"):
        able = torch.cpu._is_avx512_bf16_supported() or torch.cpu._is_amx_tile_supported()
    else:
        able = not device.startswith("cuda") or torch.cuda.is_bf16_supported(including_emulation=False)
    return torch.bfloat16 if able else torch.float32
