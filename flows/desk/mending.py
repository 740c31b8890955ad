"""Changes of a case from the desk, made in worker processes, so that a crash of planner or simulator ends no page.

`Mender` is the desk's side, `work` that of the worker. A change carries the version of the case that was on the screen
and is refused if the case on disk has changed since.
"""

from __future__ import annotations

import io
import queue
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from flows.desk.index import version_of
from flows.desk.views.edit_form import Findings
from sgcad_core.errors import SgcadError, SimulationFailed
from sgcad_core.system.worker_process import Worker

MEND_S, RUN_S = 60.0, 600.0
"""Time limits of an edit and of running a case again (which may ask a model)."""
WORKERS = 2
"""Worker processes; the second one starts when two changes are made at once."""
Kind = Literal["revise", "undo", "rerun", "warm"]


class CaseChanged(SgcadError):
    """The case on disk differs from the one on the person's screen."""


@dataclass(frozen=True)
class Order:
    """One change; `seen`: the stamp of the facts that were on the screen."""

    kind: Kind
    folder: Path
    edits: Mapping[str, Any] = field(default_factory=dict)
    who: str = ""
    why: str = ""
    seen: str | None = None


@dataclass(frozen=True)
class ChangeResult:
    """Result of a change, with findings by field."""

    status: str
    findings: Findings
    seconds: float
    changed: bool


class Mender:
    """Makes changes, those of one case one after the other. Thread-safe."""

    def __init__(self, target: str = "flows.desk.mending:work") -> None:
        self._workers = [Worker(target) for _ in range(WORKERS)]
        self._idle: queue.LifoQueue[Worker] = queue.LifoQueue()  # the last one used is warm
        for worker in reversed(self._workers):
            self._idle.put(worker)
        self._said: dict[Path, tuple[str, Findings]] = {}
        self._busy: dict[Path, threading.Lock] = {}
        self._warmed: set[Path] = set()
        self._lock = threading.Lock()

    def warm(self, folder: Path) -> None:
        """Prepare a worker in the background for changes of cases of this config, once per config."""
        with self._lock:
            known = folder.parent in self._warmed
            self._warmed.add(folder.parent)
        if not known:
            threading.Thread(target=self._warm, args=(folder,), daemon=True, name="desk-warm").start()

    def _warm(self, folder: Path) -> None:
        with self._worker() as worker, suppress(SgcadError):  # the first change will tell
            worker.call(Order("warm", folder), timeout_s=MEND_S)

    def change(self, order: Order, version: str) -> ChangeResult:
        """Make a change of the case as the person saw it.

        Raises Changed, WrongEdit and BadInput (nothing was changed), SimulationFailed (the process died).
        """
        with self._alone(order.folder), self._worker() as worker:
            if version != version_of(order.folder):
                raise CaseChanged(
                    "This case was changed on disk since you opened it (another person, or a run). Your change was not "
                    "made: look at the case as it is now, then make it again."
                )
            done: ChangeResult = worker.call(order, timeout_s=RUN_S if order.kind == "rerun" else MEND_S)
            with self._lock:
                self._said[order.folder] = (version_of(order.folder), done.findings)
        return done

    def said(self, folder: Path) -> Findings:
        """Findings of the last change, as long as the case is in the state that it left."""
        with self._lock:
            version, findings = self._said.get(folder, ("", {}))
        return findings if version == version_of(folder) else {}

    def close(self) -> None:
        """End the processes."""
        for worker in self._workers:
            worker.kill()

    @contextmanager
    def _worker(self) -> Iterator[Worker]:
        worker = self._idle.get()
        try:
            yield worker
        finally:
            self._idle.put(worker)

    @contextmanager
    def _alone(self, folder: Path) -> Iterator[None]:
        with self._lock:
            lock = self._busy.setdefault(folder, threading.Lock())
        with lock:
            yield


# ------------------------------------------------------------------ the far end
def work(order: Order) -> ChangeResult | None:
    """Make a change in the worker process. Raises WrongEdit, BadInput, ConfigError."""
    from flows.case import revise_case

    if order.kind == "warm":
        _warm_up(order.folder)
        return None
    if order.kind == "rerun":
        return _rerun(order.folder)
    if order.kind == "undo":
        done = revise_case.undo(order.folder, seen=order.seen)
    else:
        done = revise_case.revise(order.folder, order.edits, who=order.who, why=order.why, seen=order.seen)
    said = {name: [_line(finding) for finding in found] for name, found in done.findings.items()}
    return ChangeResult(str(done.result["status"]), said, done.seconds, done.changed)


def _line(finding: Any) -> str:
    remedy = f" – {finding.remedy}" if finding.remedy else ""
    return f"{finding.what}{f': {finding.value}' if finding.value else ''}{remedy}"


def _rerun(folder: Path) -> ChangeResult:
    """Run the whole case again under its config, with its edits."""
    from flows.case import revise_case, run_case
    from flows.case_files import find_cases
    from sgcad_core.asking.refine import run_at_once

    case = revise_case.opened(folder)
    digest = find_cases.digest_of(case.case, case.config)
    ending = run_case.run_case(case.config, case.case, folder.parent.parent, digest, run_at_once)
    return ChangeResult(str(ending.result["status"]), {}, float(sum(ending.result["seconds"].values())), True)


def _warm_up(folder: Path) -> None:
    """Load what the first change would wait for: imports, plugins, the simulator's process, matplotlib's fonts.

    A config with a model is only built.
    """
    from matplotlib.figure import Figure

    from flows.case import revise_case
    from flows.case.chain import CaseRun
    from sgcad_core.asking.refine import run_at_once

    case = revise_case.opened(folder)
    if case.config.backbone is None:
        CaseRun(case.config, case.case, run_at_once, edits=case.edits()).go()
    figure = Figure()
    figure.text(0, 0, "V1")
    figure.savefig(io.BytesIO(), format="png", backend="agg")


def told(fault: SgcadError) -> str:
    """A fault in words for the author of the change."""
    if isinstance(fault, SimulationFailed):
        return f"The change could not be made, nothing was changed: {fault}"
    return str(fault)
