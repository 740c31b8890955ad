"""Defaults of deployed runs from the worker's environment, so that prefect.yaml names no host and no secret."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sgcad_core import settings


def results_folder(out: Path | None, inside: str = "") -> Path:
    """The parameter, else a folder inside the variable SGCAD_OUT, else inside runs."""
    return out or Path(settings.environment("SGCAD_OUT") or "runs", inside)


def inbox_address(address: str) -> str:
    """The parameter, else the variable SGCAD_INBOX, else the folder inbox of the results."""
    return address or settings.environment("SGCAD_INBOX") or str(results_folder(None, "inbox"))


def cases_folder(cases: Path | None) -> Path:
    """The parameter, else the variable SGCAD_CASES, else the bundled reports."""
    named = settings.environment("SGCAD_CASES")
    return cases or (Path(named) if named else settings.ROOT / "docs" / "demo")


def overrides_of(overrides: Sequence[str]) -> tuple[str, ...]:
    """SGCAD_OVERRIDES (key=value, parted by spaces, such as tracker.uri=http://mlflow:5000), then the parameter's."""
    return (*settings.environment("SGCAD_OVERRIDES").split(), *overrides)
