"""Types of the parameters of deployed flows: what Prefect's form offers and checks.

A list of configs or studies is that of the moment when the flows are deployed; any other name or path may be typed.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, WithJsonSchema

from flows.study_file.spec import STUDIES
from sgcad_core.settings import CONFIGS


def _one_of(kind: str, files: Iterable[Path], folder: Path) -> WithJsonSchema:
    """A name from a list, or other text."""
    names = sorted(str(file.relative_to(folder)) for file in files)
    offered: dict[str, Any] = {"type": "string", "title": f"a {kind} of the project", "enum": names}
    return WithJsonSchema({"anyOf": [offered, {"type": "string", "title": "a file of your own", "format": "path"}]})


Config = Annotated[str, _one_of("config", [*CONFIGS.glob("*.yaml"), *CONFIGS.glob("paper/*.yaml")], CONFIGS)]
Study = Annotated[str, _one_of("study", STUDIES.glob("*.yaml"), STUDIES)]
Jobs = Annotated[int | None, Field(ge=1, le=64)]
Seconds = Annotated[float, Field(ge=0, le=3600)]
Share = Annotated[float, Field(ge=0, le=1)]
Factor = Annotated[float, Field(ge=1)]
