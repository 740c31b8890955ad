"""Robustness levels: their order, their labels, and those that should end in a refusal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

KEY = "report_reader.robustness_level"
"""The override that names a level."""
LABELS: Mapping[str, str] = {
    "full": "Full context",
    "semantic_noise": "Semantic noise",
    "blur_weak": "Geometric blur, weak",
    "blur_medium": "Geometric blur, medium",
    "blur_strong": "Geometric blur, strong",
    "modal_conflict": "Modal conflict",
    "critical_depletion": "Critical depletion",
    "total_sparsity": "Total sparsity",
}
SHOULD_REFUSE = frozenset({"critical_depletion", "total_sparsity"})
"""At these levels the remaining evidence is too little for a crash."""


def level_of(factors: Mapping[str, Any], overrides: Sequence[str]) -> str | None:
    """An arm's level, from the keys it varies or its overrides; None if it names none."""
    named = [o.partition("=")[2].strip() for o in overrides if o.partition("=")[0].strip() == KEY]
    level = str(factors.get(KEY, named[-1] if named else ""))
    return level if level in LABELS else None


def base_of(config: str, factors: Mapping[str, Any], overrides: Sequence[str]) -> tuple[str, ...]:
    """An arm's config without its level: arms with the same base are one system at several levels."""
    varied = (f"{k}={v}" for k, v in factors.items() if k != KEY)
    rest = (o.strip() for o in overrides if o.partition("=")[0].strip() != KEY)
    return (config, *sorted({*varied, *rest}))
