"""Files of a case's folder as pages show them: regular files inside the folder alone.

A pipe never ends, a link shows another's file, and a file may be too large for a page: such a file is as good as
missing, and `odd_files` names it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from flows.desk.views.result_shape import shape_fault
from sgcad_core.errors import BadInput
from sgcad_core.system.report_files import is_regular, leads_inside, read_regular

FILES: Mapping[str, str] = {
    "scenario.xosc": "OpenSCENARIO", "ego.xosc": "OpenSCENARIO, a vehicle is yours", "road.xodr": "OpenDRIVE",
    "scenario.rou.xml": "SUMO routes", "road.net.xml": "SUMO network", "traffic.rou.xml": "SUMO traffic",
    "trajectories.csv": "trajectories", "metrics.json": "metrics", "result.json": "result", "report.txt": "report",
    "facts.yaml": "edits", "crash.mp4": "film", "crash.gif": "film",
}  # fmt: skip
"""Files of a case's folder that can be downloaded."""
RESULT = "result.json"
KEPT = (".source", "links.json", "player.html", "specs.json", "attempts")
"""Further entries of a case's folder that pages go by."""
LARGEST = 64 * 2**20
"""Bytes of a file above which it is neither read nor handed out."""
LARGEST_TEXT = 4 * 2**20
"""Bytes of a text that is shown on a page."""


class OddResult(ValueError):
    """A result.json that is none; the message says what is odd."""


def is_there(folder: Path, name: str) -> bool:
    """Whether a case's folder has a regular file of this name inside."""
    return is_regular(folder / name) and leads_inside(folder / name, folder)


def content_of(folder: Path, name: str, most: int = LARGEST) -> bytes:
    """A file's bytes. Raises BadInput where it is no regular file inside the folder, or larger than `most`."""
    return read_regular(folder / name, folder, most)


def text_of(folder: Path, name: str) -> str:
    """A file as text; "" where it is not to be shown."""
    try:
        return content_of(folder, name, LARGEST_TEXT).decode("utf-8", "replace")
    except BadInput:
        return ""


def json_of(folder: Path, name: str) -> Any:
    """A file's JSON; {} where there is none."""
    try:
        return json.loads(text_of(folder, name))
    except (ValueError, RecursionError):
        return {}


def result_in(folder: Path) -> dict[str, Any]:
    """A case's result. Raises OddResult for what is no result, BadInput for a file that is not read."""
    try:
        result = json.loads(content_of(folder, RESULT))
    except (ValueError, RecursionError) as fault:
        raise OddResult(f"{RESULT} is no JSON ({type(fault).__name__}: {str(fault)[:100]})") from fault
    if odd := shape_fault(result):
        raise OddResult(f"{RESULT} is no result: {odd}")
    return dict(result)


def odd_files(folder: Path) -> Iterator[str]:
    """A line for each entry that is there and not shown: no regular file, outside the folder, or too large."""
    for name in (*FILES, *KEPT):
        place = folder / name
        try:
            size = place.lstat().st_size
        except OSError:
            continue
        if not leads_inside(place, folder):
            yield f"{name} leads out of the case's folder and is not shown"
        elif name == "attempts":
            yield from () if place.is_dir() else (f"{name} is no folder and is not shown",)
        elif not is_regular(place):
            yield f"{name} is no regular file and is not shown"
        elif size > LARGEST:
            yield f"{name} has {size / 1e6:.0f} MB and is not shown"


def diagrams_of(folder: Path) -> list[Path]:
    """The report's drawings, in their order."""
    rest = sorted(folder.glob("diagram-*.png"), key=lambda file: (len(file.name), file.name))
    return [file for file in (folder / "diagram.png", *rest) if is_there(folder, file.name)]
