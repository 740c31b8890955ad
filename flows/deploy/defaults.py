"""Defaults of deployed runs from the worker's environment, so that prefect.yaml names no host and no secret."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sgcad_core import settings

INBOX = "runs/inbox"


def inbox_address(address: str | None) -> str:
    """The parameter, else the variable SGCAD_INBOX, else runs/inbox."""
    return address or settings.environment("SGCAD_INBOX") or INBOX


def cases_folder(cases: str | None) -> Path:
    """The parameter, else the variable SGCAD_CASES, else the bundled reports."""
    named = cases or settings.environment("SGCAD_CASES")
    return Path(named) if named else settings.ROOT / "docs" / "demo"


def overrides_of(overrides: Sequence[str] | None) -> tuple[str, ...]:
    """SGCAD_OVERRIDES (key=value, parted by spaces, such as tracker.uri=http://mlflow:5000), then the parameter's."""
    return (*settings.environment("SGCAD_OVERRIDES").split(), *(overrides or ()))
