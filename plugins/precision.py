"""The floating-point type in which a device computes fast. Loads torch only."""

from __future__ import annotations

import torch


def native_dtype(device: str) -> torch.dtype:
    """bf16 if the device has instructions for it, else fp32, which is then several times as fast.

    x86 processors (AVX512-BF16, AMX) and CUDA cards report it; other processors get fp32, other accelerators bf16.
    """
    if device.startswith("cpu"):
        able = torch.cpu._is_avx512_bf16_supported() or torch.cpu._is_amx_tile_supported()
    else:
        able = not device.startswith("cuda") or torch.cuda.is_bf16_supported(including_emulation=False)
    return torch.bfloat16 if able else torch.float32
