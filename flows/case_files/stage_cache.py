"""Stages that several configs share: computed once, kept in a folder, reused by the others.

A stage's key is a fingerprint of all that it depends on: the evidence as the reader gave it, the passages, the
network for a scenario, and what the config contributes (`Keys`). So two arms that differ in the scenario
writer share their roads, and ten that differ in the number of attempts share every attempt. The folder is only
a cache: a missing, damaged or deleted file is computed again with the same result. Others may be able to write into
it: its files are read as validated JSON records, never as code (`flows.case_files.record_json`).
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from flows.case_files import find_cases, record_json
from flows.case_files.record_json import Unpackable, pack, unpack
from sgcad_core import findings
from sgcad_core.asking import refine, schema_holds
from sgcad_core.asking.refine import Refinement, Turn
from sgcad_core.case import evidence, records
from sgcad_core.case.records import CrashReport, Execution
from sgcad_core.config import Config
from sgcad_core.interfaces import Plugin
from sgcad_core.records import facts, second_reader, specs
from sgcad_core.system.locks import lock_file

_RECORDS = (evidence, facts, findings, second_reader, records, specs, refine, schema_holds, record_json)
"""Modules that define the content of kept steps; other code in them is another cache."""
T = TypeVar("T")
WAIT_S = 3600.0
"""Longest wait for another process that computes the same; then it is computed here as well."""


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
    return _about(asked, asks_model=True) | {"prompt": config.second_opinion, "seed": config.seed}


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


# ------------------------------------------------------------------ the folder
@dataclass(frozen=True)
class Shelf:
    """Results by key: one file each, appearing whole, checked when read."""

    folder: Path

    def get(self, key: str) -> Any | None:
        """The value of a key; None if it is missing or cannot be read."""
        try:
            check, _, packed = self._file(key).read_bytes().partition(b"\n")
            if hashlib.sha256(packed).hexdigest().encode() != check:
                return None
            return unpack(packed)
        except (OSError, Unpackable):
            return None

    def put(self, key: str, value: Any) -> None:
        """Keep a value. A full disk, a removed folder or a foreign record costs the sharing, not the case."""
        file = self._file(key)
        try:
            packed = pack(value)
            file.parent.mkdir(parents=True, exist_ok=True)
            made, partial = tempfile.mkstemp(prefix=f"{key}.", suffix=".partial", dir=file.parent)
            with os.fdopen(made, "wb") as out:
                out.write(hashlib.sha256(packed).hexdigest().encode() + b"\n" + packed)
            os.replace(partial, file)
        except (OSError, TypeError):
            return

    @contextmanager
    def alone(self, key: str) -> Iterator[None]:
        """Holds a key's lock while the block lasts; it ends with its process, and waiting for it has a limit."""
        lock = self._file(key).with_suffix(".lock")
        with ExitStack() as held:
            with suppress(OSError):  # among them the end of the wait
                lock.parent.mkdir(parents=True, exist_ok=True)
                held.enter_context(lock_file(lock, WAIT_S))
            yield

    def timed(self, key: str, compute: Callable[[], tuple[T, float]]) -> tuple[T, float, bool]:
        """A value, the seconds of its computation, and whether it was kept before."""
        if (found := self._timed(key)) is not None:
            return (*found, True)
        with self.alone(key):
            if (found := self._timed(key)) is not None:
                return (*found, True)
            made = compute()
            self.put(key, made)
            return (*made, False)

    def _timed(self, key: str) -> tuple[Any, float] | None:
        found = self.get(key)
        if not (isinstance(found, tuple) and len(found) == 2 and isinstance(found[1], float)):
            return None
        return found if isinstance(found[0], CrashReport | Execution) else None

    def turns(self, key: str, refinement: Refinement) -> tuple[list[Turn], int]:
        """A stage's turns, and how many of them were kept before.

        Kept turns are reused up to the config's limit; a config with a higher limit continues from them.
        """
        turns = self._fitting(key, refinement)
        if refinement.ended(turns):
            return turns, len(turns)
        with self.alone(key):
            found = self._fitting(key, refinement)
            if refinement.ended(found):
                return found, len(found)
            turns = refinement.turns(found)
            self.put(key, turns)
            return turns, len(found)

    def _fitting(self, key: str, refinement: Refinement) -> list[Turn]:
        found = self.get(key)
        if not (isinstance(found, list) and all(isinstance(turn, Turn) for turn in found)):
            return []
        return found[: refinement.limit]

    def _file(self, key: str) -> Path:
        return self.folder / key[:2] / key


@dataclass(frozen=True)
class Sharing:
    """Access of one job to the shelf; can be pickled."""

    folder: Path
    keys: Keys
    source: str
    """Fingerprint of the report's files."""

    @property
    def shelf(self) -> Shelf:
        """The folder where results are kept."""
        return Shelf(self.folder)

    def key(self, step: str, *content: Any) -> str:
        """A step's key, from the config's part and the step's inputs."""
        files = self.source if step == "read" else ""
        return hashlib.sha256(f"{step} {getattr(self.keys, step)} {files} {content_of(content)}".encode()).hexdigest()


def refined(sharing: Sharing | None, refinement: Refinement, *content: Any) -> tuple[list[Turn], int]:
    """A stage's turns, and how many of them were taken from the shelf."""
    if sharing is None:
        return refinement.turns(), 0
    return sharing.shelf.turns(sharing.key(refinement.stage, *content), refinement)


def timed(sharing: Sharing | None, step: str, compute: Callable[[], T], *content: Any) -> tuple[T, float, bool]:
    """A step's value, the seconds that its computation took, and whether it was taken from the shelf."""

    def work() -> tuple[T, float]:
        started = time.perf_counter()
        return compute(), time.perf_counter() - started

    if sharing is None:
        return (*work(), False)
    return sharing.shelf.timed(sharing.key(step, *content), work)
