"""Reads compose.yaml as Docker does as far as this project uses it: variables, merge keys, services.

Knows no Docker. `python -m research.checks.compose_services` starts the same commands without it, and tests check the
values.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from sgcad_core import settings
from sgcad_core.errors import ConfigError

FILE = settings.ROOT / "deploy" / "compose.yaml"
EXAMPLE = settings.ROOT / "deploy" / ".env.example"
_VARIABLE = re.compile(r"\$\{(?P<name>\w+)(?::(?P<kind>[-?])(?P<text>[^}]*))?\}")


def raw(file: Path = FILE) -> dict[str, Any]:
    """The file's content, with merge keys resolved and variables not."""
    content: dict[str, Any] = yaml.safe_load(file.read_text(encoding="utf-8"))
    return content


def services(environment: Mapping[str, str], file: Path = FILE) -> dict[str, dict[str, Any]]:
    """Services with their variables filled in. Raises ConfigError naming each that is demanded and missing."""
    missing: list[str] = []
    filled: dict[str, dict[str, Any]] = _filled(raw(file)["services"], environment, missing)
    if missing:
        raise ConfigError("; ".join(dict.fromkeys(missing)))
    return filled


def _filled(value: Any, environment: Mapping[str, str], missing: list[str]) -> Any:
    if isinstance(value, dict):
        return {key: _filled(inner, environment, missing) for key, inner in value.items()}
    if isinstance(value, list):
        return [_filled(inner, environment, missing) for inner in value]
    if not isinstance(value, str):
        return value

    def one(found: re.Match[str]) -> str:
        given = environment.get(found["name"], "")
        if not given and found["kind"] == "?":
            missing.append(f"{found['name']}: {found['text']}")
        return given or (found["text"] if found["kind"] == "-" else "")

    return _VARIABLE.sub(one, value)


def read_environment(file: Path) -> dict[str, str]:
    """An environment file: NAME=value a line, `#` for comments."""
    lines = (line.strip() for line in file.read_text(encoding="utf-8").splitlines())
    return dict(line.split("=", 1) for line in lines if "=" in line and not line.startswith("#"))
