"""The start-up self-check: a batch must give the logits of separate forward passes.

Some architectures of transformers silently compute wrong logits in a batch (Mllama's row without a picture was off by
most of its range). Before the first report, rows of both kinds are prefilled apart, stepped together and compared with
one plain forward pass each, without cache. Knows no report and no decoder.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from plugins.backbone.engine.families import CrossAttentionFamily, Family, forward_inputs
from plugins.backbone.engine.faults import WrongBatch
from plugins.backbone.engine.records import Picture, Prompt
from plugins.backbone.engine.runner import Runner

_APART = {"one batch": False, "two caches": True}
"""Words of a kept answer."""
_BEHIND = (3, 1, 1)
"""Tokens fed at each step of the check: a chunk, then single ones."""


def batching(model: Any, family: Family, picture: Picture | None) -> bool:
    """Whether rows with and without pictures need separate batches. Raises WrongBatch if neither way is right."""
    prompts = check_prompts(family, picture)
    faults = []
    for apart in (False, True):
        error = batch_error(model, family, apart, prompts)
        if error <= tolerance(model):
            return apart
        faults.append(f"{'two caches' if apart else 'one batch'}: {error:.3g}")
    raise WrongBatch(
        f"{type(model).__name__} gives other logits in a batch than alone (error over spread, {'; '.join(faults)}, "
        f"limit {tolerance(model):g}); use another model, or attn_implementation eager"
    )


def kept_batching(model: Any, family: Family, picture: Picture | None, folder: Path) -> bool:
    """`batching`, kept in a folder for the next start: it follows from architecture, libraries and device, not from
    the weights, and costs a small model as much as its loading."""
    file = folder / f"batching-{_fingerprint(model, picture)}"
    with suppress(OSError, KeyError):
        return _APART[file.read_text()]
    apart = batching(model, family, picture)
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        partial = file.with_suffix(f".{os.getpid()}")
        partial.write_text(next(word for word, kind in _APART.items() if kind is apart))
        partial.replace(file)
    return apart


def _fingerprint(model: Any, picture: Picture | None) -> str:
    import transformers

    about = (
        type(model).__qualname__, model.config.to_json_string(), str(model.dtype), model.device.type,
        torch.backends.cpu.get_cpu_capability(), torch.__version__, transformers.__version__, picture is not None,
        *(file.read_text(encoding="utf-8") for file in sorted(Path(__file__).parent.glob("*.py"))),
    )  # fmt: skip
    return hashlib.sha256(repr(about).encode()).hexdigest()[:32]


def tolerance(model: Any) -> float:
    """Limit of the error over the logits' spread: rounding is far below it, a wrong mask far above."""
    return 1e-3 if model.dtype == torch.float32 else 0.05


@torch.inference_mode()
def batch_error(model: Any, family: Family, apart: bool, prompts: Sequence[Prompt]) -> float:
    """The worst row's root mean square difference to the reference, over the reference's standard deviation."""
    runner = Runner(model, family, apart)
    behind = [_tokens(family, sum(_BEHIND), seed) for seed in range(len(prompts))]
    rows = [runner.open(prompt) for prompt in prompts]
    said: list[list[Tensor]] = [[] for _ in rows]
    at = 0
    for count in (0, *_BEHIND[:-1]):
        pairs = zip(prompts, behind, strict=True)
        fed = [more[at : at + count] if count else [prompt.ids[-1]] for prompt, more in pairs]
        for row, logits, kept in zip(rows, runner.step(list(zip(rows, fed, strict=True))), said, strict=True):
            row.length += len(logits)
            kept.append(logits.float())
        at += count
    errors = []
    for prompt, more, parts in zip(prompts, behind, said, strict=True):
        expected = reference(model, family, prompt, more[:at]).float()
        errors.append(float((torch.cat(parts) - expected).pow(2).mean().sqrt() / expected.std()))
    return max(errors)


@torch.inference_mode()
def reference(model: Any, family: Family, prompt: Prompt, behind: Sequence[int] = ()) -> Tensor:
    """Logits (1 + behind, vocabulary) from the prompt's last token on: one forward, no cache, its own positions."""
    ids = torch.tensor([[*prompt.ids, *behind]], device=model.device)
    inputs = family.to_model(forward_inputs(prompt.pictures))
    if prompt.pictures and family.kinds_argument:
        inputs[family.kinds_argument] = ids.eq(family.image_token or 0).int()
    if prompt.pictures and isinstance(family, CrossAttentionFamily):
        whole = Prompt(ids[0].tolist(), prompt.pictures)
        inputs["cross_attention_mask"] = family.visible(whole)[None].to(model.device)
    _forget_positions(model)
    logits: Tensor = model(input_ids=ids, use_cache=False, **inputs).logits[0, len(prompt.ids) - 1 :]
    _forget_positions(model)
    return logits


def check_prompts(family: Family, picture: Picture | None) -> list[Prompt]:
    """Short prompts of different lengths, one with the picture in its middle if there is one."""
    prompts = [Prompt(_tokens(family, 9, 1)), Prompt(_tokens(family, 5, 2))]
    if picture is not None:
        inner = [int(family.image_token or 0)] * family.tokens_of(picture)
        prompts.insert(0, Prompt([*_tokens(family, 4, 3), *inner, *_tokens(family, 6, 4)], [picture]))
    return prompts


def _tokens(family: Family, count: int, seed: int) -> list[int]:
    """Ordinary tokens: any but the picture's."""
    size = family.model.get_input_embeddings().weight.shape[0]
    found = torch.randint(min(8, size // 2), min(size, 400), (count,), generator=torch.Generator().manual_seed(seed))
    return [int(t) if t != family.image_token else int(t) - 1 for t in found]


def _forget_positions(model: Any) -> None:
    """Clears the model's rope_deltas, which it would otherwise use for the next batch."""
    core = getattr(model, "model", model)
    if hasattr(core, "rope_deltas"):
        core.rope_deltas = None
