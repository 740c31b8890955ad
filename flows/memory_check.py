"""Check whether a model's weights fit into this machine's memory. Starts nothing."""

from __future__ import annotations

import re
from typing import Any

from flows.batch import machine
from sgcad_core.config import Config

MARGIN = 1.1
"""Memory needed over that of the weights, for caches and activations."""


def told(config: Config, there: dict[str, Any] | None = None) -> str:
    """A warning if the weights are known not to fit, else an empty text. `there`: the machine as of `hardware`."""
    need = config.backbone.weights_gb() if config.backbone else None
    if need is None:
        return ""
    gb, where = room(there or machine.hardware(), str(getattr(config.backbone, "device", "auto")))
    if need * MARGIN <= gb:
        return ""
    return (
        f"{config.name}: will not fit this machine: the weights take about {need:.0f} GB and caches more; {where}"
        f"{_remedy(config)}"
    )


def room(there: dict[str, Any], device: str) -> tuple[float, str]:
    """Decimal GB that weights can have on a device, and that in words."""
    cards = [float(found[1]) * 2**20 / 1e9 for card in there["gpus"] if (found := re.search(r"(\d+) MiB", card))]
    if cards and device != "cpu":
        return sum(cards), f"there are {len(cards)} graphics cards with {sum(cards):.0f} GB together"
    gb = there["memory_gib"] * 2**30 / 1e9
    cards_told = "the config asks for the processor" if cards else "there is no graphics card"
    return gb, f"{cards_told}, and {gb:.0f} GB of memory"


def _remedy(config: Config) -> str:
    if getattr(config.backbone, "quantization", "none") == "none":
        return "; try --set backbone.quantization=int4, a smaller model, or a server (openai.yaml)"
    return "; choose a smaller model, or a server (openai.yaml)"
