"""One input: how it ended, how long it took, and whether anything was written elsewhere."""

from __future__ import annotations

import os
import random
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from research.benchmarks.fuzz.kinds import Kind
from sgcad_core.errors import SgcadError

BASE_S, PER_KILOBYTE_S = 8.0, 0.4
"""Processor seconds an input may take: what a loaded machine needs for the least, and for each kilobyte."""


@dataclass(frozen=True)
class Outcome:
    """How an input ended: processor seconds, and what was wrong with it; empty if nothing."""

    kind: str
    seed: int
    seconds: float
    wrong: str


@contextmanager
def within(place: Path) -> Iterator[list[str]]:
    """Paths outside `place` that are opened for writing meanwhile, by way of the interpreter's audit hook."""
    outside: list[str] = []
    _watched.append((str(place), outside))
    try:
        yield outside
    finally:
        _watched.pop()


_watched: list[tuple[str, list[str]]] = []


CHANGES = {"os.mkdir": 0, "os.remove": 0, "os.rmdir": 0, "os.chmod": 0, "os.truncate": 0, "os.rename": 1, "os.link": 1,
           "os.symlink": 1}  # fmt: skip
"""Audit events of changes of the file system, and which argument is the path that is changed."""


def heed(event: str, arguments: tuple[object, ...]) -> None:
    """The audit hook: note what is opened for writing, made, renamed or removed outside the watched folder."""
    if not _watched or (event != "open" and event not in CHANGES):
        return
    if event == "open" and not (isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR)):
        return
    changed = arguments[CHANGES.get(event, 0)]
    if not isinstance(changed, str | bytes):
        return
    place, outside = _watched[-1]
    path = os.path.abspath(os.fsdecode(changed))
    if not path.startswith((place, "/dev/null")):
        outside.append(path)


def sample(kind: Kind, seed: int) -> bytes:
    """The input of a seed."""
    return kind.make(random.Random(f"{kind.name} {seed}"))


def tried(kind: Kind, seed: int, place: Path) -> Outcome:
    """Make the input of a seed and have it read."""
    content = sample(kind, seed)
    began = time.process_time()
    with within(place) as outside:
        wrong = _stumbled(kind, content, place)
    spent = time.process_time() - began
    if not wrong and outside:
        wrong = f"writes {outside[0]}"
    if not wrong and spent > BASE_S + PER_KILOBYTE_S * len(content) / 1000:
        wrong = f"{spent:.1f} s for {len(content)} bytes"
    return Outcome(kind.name, seed, spent, wrong)


def _stumbled(kind: Kind, content: bytes, place: Path) -> str:
    """An error that is none of ours, and where it came up; empty if there is none."""
    try:
        kind.read(content, place)
    except SgcadError:
        pass
    except Exception as fault:  # noqa: BLE001 - whatever it is, it is what is looked for
        where = traceback.extract_tb(fault.__traceback__)[-1]
        return f"{type(fault).__name__}: {str(fault)[:80]} ({Path(where.filename).name}:{where.lineno})"
    return ""
