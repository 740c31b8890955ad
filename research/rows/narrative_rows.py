"""Coded narratives of numbered reports as rows for an encoder: the codes of their tokens, with the questions' rows.

Words are hashes (`sgcad_core.reading.second_reader.encoder_tokens`); rows hold no word of a text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from research.rows import numbered_rows
from research.rows.numbered_rows import Row, rows_of_account
from sgcad_core.reading.second_reader.encoder_tokens import Narrative, narrative_of
from sgcad_core.reading.second_reader.learned_reader_features import account_of


class Case(NamedTuple):
    """A narrative with the questions that its codes answer; it has one at least."""

    told: Narrative
    rows: tuple[Row, ...]

    @property
    def part(self) -> str:
        """Taught, apart or blind."""
        return self.rows[0].part


def case_of(line: Mapping[str, Any]) -> Case | None:
    """A line of a pool; None where nothing of it can be asked."""
    account = account_of(line["text"])
    rows = tuple(rows_of_account(line, account))
    told = narrative_of(account)
    return Case(told, rows) if rows and len(told.codes) else None


def save(cases: Sequence[Case], file: Path) -> None:
    """Cases in two files of arrays: this one, and one for the questions beside it."""
    numbered_rows.save([row for case in cases for row in case.rows], _questions(file))
    arrays = {name: np.concatenate([getattr(case.told, name) for case in cases]) for name in Narrative._fields}
    ends = {"ends": np.cumsum([len(case.told.codes) for case in cases]), "rows": [len(case.rows) for case in cases]}
    with file.open("wb") as out:
        np.savez(out, **arrays, **ends)  # type: ignore[arg-type]


def load(file: Path) -> list[Case]:
    """The cases of a file."""
    with np.load(file) as kept:
        arrays = dict(kept)
    rows = iter(numbered_rows.load(_questions(file)))
    parts = [np.split(arrays[name], arrays["ends"][:-1]) for name in Narrative._fields]
    return [
        Case(Narrative(*told), tuple(next(rows) for _ in range(count)))
        for *told, count in zip(*parts, arrays["rows"], strict=True)
    ]


def _questions(file: Path) -> Path:
    return file.with_name(f"{file.stem}.questions{file.suffix}")
