"""The traffic of a finished case, as its folder has it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from flows.case_files.case_folder import read_trajectories
from sgcad_core.case.records import ActorInfo
from sgcad_core.case.traffic import ROLE, Background
from sgcad_core.errors import BadInput


def traffic_in(folder: Path, result: Mapping[str, Any]) -> Background:
    """The background vehicles of a finished case, none where it was run without. Raises BadInput."""
    told = (result.get("traffic") or {}).get("vehicles", ())
    if not told:
        return ()
    try:
        infos = {info.id: info for info in map(ActorInfo.model_validate, told)}
        tracks = read_trajectories(folder / "trajectories.csv", ROLE)
        return tuple((infos[track.actor], track) for track in tracks)
    except (OSError, KeyError, TypeError, ValidationError) as fault:
        raise BadInput(f"{folder}: its traffic cannot be read ({type(fault).__name__}); run the case again") from fault
