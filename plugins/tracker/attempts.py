"""The attempts of a case, read from attempts/<stage>-<nn>/ of its folder."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sgcad_core.findings import SOFT


@dataclass(frozen=True)
class Attempt:
    """One folder of attempts/: what was asked, what was answered, and what was wrong with it."""

    stage: str
    number: int
    seconds: float
    prompt: str
    answer: str
    findings: Sequence[Mapping[str, Any]]
    generation: Mapping[str, Any] | None
    """Figures of the model's answer; None where no model was asked."""

    @property
    def state(self) -> str:
        """The state that steps.json has of it."""
        found = {finding.get("severity") for finding in self.findings} - {"note"}
        if "refuse" in found:
            return "Refused"
        return "Repair" if found - set(SOFT) else "Doubted" if found else "Accepted"


def attempts_of(case_dir: Path) -> list[Attempt]:
    """The attempts that were kept, by stage and number."""
    return [_attempt(folder) for folder in sorted((case_dir / "attempts").glob("*-*")) if _number(folder) is not None]


def _number(folder: Path) -> int | None:
    number = folder.name.rpartition("-")[2]
    return int(number) if number.isdigit() else None


def _attempt(folder: Path) -> Attempt:
    about = read_json(folder / "attempt.json") or {}
    return Attempt(
        stage=folder.name.rpartition("-")[0],
        number=_number(folder) or 0,
        seconds=float(about.get("seconds") or 0.0),
        prompt=text_of(folder / "prompt.txt"),
        answer=text_of(folder / "answer.txt"),
        findings=tuple(read_json(folder / "findings.json") or ()),
        generation=about.get("generation"),
    )


def text_of(file: Path) -> str:
    """Content of a text file; "" if there is no such file."""
    return file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""


def read_json(path: Path) -> Any:
    """Content of a JSON file; None if there is no such file."""
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
