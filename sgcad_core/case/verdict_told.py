"""The verdict of a finished case, as every page, console and tracker tells it. Knows no account and no file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def verdict_sentence(result: Mapping[str, Any]) -> str:
    """The verdict on a case in one sentence, as result.json has it; "" in results of versions without one."""
    return str((result.get("account") or {}).get("sentence") or "")
