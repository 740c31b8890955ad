"""The formats of `sgcad export`: one function each, which writes a case's files and names them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from flows.export.ego_files import write_ego_files
from flows.export.finished_case import FinishedCase
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_VERSION, Version


@dataclass(frozen=True)
class Wish:
    """What a person chose."""

    ego: str = "responder"
    """A role or an actor's id."""
    version: Version = DEFAULT_VERSION


def _ego(case: FinishedCase, place: Path, wish: Wish) -> list[Path]:
    """`ego.xosc` with its map and scripts, in a folder of the ego's name."""
    ego = case.ego(wish.ego)
    folder = place / ego
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "road.xodr").write_text(case.xodr, encoding="utf-8")
    return write_ego_files(folder, case.script, ego, case.source, case.behavior, case.xodr, wish.version)


FORMATS: Mapping[str, Callable[[FinishedCase, Path, Wish], list[Path]]] = {"ego": _ego}
