"""A finished case's folder as other tools' files are made from it. Reads files; writes none."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from flows.case_files.case_folder import read_json
from flows.drive.script_of_case import script_of
from flows.export.ego_files import ego_of, no_ego, source_of
from sgcad_core.case.traffic import Background
from sgcad_core.errors import BadInput
from sgcad_core.formats.openscenario.writing.header import Source
from sgcad_core.handover.script import Script
from sgcad_core.records.specs import BehaviorSpec


@dataclass(frozen=True)
class FinishedCase:
    """An executed case on disk."""

    folder: Path

    @cached_property
    def script(self) -> Script:
        """Actors, trajectories and map. Raises BadInput."""
        return script_of(self.folder)

    @cached_property
    def result(self) -> dict[str, Any]:
        """result.json."""
        return read_json(self.folder / "result.json")

    @cached_property
    def background(self) -> Background:
        """The vehicles of its traffic, if it was run with some. Raises BadInput."""
        return self.script.background

    @property
    def source(self) -> Source:
        """What headers say of it."""
        return source_of(self.result)

    @cached_property
    def behavior(self) -> BehaviorSpec | None:
        """What was planned, where a spec was. Raises BadInput for a file that cannot be read."""
        file = self.folder / "specs.json"
        try:
            told = json.loads(file.read_text(encoding="utf-8")).get("behavior")
            return BehaviorSpec.model_validate(told) if told else None
        except FileNotFoundError:
            return None
        except (OSError, ValueError, AttributeError, ValidationError) as fault:
            raise BadInput(f"{file}: cannot be read ({type(fault).__name__}); run the case again") from fault

    @cached_property
    def xodr(self) -> str:
        """The map. Raises BadInput where it is missing."""
        file = self.folder / "road.xodr"
        try:
            return file.read_text(encoding="utf-8")
        except (OSError, ValueError) as fault:
            raise BadInput(f"{file}: cannot be read ({type(fault).__name__}); run the case again") from fault

    def ego(self, wanted: str) -> str:
        """The actor that a role or an id means. Raises ConfigError for an unknown id, or without one."""
        if (ego := ego_of(self.script, wanted)) is None:
            raise no_ego(self.script.case)
        return ego
