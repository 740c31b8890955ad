"""The name of the folder of a config's results, and the config.yaml inside it.

    template.yaml                                runs/template
    template.yaml --set max_attempts=3           runs/template-max_attempts_3
    template.yaml --places maps/town.osm.bz2     runs/template-town

So runs with different overrides have different folders. An edited YAML keeps its folder; the difference is reported
before its results are replaced. Trackers and judges change no artifact and therefore no name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from flows.case_files.case_folder import CONFIG
from flows.case_files.find_cases import safe_id
from flows.study_file.cross_product import name_of
from sgcad_core.config import Config
from sgcad_core.system.yaml_faults import YAML_FAULTS

NO_ARTIFACT = ("judge", "tracker")
_LOGIN = re.compile(r"//[^/@\s]+@")


def named(config: Config, overrides: Sequence[str]) -> Config:
    """The config, renamed by its overrides if they change results."""
    pairs = (text.partition("=") for text in overrides)
    factors = {key: _short(yaml.safe_load(value)) for key, _, value in pairs if key.split(".")[0] not in NO_ARTIFACT}
    if not factors:
        return config
    return config.model_copy(update={"name": safe_id(f"{config.name}-{name_of(factors)}")})


def _short(value: Any) -> Any:
    """The name of a file or folder in the place of its path, without its endings."""
    return Path(value).name.partition(".")[0] if isinstance(value, str) and "/" in value else value


def write(folder: Path, config: Config) -> None:
    """Write the effective config into the folder of its results; logins in addresses are removed."""
    folder.mkdir(parents=True, exist_ok=True)
    text = yaml.safe_dump(dict(config.raw), sort_keys=False, allow_unicode=True)
    (folder / CONFIG).write_text(without_logins(text), encoding="utf-8")


def without_logins(text: str) -> str:
    """The text with the logins removed from its addresses."""
    return _LOGIN.sub("//", text)


def replaced(folder: Path, config: Config) -> str:
    """A warning if the folder holds results of a different config of that name, else an empty text."""
    try:
        before = yaml.safe_load((folder / CONFIG).read_text(encoding="utf-8"))
    except (OSError, *YAML_FAULTS):
        return ""
    held = sum(1 for _ in folder.glob("*/result.json"))
    keys = sorted(set(_differing(before, config.raw))) if isinstance(before, dict) else []
    if not held or not keys:
        return ""
    return (
        f"{folder} holds {held} results of another {config.name}: {', '.join(keys)} differ. Each is replaced when "
        "its case runs again; to keep them, choose another --out or rename the YAML"
    )


def _differing(before: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    for key in {*before, *now} - {*NO_ARTIFACT}:
        if _plain(before.get(key)) != _plain(now.get(key)):
            yield key


def _plain(entry: Any) -> Any:
    """A plugin given by name only, as a mapping."""
    if isinstance(entry, list):
        return [_plain(inner) for inner in entry]
    return {"name": entry} if isinstance(entry, str) else entry
