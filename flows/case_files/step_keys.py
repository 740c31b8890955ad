"""Keys of a case's steps, under which their results are kept for other configs.

A key is a fingerprint of all that a step depends on: the evidence as the reader gave it, the passages, the network for
a scenario, the attempts before, and what the config contributes (`Keys`). So two arms that differ in the scenario
writer share their roads, and ten that differ in the number of attempts share every attempt.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from flows.case_files import find_cases, record_json
from sgcad_core import findings
from sgcad_core.asking import refine, repairs, schema_holds
from sgcad_core.asking.refine import Turn
from sgcad_core.case import evidence, records
from sgcad_core.config import Config
from sgcad_core.interfaces import Plugin
from sgcad_core.records import facts, place, second_reader, specs

_RECORDS = (evidence, facts, findings, second_reader, records, specs, place, refine, repairs, schema_holds, record_json)
"""Modules that define the content of kept results; other code in them is another key."""


@dataclass(frozen=True)
class Keys:
    """A config's part in the keys of its steps."""

    read: str
    opinion: str
    road: str
    scenario: str
    simulate: str


def keys_of(config: Config) -> Keys:
    """The fingerprints of a config's steps: plugins with fields and versions, files they name, prompts, code."""
    return Keys(
        read=_digest(_about([config.report_reader], asks_model=False)),
        opinion=_digest(_opinion(config)),
        road=_stage(config, config.road_writer, "road"),
        scenario=_stage(config, config.scenario_writer, "scenario"),
        simulate=_digest(_about([config.simulator], asks_model=False)),
    )


def _opinion(config: Config) -> dict[str, Any]:
    """The inputs of a second opinion beside the report; a model's weights are part of the prompts' digest."""
    if not config.second_opinion:
        return {}
    if config.second_opinion == second_reader.LEARNED:
        return _about([], asks_model=False) | {"weights": find_cases.opinion_digests(config)}
    asked = [p for p in (config.backbone, config.decoder) if p is not None]
    about = {"prompt": config.second_opinion, "seed": config.seed, "weights": find_cases.opinion_digests(config)}
    return _about(asked, asks_model=True) | about


def _stage(config: Config, writer: Any, stage: str) -> str:
    """Key of a stage. The number of attempts is no part of it: fewer attempts are the first of many."""
    plugins: list[Plugin] = [writer, *config.validators_of(stage)]
    asked = [p for p in (config.backbone, config.decoder) if p is not None] if writer.asks_model else []
    about = _about([*plugins, *asked], writer.asks_model)
    if writer.asks_model:
        about |= {key: getattr(config, key) for key in ("seed", "show_findings", "hold_findings")}
    return _digest(about | {"stage": stage})


def _about(plugins: Sequence[Plugin], asks_model: bool) -> dict[str, Any]:
    fields = [p.model_dump(mode="json") for p in plugins]
    return {
        "plugins": [(find_cases.qualified(p), *find_cases.identity(p)) for p in plugins],
        "fields": fields,
        "files": sorted(set(find_cases.named_digests(fields))),
        "package": version("sg-cadvlm"),
        "code": find_cases.code_digest(asks_model),
        "records": _records_digest(),
    }


@cache
def _records_digest() -> str:
    """Other records are another cache."""
    files = (Path(str(module.__file__)) for module in _RECORDS)
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _digest(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def content_of(value: Any) -> str:
    """Fingerprint of records and plain values by content; arrays count by their bytes."""
    found = hashlib.sha256()
    _feed(found, value)
    return found.hexdigest()


def _feed(found: Any, value: Any) -> None:
    if isinstance(value, BaseModel):
        value = {name: getattr(value, name) for name in type(value).model_fields}  # no reading, which follows from them
    if isinstance(value, Turn):  # of an attempt, what the next one depends on
        value = [value.attempt.answer, value.attempt.findings, value.attempt.held]
    if isinstance(value, dict):
        value = sorted(value.items())
    if isinstance(value, list | tuple):
        found.update(b"(%d" % len(value))
        for inner in value:
            _feed(found, inner)
    else:
        data = value.tobytes() if hasattr(value, "tobytes") else value if isinstance(value, bytes) else None
        data = repr(value).encode("utf-8", "surrogatepass") if data is None else data
        found.update(b"%s %d:" % (type(value).__name__.encode(), len(data)))
        found.update(data)


@dataclass(frozen=True)
class StepKeys:
    """The keys of one case's steps under one config; can be pickled."""

    keys: Keys
    case: str
    source: str
    """Fingerprint of the report's files."""

    def key(self, step: str, *content: Any) -> str:
        """A step's key, from the config's part and the step's inputs."""
        files = self.source if step == "read" else ""
        about = f"{step} {getattr(self.keys, step)} {self.case} {files} {content_of(content)}"
        return hashlib.sha256(about.encode()).hexdigest()
