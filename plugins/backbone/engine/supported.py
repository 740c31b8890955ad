"""Which architectures the loop can run, by a model's configuration alone: before any weight is read.

The loop keeps a list of keys and values for each row, cuts it back, and shares beginnings of prompts. What cannot be
cut back or shared is refused here with its reason. Knows no weights, no cache and no picture.
"""

from __future__ import annotations

from typing import Any

from plugins.backbone.engine.faults import TooLong

_KINDS = {"full_attention", "sliding_attention", "cross_attention"}
_BOTH_WAYS = {"paligemma": "reads its whole prompt in both directions, so no beginning of a prompt can be kept"}
"""Model types whose prompt tokens see later ones."""


def refusal(config: Any) -> str | None:
    """Why the loop cannot run a model of this configuration; None if nothing speaks against it."""
    name = _name(config)
    text = config.get_text_config()
    if getattr(config, "is_encoder_decoder", False):
        return (
            f"{name} writes by a decoder of its own behind an encoder: use a model whose prompt and answer are one text"
        )
    if strange := set(getattr(text, "layer_types", None) or ()) - _KINDS:
        return (
            f"{name} has layers of kind {', '.join(sorted(strange))}: their memory cannot be cut back or shared; use a "
            "model with attention layers only"
        )
    if getattr(text, "num_kv_shared_layers", 0):
        return (
            f"{name} has layers that read the keys and values of other layers, which kept beginnings do not hold; use "
            "a model whose layers all keep their own"
        )
    if config.model_type in _BOTH_WAYS:
        return f"{name} {_BOTH_WAYS[config.model_type]}; use a model that reads from left to right"
    if getattr(text, "use_bidirectional_attention", None) in ("vision", "all", True):
        return (
            f"{name} lets some tokens see later ones in some of its layers; use a model that reads from left to right"
        )
    return None


def check(config: Any) -> None:
    """Raises TooLong with the reason if the loop cannot run a model of this configuration."""
    if reason := refusal(config):
        raise TooLong(reason)


def window_of(model: Any) -> int:
    """The most tokens that the model can hold: its trained positions, or its sliding window if no layer sees more."""
    text = model.config.get_text_config()
    found = int(getattr(text, "max_position_embeddings", 0) or 0) or 1 << 30
    kinds = set(getattr(text, "layer_types", None) or ())
    if "sliding_attention" in kinds and "full_attention" not in kinds:
        found = min(found, int(text.sliding_window))
    return found


def sliding_of(model: Any) -> int | None:
    """Tokens that layers of kind sliding_attention see, where other layers see all; None without such a mixture."""
    text = model.config.get_text_config()
    mixed = {"sliding_attention", "full_attention"} <= set(getattr(text, "layer_types", None) or ())
    return int(text.sliding_window) if mixed and getattr(text, "sliding_window", None) else None


def _name(config: Any) -> str:
    return next(iter(getattr(config, "architectures", None) or ()), None) or str(config.model_type)
