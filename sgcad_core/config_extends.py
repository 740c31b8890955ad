"""A YAML written as its differences to another one, its base.

    extends: mini.yaml              # beside this file, else under configs/
    decoder: {alpha: 0.3}           # a mapping changes the base's, key by key ...
    retriever: {name: lancedb}      # ... but takes its place where it names another plugin
    simulator: kinematic            # a word, a number or a list takes its place
    backbone: null                  # removes it; a null in a mapping removes that field

One level: a base stands by itself. Knows files and mappings; no plugin and no study.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from sgcad_core.errors import ConfigError
from sgcad_core.near_names import did_you_mean
from sgcad_core.system.yaml_faults import YAML_FAULTS

KEY = "extends"
Merge = Callable[[Mapping[str, Any], Mapping[str, Any]], dict[str, Any]]


def merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The base with the changes made, as if written out. Neither is changed; order is the base's."""
    found = dict(base)
    for key, value in changes.items():
        if value is None:
            found.pop(key, None)
        else:
            found[key] = block(found.get(key), value) if isinstance(value, Mapping) else value
    return found


def block(base: Any, changes: Mapping[str, Any]) -> dict[str, Any]:
    """A mapping on the base's: merged, or in its place if there is none or another plugin is named."""
    held = named(base)
    if not isinstance(held, Mapping) or changes.get("name", held.get("name")) != held.get("name"):
        return dict(changes)
    given = {key: value for key, value in changes.items() if value is not None}
    return {key: value for key, value in {**held, **given}.items() if key in given or key not in changes}


def named(entry: Any) -> Any:
    """A plugin that is only named, as a mapping; else the entry."""
    return {"name": entry} if isinstance(entry, str) else entry


def written_out(
    file: Path, expected: str, folders: Sequence[Path], merge: Merge = merged
) -> tuple[dict[str, Any], Path | None]:
    """A YAML's mapping with its base's under it, and the base. Raises ConfigError naming both files.

    `expected` says what the mapping holds; `folders` are searched for the base after the file's own.
    """
    changes = mapping_of(file, expected, str(file))
    if KEY not in changes:
        return changes, None
    base = _found(file, changes.pop(KEY), folders)
    whole = mapping_of(base, expected, f"{file}: extends {base}")
    if KEY in whole:
        raise ConfigError(_chain(file, base, whole[KEY]))
    if lost := _nothing_to_remove(whole, changes):
        raise ConfigError("\n".join([f"{file} (extends {base}): {len(lost)} fault(s)", *(f"  {one}" for one in lost)]))
    return merge(whole, changes), base


def mapping_of(file: Path, expected: str, where: str) -> dict[str, Any]:
    """The mapping in a file, as it stands there. Raises ConfigError that begins with `where`."""
    try:
        raw = yaml.safe_load(file.read_text(encoding="utf-8"))
    except (*YAML_FAULTS, OSError) as fault:
        raise ConfigError(f"{where}: cannot be read as YAML: {fault}") from fault
    if not isinstance(raw, dict):
        raise ConfigError(f"{where}: expected a mapping {expected}, found {type(raw).__name__}")
    return raw


def base_of(file: Path, name: Any, folders: Sequence[Path]) -> Path | None:
    """The file that `extends: NAME` means: beside the YAML, else in the folders; None where there is none."""
    places = [folder / name for folder in (file.parent, *folders)] if isinstance(name, str) and name else []
    return next((place for place in places if place.is_file()), None)


def _found(file: Path, name: Any, folders: Sequence[Path]) -> Path:
    if not isinstance(name, str) or not name:
        raise ConfigError(f"{file}: extends: expected the name of one YAML, such as template.yaml, found {name!r}")
    base = base_of(file, name, folders)
    if base is None:
        known = sorted(f.name for f in folders[0].glob("*.yaml"))
        places = " or ".join(f"{folder.name}/" for folder in folders)
        raise ConfigError(
            f"{file}: extends {name!r}: no such file beside it or under {places}."
            f"{did_you_mean(name, known)} In {folders[0].name}/: {', '.join(known)}"
        )
    if base.resolve() == file.resolve():
        raise ConfigError(f"{file}: extends itself: name another YAML, or leave `extends` out and write it whole")
    return base


def _chain(file: Path, base: Path, further: Any) -> str:
    """What is wrong with a base that has a base."""
    if isinstance(further, str) and (base.parent / further).resolve() == file.resolve():
        return f"{file}: extends {base}, which extends {file.name} in turn: a circle; write one of the two whole"
    return (
        f"{file}: extends {base}, which itself extends {further!r}: a base stands by itself; extend {further} here "
        f"and repeat what {base.name} changes, or write {base.name} whole"
    )


def _nothing_to_remove(base: Mapping[str, Any], changes: Mapping[str, Any]) -> list[str]:
    """Nulls for what the base does not have: slips of the pen that would pass unseen."""
    faults = [_absent("", key, base) for key, value in changes.items() if value is None and key not in base]
    for key, value in changes.items():
        held = named(base.get(key))
        if isinstance(value, Mapping) and isinstance(held, Mapping) and value.get("name") in (None, held.get("name")):
            faults += [_absent(f"{key}.", k, held) for k, v in value.items() if v is None and k not in held]
    return faults


def _absent(place: str, key: Any, held: Mapping[str, Any]) -> str:
    known = [str(one) for one in held]
    return (
        f"{place}{key}: null removes a key of the base, and the base has none of this name."
        f"{did_you_mean(str(key), known)} The base has: {', '.join(known)}"
    )
