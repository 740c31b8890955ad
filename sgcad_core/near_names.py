"""Suggestions for unknown names. Pure functions on text."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """' Did you mean 'x'?' with the known name that is most like the given one; empty if none is like it."""
    by_case = {k.casefold(): k for k in known}
    near = difflib.get_close_matches(name.casefold(), by_case, n=1)
    return f" Did you mean {by_case[near[0]]!r}?" if near else ""
