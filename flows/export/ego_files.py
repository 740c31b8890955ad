"""The files by which a crash is handed to a stack: ego.xosc, the same for CARLA, scripts that start them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from sgcad_core.case.traffic import Background
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError
from sgcad_core.formats.openscenario.writing.header import Source, today
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_VERSION, Version
from sgcad_core.handover.ego_file import scripts
from sgcad_core.handover.script import Script, staging_for
from sgcad_core.records.specs import BehaviorSpec
from sgcad_core.result import CaseRecord

ROLES = ("responder", "initiator", "bystander")
"""In the order in which an ego is sought."""
NO_EGO = "none"
CARLA: Version = "1.0"
"""The version that scenario_runner reads."""
MOST_ASSUMED = 12


def ego_of(script: Script, wanted: str) -> str | None:
    """The actor that a role or an id means; of a role without a drivable actor the next one's, None without any.

    Raises ConfigError for an id that the case does not have.
    """
    if wanted not in ROLES:
        return script.info(wanted).id
    sought = (wanted, *(role for role in ROLES if role != wanted))
    named = next((name for role in sought if (name := script.ego_of(role))), None)
    return named or next((a.id for a in script.actors if a.record.driven), None)


def write_ego_files(
    folder: Path, script: Script, ego: str, source: Source, behavior: BehaviorSpec | None, xodr: str | None,
    version: Version, background: Background = (),
) -> list[Path]:  # fmt: skip
    """Write the four files into a folder that holds road.xodr; their paths. Raises ConfigError, InvalidOutput."""
    from sgcad_core.handover.ego_file.write import EgoFile, write_ego

    staging = staging_for(script, ego)
    texts = {scripts.ESMINI: scripts.RUN_ESMINI, scripts.CARLA: scripts.run_carla(ego)}
    for name, minor in ((scripts.FILE, version), (scripts.CARLA_FILE, CARLA)):
        texts[name] = write_ego(staging, EgoFile(source, behavior, xodr, minor, background=background))
    written = []
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
        written.append(folder / name)
    (folder / scripts.ESMINI).chmod((folder / scripts.ESMINI).stat().st_mode | 0o100)
    return written


def write_beside_case(
    folder: Path, script: Script, record: CaseRecord, config: Config, source: Source, background: Background = ()
) -> None:
    """Write the files of an executed case's ego as the config chooses it, where the case has such an actor."""
    with suppress(ConfigError):  # an id that this case does not have
        if (ego := ego_of(script, config.ego)) and record.network and record.scenario:
            version = getattr(config.scenario_writer, "openscenario", DEFAULT_VERSION)
            about = source, record.scenario.behavior, record.network.xodr, version, background
            write_ego_files(folder, script, ego, *about)


def source_of(result: Mapping[str, Any]) -> Source:
    """What headers say of a case, by its result.json."""
    return Source(result["case"], about(result["collision"]["declared"]), assumed(result.get("facts", ())), today())


def about(declared: Mapping[str, Any] | None) -> str:
    """The crash in a few words, for a header."""
    if not declared:
        return ""
    return f"{declared['striker']} {declared['striker_area']} strikes {declared['struck']} {declared['struck_area']}"


def assumed(facts: Iterable[Mapping[str, Any]]) -> tuple[str, ...]:
    """What no report told, in words; the first dozen."""
    lines = [f"{fact['field']} = {_value(fact['value'])}" for fact in facts if fact.get("status") == "default"]
    more = len(lines) - MOST_ASSUMED
    return (*lines[:MOST_ASSUMED], *([f"{more} more (result.json, facts)"] if more > 0 else ()))


def _value(value: object) -> str:
    return ", ".join(map(str, value)) if isinstance(value, Sequence) and not isinstance(value, str) else str(value)


def no_ego(case: str) -> ConfigError:
    """The error of a case without a drivable actor."""
    return ConfigError(f"{case}: no actor that a driver can control; a stack needs a vehicle")
