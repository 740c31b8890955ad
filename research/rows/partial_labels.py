"""Texts of which a part is known: for each field of a gist the values that are allowed. Knows no tokens, no model."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from research.model.answer_grammar import AREAS, BOOL, KINDS, MANEUVERS, quoted

OPTIONS: Mapping[str, tuple[str, ...]] = {
    "touched": BOOL,
    "met": quoted(KINDS),
    "subject": quoted(MANEUVERS),
    "other": quoted(MANEUVERS),
    "subject_area": quoted(AREAS),
    "other_area": quoted(AREAS),
    "junction": BOOL,
}
"""JSON texts that each field may have, in the order of the answer."""


@dataclass(frozen=True)
class Told:
    """A text and what is known of its gist: for each field that is known the values allowed, and what a field weighs
    in the loss (1 where nothing is said)."""

    id: str
    text: str
    allowed: Mapping[str, tuple[Any, ...]]
    weight: Mapping[str, float] = field(default_factory=dict)


def load(file: Path) -> list[Told]:
    """Rows of a file of JSON lines: {"id", "text", "allowed": {field: [value, ...]}, "weight": {field: share}}.

    Raises:
        ValueError: names the line, the field and what it may be.
    """
    lines = file.read_text(encoding="utf-8").splitlines()
    return [_told(f"{file}, line {n}", line) for n, line in enumerate(lines, 1) if line.strip()]


def _told(where: str, line: str) -> Told:
    try:
        given = json.loads(line)
        allowed = {key: tuple(values) for key, values in given["allowed"].items()}
        found = Told(str(given["id"]), str(given["text"]), allowed, dict(given.get("weight", {})))
    except (ValueError, KeyError, TypeError, AttributeError) as fault:
        form = '{"id": ..., "text": ..., "allowed": {field: [value, ...]}}'
        raise ValueError(f"{where}: no row ({fault!r}); write {form}") from fault
    for key in (*found.allowed, *found.weight):
        if key not in OPTIONS:
            raise ValueError(f"{where}: {key!r} is no field; use {', '.join(OPTIONS)}")
    for key, values in found.allowed.items():
        strange = [value for value in values if json.dumps(value) not in OPTIONS[key]]
        if strange or not values:
            raise ValueError(f"{where}: {key} allows {strange or 'nothing'}; use some of {', '.join(OPTIONS[key])}")
    return found
