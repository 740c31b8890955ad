"""Handing finished cases to their tracker, each once, whatever became of the batch in between."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import version

from flows.batch import Job
from flows.chain import Ending
from sgcad_core.errors import SgcadError

OnEnding = Callable[[Job, Ending, str], None]
"""Told of every case as it ends, from one thread; the text says why it could not be tracked, if it could not."""


def track_safely(job: Job, ending: Ending) -> str:
    """`track`; why it failed, or an empty text. Raises ConfigError: a tracker that can never work."""
    try:
        track(job, ending)
    except SgcadError:
        raise
    except Exception as fault:  # noqa: BLE001 - the case is safe on disk: a locked database must not end the batch
        return f"{type(fault).__name__}: {fault}"
    return ""


def track(job: Job, ending: Ending) -> None:
    """Log a case to its tracker, once: a case that a killed batch had no time to log is logged now."""
    if tracked(job):
        return
    tracker = job.config.tracker
    params = {"sgcad": version("sg-cadvlm"), **job.config.raw}
    tracker.log_case(job.config.name, params, job.folder.path, ending.result)
    for call in ending.calls:
        tracker.log_generation(job.config.name, job.case.id, call.query, call.generation)
    job.folder.mark_tracked(_mark(job))


def tracked(job: Job) -> bool:
    """Whether the job's tracker has its case already."""
    return job.folder.tracked(_mark(job))


def _mark(job: Job) -> str:
    """What identifies a tracker to a case's folder."""
    tracker = job.config.tracker
    return f"{type(tracker).__module__} {tracker.model_dump_json()}"
