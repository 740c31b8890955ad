"""A finished case's folder as a script for drivers. Reads files and does not check them again."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from flows.case_files import case_folder
from flows.case_files.case_traffic import traffic_in
from sgcad_core.case.records import ActorInfo
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.handover.script import Script
from sgcad_core.kinds import CRASH_ROLES
from sgcad_core.records.specs import Contact, Surface

NEEDED = ("result.json", "trajectories.csv", "road.net.xml")
SURFACES: tuple[Surface, ...] = ("dry", "wet", "snow", "ice")


def case_folders(places: Iterable[Path]) -> list[Path]:
    """Folders of executed cases: the places themselves or folders below them. Raises BadInput where there is none."""
    found: dict[Path, None] = {}
    for place in places:
        executed = [f for f in _below(place) if all((f / name).is_file() for name in NEEDED)]
        if not executed:
            raise BadInput(
                f"{place}: no executed case ({', '.join(NEEDED)}); give a case's folder in runs/, or runs/ itself"
            )
        found |= dict.fromkeys(executed)
    return list(found)


def _below(place: Path) -> list[Path]:
    """The case itself, or those of a config or of several; not the copies that a tracker keeps deeper down."""
    if (place / NEEDED[0]).is_file():
        return [place]
    files = sorted(file for depth in ("*", "*/*") for file in place.glob(f"{depth}/{NEEDED[0]}"))
    return [file.parent for file in files if not any(part.startswith(".") for part in file.parts[-3:])]


def script_of(folder: Path, role_of: Mapping[str, str] | None = None) -> Script:
    """The script of a case. `role_of`: roles that a person gives, before those that were read. Raises BadInput."""
    try:
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        net_xml = (folder / "road.net.xml").read_text(encoding="utf-8")
        declared = result["collision"]["declared"]
        return Script(
            case=result["case"],
            actors=tuple(ActorInfo.model_validate(actor) for actor in result["actors"]),
            trajectories=case_folder.read_trajectories(folder / "trajectories.csv"),
            graph=parse_net(net_xml),
            declared=Contact.model_validate(declared) if declared else None,
            roles=roles_of(result.get("facts", ()), role_of or {}),
            surface=_surface(result.get("facts", ())),
            net_xml=net_xml,
            xosc=_text(folder / "scenario.xosc"),
            background=traffic_in(folder, result),
        )
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise BadInput(f"{folder}: no finished case that can be driven ({fault}); run it again") from fault


def _text(file: Path) -> str | None:
    """A file's text; None where it is not there: its case was written for another simulator."""
    return file.read_text(encoding="utf-8") if file.is_file() else None


def roles_of(facts: Iterable[Mapping[str, Any]], given: Mapping[str, str]) -> dict[str, str]:
    """Role by actor: those given, else those read. Raises ConfigError for a word that is no role."""
    wrong = [f"{name}={role}" for name, role in given.items() if role not in CRASH_ROLES]
    if wrong:
        raise ConfigError(f"role {wrong[0]}: no such role; roles: {', '.join(CRASH_ROLES)}")
    read = {f["field"].split(".")[1]: f["value"] for f in facts if f["field"].endswith(".role")}
    return read | dict(given)


def _surface(facts: Iterable[Mapping[str, Any]]) -> Surface | None:
    told = next((f["value"] for f in facts if f["field"] == "conditions.surface"), None)
    return next((s for s in SURFACES if s == told), None)


def egos(script: Script, ego: str, roles: Sequence[str]) -> list[tuple[str, str]]:
    """(actor, role) to be driven: the named one, else the first drivable one of each role."""
    if ego:
        script.info(ego)
        return [(ego, script.roles.get(ego, "bystander"))]
    return [(name, role) for role in roles if (name := script.ego_of(role)) is not None]
