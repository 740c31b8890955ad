"""Finished cases logged to their trackers, each once, also after interrupted batches.

`tracked_batch` encloses a batch: it tells every tracker what is about to run (`Arm`) and when it has ended. A mark in
the config's folder exists in between, so that the next batch ends one that was killed after its last case.
"""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from flows.batch import config_folder
from flows.batch.plan_batch import Job
from flows.batch.tracking import machine
from flows.case.run_case import Ending
from flows.case_files import case_links, find_cases
from flows.case_files.find_cases import Case
from sgcad_core import settings
from sgcad_core.asking.second_opinion import opinion_prompts
from sgcad_core.case.tracker_arm import Arm, Dataset
from sgcad_core.config import SCALARS, SINGLE, Config
from sgcad_core.errors import SgcadError
from sgcad_core.interfaces import Plugin, Tracker
from sgcad_core.system.locks import lock_file

OnEnding = Callable[[Job, Ending, str], None]
"""Called for every case as it ends, from one thread; the text says why it was not tracked, else it is empty."""

PLAIN = {
    "database is locked": "another program keeps the tracker's database locked: end it (`fuser FILE` names it)",
    "disk is full": "no room is left on the disk: make some",
    "No space left": "no room is left on the disk: make some",
    "readonly database": "the tracker's database cannot be written: make it writable (chmod u+w)",
}
"""Messages of databases and disks, and the text with a remedy that replaces them."""
GIVE_UP_AFTER = 2
"""Failed cases in a row after which logging stops; the next run logs the rest."""
_failed: dict[str, int] = {}
"""Failures in a row, by tracker."""
_last_params: dict[int, tuple[Config, dict[str, Any]]] = {}

LOCK = ".tracked.lock"
"""Suffix of the lock of a case that is being logged."""
OPEN = ".tracking"
"""Mark in a config's folder while its tracker waits for more cases."""


def track_safely(job: Job, ending: Ending) -> str:
    """Log a case; why that failed, or an empty text. Raises ConfigError for a tracker that can never work."""
    mark = job.config.tracker.model_dump_json()
    if _failed.get(mark, 0) >= GIVE_UP_AFTER:
        return "not tried, since the cases before it could not be logged"
    try:
        track(job, ending)
    except SgcadError:
        raise
    except Exception as fault:  # noqa: BLE001 - the case is safe on disk: a locked database must not end the batch
        _failed[mark] = _failed.get(mark, 0) + 1
        return fault_in_words(fault)
    _failed.pop(mark, None)
    return ""


def fault_in_words(fault: Exception) -> str:
    """A tracker's fault in one line with its remedy; of a database's fault its message without the statement."""
    for sign, plain in PLAIN.items():
        if sign in str(fault):
            return plain
    lines = [line.strip() for line in str(fault).splitlines() if line.strip()]
    said = next((line for line in lines if "Error) " in line), lines[0] if lines else "")
    return f"{type(fault).__name__}: {said}"[:300]


def track(job: Job, ending: Ending) -> None:
    """Log a case to its tracker, once; a case that a killed batch did not log is logged now."""
    tracker, out, path = job.config.tracker, job.folder.out, job.folder.path
    with lock_file(path.parent / f".{path.name}{LOCK}"):  # tracking/track_rest.py may be at it
        place = tracker.identity(out)
        if job.folder.tracked(mark(tracker, place)):
            return
        tracker.log_case(job.config.name, _params_of(job.config), path, ending.result)
        job.folder.mark_tracked(mark(tracker, place or tracker.identity(out)))


def tracked(job: Job) -> bool:
    """Whether the job's tracker has its case and its batch was ended."""
    tracker = job.config.tracker
    return job.folder.tracked(mark(tracker, tracker.identity(job.folder.out))) and not open_mark(job).exists()


def link_to_page(job: Job) -> None:
    """Keep the link to the tracker's page of the case, if this process logged it."""
    if page := job.config.tracker.page(job.config.name, job.case.id):
        case_links.keep(job.folder.path, {"mlflow": page})


def mark(tracker: Tracker, place: str) -> str:
    """What a case's folder notes: a tracker without logins, and the identity of the place where it logs."""
    return config_folder.without_logins(f"{type(tracker).__module__} {tracker.model_dump_json()} {place}".rstrip())


def open_mark(job: Job) -> Path:
    """The mark of a batch whose tracker was not told of its end (`OPEN`)."""
    return job.folder.path.parent / OPEN


