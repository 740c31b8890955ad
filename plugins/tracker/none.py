"""No tracking: a case leaves only its files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sgcad_core.interfaces import Tracker


class NoTracker(Tracker):
    """Logs nothing."""

    def log_case(self, config_name: str, params: dict[str, Any], case_dir: Path, result: dict[str, Any]) -> None:
        """Logs nothing."""
