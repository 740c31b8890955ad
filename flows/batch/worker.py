"""The code of a worker process: runs one case after the other; plugins are built once per config."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flows.case.run_case import Ending, run_case
from flows.case_files.find_cases import Case
from flows.case_files.stage_cache import Sharing
from sgcad_core.config import Config, build

_configs: dict[str, Config] = {}


@dataclass(frozen=True)
class Order:
    """A case to run, as values that can be pickled."""

    raw: dict[str, Any]
    name: str
    case: Case
    out: Path
    digest: str
    sharing: Sharing | None = None


def run_in_worker(order: Order) -> Ending:
    """Run an order in this worker process."""
    name = order.name
    if name not in _configs:
        _configs[name] = build(order.raw, name, name)
    return run_case(_configs[name], order.case, order.out, order.digest, sharing=order.sharing)
