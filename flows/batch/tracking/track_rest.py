"""Finished cases logged to their trackers by a process of its own, so that no command waits for a tracker.

    track_rest.start(out)                     # at the end of a command; returns at once
    python -m flows.batch.tracking.track_rest OUT      # what it starts: logs every finished case that is not logged yet

Reads the output folder alone: OUT/<config>/config.yaml and the case folders. One process at a time works on a folder;
it takes cases that finish meanwhile, and its messages are in OUT/tracking.log. What a killed one has left, the next
call completes.
"""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import yaml

from flows.batch.tracking import track_cases
from flows.case_files.case_folder import CONFIG, DIGEST, CaseFolder
from sgcad_core import settings
from sgcad_core.config import Config, build
from sgcad_core.errors import SgcadError
from sgcad_core.registry import plugin_class
from sgcad_core.system.locks import lock_file

if TYPE_CHECKING:
    from flows.batch.plan_batch import Job
    from sgcad_core.interfaces import Tracker

LOG, LOCK = "tracking.log", ".tracking.lock"
"""In the output folder: what the last process said, and the lock of the present one."""
LOGINS = "SGCAD_TRACKER_URIS"
"""Variable with the addresses that have a login, by config, as JSON: config.yaml has none and a command line is open
to all users."""
FAULT = "not tracked: "
POLITE = 10
"""Niceness: cases that still run come first."""
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


# ------------------------------------------------------------------ before: cheap, and without the tracker's library
def start(out: Path, configs: Sequence[Config] = ()) -> None:
    """Start the process if a finished case is not logged; `configs` are asked for the logins of their trackers.

    Warns if the process before failed. Raises MissingTool where no process can be started.
    """
    out, uris = out.resolve(), _logins(configs)
    if not any(_left(folder, uris) for folder in _config_folders(out)):
        return
    if said := last_fault(out):
        logging.getLogger(__name__).warning("cases before were not tracked (%s); it is tried again", said)
    paths = os.pathsep.join(path for path in sys.path if path)
    environment = {**settings.subprocess_environment(), "PYTHONPATH": paths, LOGINS: json.dumps(uris)}
    with (out / LOG).open("ab") as log, settings.starting(sys.executable):
        subprocess.Popen(  # noqa: S603 - our own interpreter and module
            [sys.executable, "-m", "flows.batch.tracking.track_rest", str(out)],
            stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=environment, start_new_session=True,
        )  # fmt: skip


def last_fault(out: Path) -> str:
    """Why the last process of an output folder could not log a case; "" where it could."""
    try:
        lines = (out / LOG).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return ""
    return next((line.partition(FAULT)[2] for line in reversed(lines) if FAULT in line), "")


def _config_folders(out: Path) -> list[Path]:
    return sorted(file.parent for file in out.glob(f"*/{CONFIG}"))


def _left(folder: Path, uris: Mapping[str, str]) -> bool:
    """Whether a config's folder has a finished case that its tracker has not, or a batch that was not ended."""
    try:
        entry = _raw(folder, uris)["tracker"]
        fields = {key: value for key, value in entry.items() if key != "name"}
        tracker = cast("Tracker", plugin_class("tracker", entry["name"])(**fields))
    except (SgcadError, OSError, ValueError, LookupError, TypeError, AttributeError, yaml.YAMLError):
        return False  # a config that cannot be read any more
    if entry["name"] == "none":
        return False
    mark = track_cases.mark(tracker, tracker.identity(folder.parent))
    return (folder / track_cases.OPEN).exists() or any(not case.tracked(mark) for case in _finished(folder))


def _raw(folder: Path, uris: Mapping[str, str]) -> dict[str, Any]:
    """The config's mapping with its tracker as a mapping, and the login of its address put back."""
    raw: dict[str, Any] = yaml.load((folder / CONFIG).read_text(encoding="utf-8"), _Loader)  # noqa: S506 - a safe loader
    entry = raw["tracker"]
    raw["tracker"] = dict(entry) if isinstance(entry, dict) else {"name": entry}
    if folder.name in uris:
        raw["tracker"]["uri"] = uris[folder.name]
    return raw


def _finished(folder: Path) -> Iterator[CaseFolder]:
    for file in sorted(folder.glob("[!.]*/result.json")):
        yield CaseFolder(folder.parent, folder.name, file.parent.name)


def _logins(configs: Sequence[Config]) -> dict[str, str]:
    named = {config.name: str(getattr(config.tracker, "uri", "")) for config in configs}
    return {name: uri for name, uri in named.items() if "@" in uri}


# ------------------------------------------------------------------ the process
def main(out: Path) -> int:
    """Log what is left, unless another process does; the exit code is 1 if a case could not be logged."""
    settings.quiet_libraries()
    os.nice(POLITE)
    uris = json.loads(settings.environment(LOGINS) or "{}")
    failed: set[str] = set()
    while True:
        with suppress(TimeoutError), lock_file(out / LOCK, timeout_s=0):
            with suppress(OSError):  # only a file has a beginning
                os.ftruncate(sys.stdout.fileno(), 0)
            while folders := _folders_left(out, uris, failed):
                failed |= {folder.name for folder in folders if not _log_config(folder, uris)}
        # Looked again without the lock: a process that met it has ended, and its cases are left to this one.
        if not _folders_left(out, uris, failed) or _taken(out):
            return int(bool(failed))


def _folders_left(out: Path, uris: Mapping[str, str], failed: set[str]) -> list[Path]:
    return [folder for folder in _config_folders(out) if folder.name not in failed and _left(folder, uris)]


def _taken(out: Path) -> bool:
    """Whether another process holds the lock."""
    try:
        with lock_file(out / LOCK, timeout_s=0):
            return False
    except TimeoutError:
        return True


def _log_config(folder: Path, uris: Mapping[str, str]) -> bool:
    """Whether every finished case of a config is logged now."""
    began, faults = time.monotonic(), []
    try:
        jobs = _jobs(build(_raw(folder, uris), folder.name, str(folder / CONFIG)), folder)
        left = [job for job in jobs if not track_cases.tracked(job)]
        with track_cases.tracked_batch(jobs, live=False):
            faults = [f"{job.name}: {FAULT}{said}" for job in left if (said := _log(job))]
        faults = (
            faults
            or [f"{job.name}: {FAULT}its tracker was not ended" for job in jobs if track_cases.open_mark(job).exists()][
                :1
            ]
        )
    except (SgcadError, OSError) as fault:
        left, faults = [], [f"{folder.name}: {FAULT}{fault}"]
    _say(*faults or [f"{folder.name}: {len(left)} cases in {time.monotonic() - began:.1f} s"])
    return not faults and (bool(left) or not _left(folder, uris))


def _jobs(config: Config, folder: Path) -> list[Job]:
    from flows.batch.plan_batch import Job
    from flows.case.person_facts import SOURCE
    from flows.case_files.find_cases import Case

    found = []
    for case in _finished(folder):
        source, digest = (_text(case.path / name) for name in (SOURCE, DIGEST))
        found.append(Job(config, Case(Path(source or case.path), case.case), digest, case))
    return found


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="surrogateescape")
    except OSError:
        return ""


def _log(job: Job) -> str:
    """Log a case and keep the link to its page; why it could not be logged, or ""."""
    from flows.case.run_case import Ending

    if (result := job.folder.result()) is None:
        return "its result.json cannot be read"
    said = track_cases.track_safely(job, Ending(result))
    track_cases.link_to_page(job)
    return said


def _say(*lines: str) -> None:
    for line in lines:
        sys.stdout.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} {' '.join(line.split())}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
