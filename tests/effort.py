"""How much a costly test tries: little in `make test`, the rest in `make test-slow` and `make test-thorough`."""

import os
from collections.abc import Iterable
from typing import Any

import pytest

THOROUGH = os.environ.get("SGCAD_THOROUGH") == "1"


def many(usual: int, thorough: int) -> int:
    """The count for this run: as many as find what breaks, or as many as find what is rare."""
    return thorough if THOROUGH else usual


def spread(cases: Iterable[Any], every: int) -> list[Any]:
    """Parameters of a test: the first case and each `every`-th after it stay quick, the others are slow.

    A case that is a tuple holds the values of several arguments. Raises TypeError for a case with marks of its own.
    """
    return [case if number % every == 0 else _slow(case) for number, case in enumerate(cases)]


def _slow(case: Any) -> Any:
    if hasattr(case, "marks"):
        raise TypeError(f"{case} has marks of its own: give the bare values")
    return pytest.param(*(case if type(case) is tuple else (case,)), marks=pytest.mark.slow)
