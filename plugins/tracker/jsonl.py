"""One JSON line for each case: needs no further library, and any script can read it."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import Field

from plugins.tracker.attempts import attempts_of
from plugins.tracker.figures import case_figures
from sgcad_core.interfaces import Tracker


class Jsonl(Tracker):
    """Appends a line for each case to `cases.jsonl` and, with `folder` set, one for each model answer to `calls.jsonl`.

    A line is written by one `write` in append mode, so several processes may share the files.
    """

    folder: Path | None = Field(None, description="where the files lie; default: the output folder")

    def log_case(self, config_name: str, params: dict[str, Any], case_dir: Path, result: dict[str, Any]) -> None:
        """Appends {"config", "params", "figures", "result", "case_dir"} to cases.jsonl."""
        line = {
            "config": config_name,
            "case_dir": str(case_dir),
            "params": params,
            "figures": case_figures(case_dir, result),
            "result": result,
        }
        self._append(self.folder or case_dir.parent.parent, "cases.jsonl", line)
        if self.folder is not None:
            for attempt in attempts_of(case_dir):
                if attempt.generation:
                    of = {"config": config_name, "case": case_dir.name, **asdict(attempt)}
                    self._append(self.folder, "calls.jsonl", of)

    @staticmethod
    def _append(folder: Path, name: str, line: dict[str, Any]) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / name).open("a", encoding="utf-8") as file:
            file.write(json.dumps(line, ensure_ascii=False, default=str) + "\n")
