"""Incident reports with their codes, and the groups that they fall into: dev, seen and blind."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

BLIND_OF = 6
"""Of so many reports of a pool one is blind, by the hash of its id."""


class Incident(NamedTuple):
    """A report with its codes; its group is dev, seen or blind."""

    id: str
    text: str
    truth: Mapping[str, Any]
    group: str

    @property
    def genre(self) -> str:
        """The first part of the id."""
        return self.id.partition("-")[0]


def by_hash(text: str) -> int:
    """A number that follows from an id or a text and from nothing else: what parts are chosen by."""
    return int(hashlib.sha256(text.encode()).hexdigest(), 16)


def is_blind(id: str) -> bool:
    """Whether a report of the pool is blind: scored, never read."""
    return by_hash(id) % BLIND_OF == 0


def of_pool(file: Path, sample: int | None = None) -> list[Incident]:
    """The pool's reports; of the seen ones at most `sample`."""
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line.strip()]
    found = [Incident(p["id"], p["text"], p, "blind" if is_blind(p["id"]) else "seen") for p in lines]
    seen = sorted((i for i in found if i.group == "seen"), key=lambda i: by_hash(i.id))
    return [*seen[:sample], *(i for i in found if i.group == "blind")]


def of_dev(cases: Path, truth: Path) -> list[Incident]:
    """Case folders that have codes beside them."""
    files = sorted(truth.glob("*.json"))
    return [
        Incident(f.stem, (cases / f.stem / "report.txt").read_text(encoding="utf-8"), json.loads(f.read_text()), "dev")
        for f in files
    ]
