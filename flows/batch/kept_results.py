"""Results of steps in Prefect's result storage: their keys, locks and form, which is JSON of records and never code.

Others may be able to write into a shared storage. A kept file that is damaged, or of another serializer (Prefect would
unpickle it), is removed and its step runs again. Prefect's own file locks outlive a killed process; those here are the
system's. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from filelock import FileLock
from prefect.cache_policies import CachePolicy
from prefect.context import TaskRunContext
from prefect.serializers import Serializer

from flows.batch.remote import store
from flows.case.steps import Held, Setup
from flows.case_files.record_json import Unpackable, pack, unpack
from sgcad_core.asking.refine import Turn
from sgcad_core.case.records import CrashReport, Execution

TYPE: Literal["sgcad-records"] = "sgcad-records"
STEPS = {"read": CrashReport, "opinion": CrashReport, "road": Turn, "scenario": Turn, "simulate": Execution}
"""Steps whose results are kept, and what they are."""
_held: dict[tuple[Path, str], tuple[str, FileLock]] = {}
"""Locks that this process holds, by folder and key, with their holders."""
WAIT_S = 3600.0
"""Longest wait for another process that makes the same; then it is made here as well."""


class KeptRecords(Serializer):  # not Serializer[...]: Prefect dispatches on the plain class
    """Held values as packed JSON; None for bytes that are no such value."""

    type: Literal["sgcad-records"] = TYPE

    def dumps(self, obj: Held[Any]) -> bytes:
        """The value and its seconds, base64. Raises TypeError for what is no record."""
        return base64.b64encode(pack((obj.value, obj.seconds)))

    def loads(self, blob: bytes) -> Held[Any] | None:
        """The held value again, marked as kept."""
        try:
            value, seconds = unpack(base64.b64decode(blob))
            return Held(value, float(seconds), kept=True)
        except (ValueError, TypeError, Unpackable):
            return None


@dataclass
class StepPolicy(CachePolicy):
    """A step's key by its config and its inputs' content; none for steps whose results are not kept."""

    def compute_key(
        self, task_ctx: TaskRunContext, inputs: dict[str, Any], flow_parameters: dict[str, Any], **kwargs: Any
    ) -> str | None:
        """The key of a task run; None: its result is not kept."""
        setup, step = inputs["setup"].value, task_ctx.task.name
        if not isinstance(setup, Setup) or setup.keys is None or step not in STEPS:
            return None
        key = setup.keys.key(step, *(_content(name, value) for name, value in inputs.items() if name != "setup"))
        own_record(task_ctx.result_store.result_storage, key)
        return key


@dataclass(frozen=True)
class StepLocks:
    """Prefect's lock manager on lock files that end with their process: a step is made once, the others wait for it."""

    folder: Path

    def acquire_lock(
        self, key: str, holder: str, acquire_timeout: float | None = None, hold_timeout: float | None = None
    ) -> bool:
        """Take a key's lock. A folder that cannot be written costs the sharing only."""
        lock = FileLock(self._file(key), thread_local=False)
        with suppress(OSError):  # among them the end of the wait
            self.folder.mkdir(parents=True, exist_ok=True)
            lock.acquire(timeout=acquire_timeout or WAIT_S)
        _held[self.folder, key] = holder, lock
        return True

    async def aacquire_lock(
        self, key: str, holder: str, acquire_timeout: float | None = None, hold_timeout: float | None = None
    ) -> bool:
        """`acquire_lock`."""
        return self.acquire_lock(key, holder, acquire_timeout, hold_timeout)

    def release_lock(self, key: str, holder: str) -> None:
        """Give a key's lock back, once: Prefect does so for a transaction and again for the one around it."""
        if (held := _held.pop((self.folder, key), None)) and held[1].is_locked:
            self._file(key).unlink(missing_ok=True)
            held[1].release()

    def is_locked(self, key: str) -> bool:
        """Whether this process holds the lock."""
        return (self.folder, key) in _held

    def is_lock_holder(self, key: str, holder: str) -> bool:
        """Whether a transaction of this process holds the lock."""
        return _held.get((self.folder, key), ("",))[0] == holder

    def wait_for_lock(self, key: str, timeout: float | None = None) -> bool:
        """Nothing: who acquires waits."""
        return True

    async def await_for_lock(self, key: str, timeout: float | None = None) -> bool:
        """Nothing: who acquires waits."""
        return True

    def _file(self, key: str) -> Path:
        return self.folder / f"{key}.lock"


def _content(name: str, given: Any) -> Any:
    """What counts of an input: of the attempt that an artifact is from, the artifact."""
    if name == "turns":
        return [turn.value for turn in given]
    value = given.value if isinstance(given, Held) else given
    return value.artifact if isinstance(value, Turn) else value


def fits(step: str, made: Any) -> bool:
    """Whether a step's kept result is whole, and of the step's own kind."""
    return isinstance(made, Held) and isinstance(made.value, STEPS[step])


def own_record(storage: Any, key: str) -> bytes | None:
    """The serialized content of a kept result; one that this serializer did not write, or not whole, is removed."""
    if (content := store.read(storage, key)) is None:
        return None
    with suppress(ValueError):
        if _is_ours(record := json.loads(content)):
            return str(record["result"]).encode()
    store.remove(storage, key)
    return None


def _is_ours(record: Any) -> bool:
    about: Mapping[str, Any] = record.get("metadata", {}) if isinstance(record, dict) else {}
    serializer = about.get("serializer")
    return isinstance(serializer, dict) and serializer.get("type") == TYPE and isinstance(record.get("result"), str)
