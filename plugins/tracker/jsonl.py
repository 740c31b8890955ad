"""One JSON line for each case: needs no further library, and any script can read it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pydantic import Field

from plugins.tracker.figures import case_figures
from sgcad_core.case.records import Generation, Query
from sgcad_core.interfaces import Tracker


class Jsonl(Tracker):
    """Appends one line for each case to `cases.jsonl` and, with `folder` set, one for each model call to `calls.jsonl`.

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

    def log_generation(self, config_name: str, case: str, query: Query, generation: Generation) -> None:
        """Appends the call to calls.jsonl if `folder` is set."""
        if self.folder is not None:
            line: dict[str, Any] = {"config": config_name, "case": case, "query": query.model_dump()}
            line |= {"text": generation.text, "seconds": generation.seconds, "grounding": dict(generation.grounding)}
            self._append(self.folder, "calls.jsonl", line)

    @staticmethod
    def _append(folder: Path, name: str, line: dict[str, Any]) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / name).open("a", encoding="utf-8") as file:
            file.write(json.dumps(line, ensure_ascii=False, default=str) + "\n")
