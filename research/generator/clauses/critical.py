"""Clauses about the error that led to the crash, by configuration: {V} errs, {W} is the other.

{turn} left or right, {opp} the heading of oncoming traffic; {anyside} is noise.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("critical")

CRITICAL: dict[str, Group] = _LISTS["CRITICAL"]
