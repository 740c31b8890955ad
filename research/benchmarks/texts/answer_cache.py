"""Answers of a model that a benchmark keeps in a file of JSON lines, so that a broken run goes on where it stopped."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import nullcontext
from pathlib import Path
from typing import Any, TypeVar

T = TypeVar("T")


def answers(
    asked: Mapping[str, T], answer: Callable[[T], Any], key: str, file: Path | None, at_once: int
) -> dict[str, Any]:
    """What `answer` says of each, by id; JSON values. Those that stand in the file, as {"id": ..., key: ...}, are not
    asked for again; the others are, so many at once, and are written there as they come. No file: nothing is kept.

    What an answer raises is raised when all that were begun are written. Raises OSError for a file that cannot be
    written, before the first question.
    """
    known = _remembered(file, key)
    faults = []
    with (
        nullcontext() if file is None else file.open("a", encoding="utf-8") as lines,
        ThreadPoolExecutor(at_once) as pool,
    ):
        begun = {pool.submit(answer, one): id for id, one in asked.items() if id not in known}
        pending = set(begun)
        while pending:
            finished, pending = wait(pending, return_when=FIRST_COMPLETED)
            for done in finished:
                if fault := done.exception():
                    faults.append(fault)
                    pending = {other for other in pending if not other.cancel()}
                    continue
                known[begun[done]] = done.result()
                if lines is not None:
                    lines.write(json.dumps({"id": begun[done], key: done.result()}) + "\n")
                    lines.flush()
    if faults:
        raise faults[0]
    return known


def _remembered(file: Path | None, key: str) -> dict[str, Any]:
    """Raises ValueError with file and line for a line that is not of this form."""
    found = {}
    lines = file.read_text(encoding="utf-8").splitlines() if file is not None and file.is_file() else []
    for number, line in enumerate(lines, 1):
        try:
            row = json.loads(line)
            found[row["id"]] = row[key]
        except (ValueError, KeyError, TypeError) as fault:
            raise ValueError(
                f"{file}, line {number}: no kept answer ({fault!r}); delete the line and it is asked for again"
            ) from fault
    return found