# ------------------------------------------------------------------ before the first case and after the last
@contextmanager
def tracked_batch(plan: Sequence[Job], live: bool = True) -> Iterator[None]:
    """Tell the trackers what is about to run, and how it ended. Raises ConfigError for a tracker that can never work.

    The tracker of a config whose cases are all tracked is not called. `live`: the cases run meanwhile.
    """
    _failed.clear()
    arms = [(jobs[0], _arm(jobs, live)) for jobs in _by_config(plan) if not all(tracked(job) for job in jobs)]
    for job, arm in arms:
        open_mark(job).parent.mkdir(parents=True, exist_ok=True)
        open_mark(job).touch()
        _safely(job, lambda job=job, arm=arm: job.config.tracker.begin(arm))  # type: ignore[misc]
    fault, finished = "", False
    try:
        yield
        finished = True
    except Exception as broken:
        fault = fault_in_words(broken)
        raise
    finally:
        for job, arm in arms:
            told = arm.model_copy(update={"fault": fault})
            ended = _safely(job, lambda job=job, arm=told: job.config.tracker.end(arm, finished))  # type: ignore[misc]
            if ended and finished:
                open_mark(job).unlink(missing_ok=True)


def _safely(job: Job, tell: Callable[[], None]) -> bool:
    """Whether a call of a tracker succeeded; the batch continues without it, and the next batch repeats the call."""
    try:
        tell()
    except SgcadError:
        raise
    except Exception as fault:  # noqa: BLE001 - the cases are safe on disk: a locked database must not end the batch
        if not _failed.get(job.config.tracker.model_dump_json()):  # else the cases report it already
            told = logging.getLogger(__name__)
            told.warning("%s: not tracked: %s; then run the same command again", job.config.name, fault_in_words(fault))
        return False
    return True


def _by_config(plan: Sequence[Job]) -> list[list[Job]]:
    found: dict[str, list[Job]] = {}
    for job in plan:
        found.setdefault(job.config.name, []).append(job)
    return list(found.values())


# ------------------------------------------------------------------ what is told
def _arm(jobs: Sequence[Job], live: bool) -> Arm:
    job = jobs[0]
    return Arm(
        config=job.config.name,
        params=params_of(job.config),
        out=str(job.folder.out),
        dataset=dataset_of(tuple(job.case for job in jobs)),
        plugins=dict(_plugins(job.config)),
        prompts=prompts_of(job.config),
        live=live,
        git_commit=_git_commit() or "",
        hardware=_hardware(),
    )


@cache
def dataset_of(found: tuple[Case, ...]) -> Dataset:
    """The reports as one data set, independent of their order."""
    place = Path(os.path.commonpath([case.source.resolve().parent for case in found]))
    return Dataset(
        name=place.name or "cases", digest=find_cases.dataset_digest(found), source=str(place), cases=len(found)
    )


_hardware = cache(machine.hardware)
_git_commit = cache(machine.git_commit)


def _params_of(config: Config) -> dict[str, Any]:
    """`params_of`, computed once for the cases of a config that come one after the other."""
    if _last_params.get(id(config), (None, {}))[0] is not config:
        _last_params.clear()
        _last_params[id(config)] = (config, params_of(config))
    return _last_params[id(config)][1]


def params_of(config: Config) -> dict[str, Any]:
    """The effective configuration without the tracker: plugins by kind with name and fields, scalars, version."""
    found: dict[str, Any] = {"sgcad": version("sg-cadvlm")} | {key: getattr(config, key) for key in SCALARS}
    for kind in SINGLE:
        plugin = getattr(config, kind)
        if plugin is not None and kind != "tracker":
            found[kind] = _fields(_name(config.raw[kind]), plugin)
    if config.drive:
        found["drive"] = {"drivers": [entry.raw for entry in config.drive.drivers], "roles": list(config.drive.roles)}
    return found | {"validators": [_fields(name, plugin) for name, plugin in _validators(config)]}


def _fields(name: str, plugin: Plugin) -> dict[str, Any]:
    fields: dict[str, Any] = json.loads(config_folder.without_logins(plugin.model_dump_json()))
    return {"name": name, **fields}


def prompts_of(config: Config) -> dict[str, str]:
    """Texts of the prompts that the config's model is asked with, by name; empty without a model."""
    if config.backbone is None:
        return {}
    asking = (config.road_writer.prompts, config.scenario_writer.prompts, opinion_prompts(config.second_opinion))
    return {name: (settings.PROMPTS / f"{name}.md").read_text("utf-8") for names in asking for name in names}


def _validators(config: Config) -> Iterator[tuple[str, Plugin]]:
    names = [_name(entry) for entry in config.raw.get("validators") or ()]
    yield from zip(names, config.validators, strict=True)


def _plugins(config: Config) -> Iterator[tuple[str, str]]:
    named: list[tuple[str, Plugin | None]] = [(kind, getattr(config, kind)) for kind in SINGLE if kind != "tracker"]
    for name, plugin in [*named, *((f"validator.{name}", plugin) for name, plugin in _validators(config))]:
        if plugin is not None:
            yield name, " ".join(filter(None, [find_cases.qualified(plugin), *find_cases.identity(plugin)]))


def _name(entry: Any) -> str:
    return str(entry["name"] if isinstance(entry, dict) else entry)
