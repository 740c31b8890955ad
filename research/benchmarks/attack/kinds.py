"""The kinds of attack: every module of this folder, and below, that has a NAME.

A kind of input has `inputs(rng, folder)`, an endless iterator of files, bytes or texts, and `feed(item)`, which gives
one to the product: an SgcadError is a refusal, any other error a fault. A kind of whole commands has `whole(count,
seed, folder)`, which returns a `Whole`. Both may set COUNT, what is tried without --count, and LIMIT_S, the longest
time for one input, and SLOW_S, the processor time that each 100 kB begun may take.
"""

from __future__ import annotations

import importlib
import pkgutil
from dataclasses import dataclass
from types import ModuleType

from research.benchmarks import attack

COUNT, LIMIT_S, SLOW_S = 1000, 60.0, 2.0


@dataclass(frozen=True)
class Whole:
    """What came of a kind of whole commands: how many were tried, what went wrong, and a table in Markdown."""

    tried: int
    faults: tuple[str, ...]
    table: str = ""


def kinds() -> dict[str, ModuleType]:
    """All kinds by name, kinds of input first."""
    names = (found.name for found in pkgutil.walk_packages(attack.__path__, f"{attack.__name__}."))
    modules = [importlib.import_module(name) for name in names if not name.endswith("__main__")]
    found = sorted((m for m in modules if hasattr(m, "NAME")), key=lambda m: (hasattr(m, "whole"), m.NAME))
    return {module.NAME: module for module in found}


def kind_of(name: str) -> ModuleType:
    """A kind by its name, or by the name of its module where that lies elsewhere."""
    return kinds().get(name) or importlib.import_module(name)


def count_of(kind: ModuleType) -> int:
    """How many inputs of a kind are tried if no number is given."""
    return int(getattr(kind, "COUNT", COUNT))


def slow_of(kind: ModuleType) -> float:
    """Processor time that an input of a kind may take for each 100 kB begun, s."""
    return float(getattr(kind, "SLOW_S", SLOW_S))


def limit_of(kind: ModuleType) -> float:
    """Longest time for an input of a kind, s."""
    return float(getattr(kind, "LIMIT_S", LIMIT_S))
