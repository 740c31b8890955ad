"""Changes of a case from the desk, made in worker processes, so that a crash of planner or simulator ends no page.

`Mender` is the desk's side, `work` that of the worker. A change carries the version of the case that was on the screen
and is refused if the case on disk has changed since. It waits in line for a bounded time, and nothing is written once
its client has gone: the worker asks for the order's permit before it writes.
"""

from __future__ import annotations

import io
import queue
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from flows.case_files.case_version import version_of
from flows.desk.views.edit_form import Findings
from sgcad_core.errors import SgcadError, SimulationFailed, WrongEdit
from sgcad_core.system.worker_process import Worker

MEND_S, RUN_S = 300.0, 600.0
"""Time limits of an edit (a second of work, on a loaded machine with cold libraries) and of running a case again, which
may ask a model."""
WORKERS = 2
"""Worker processes; the second one starts when two changes are made at once."""
WAITING, WAIT_S = 12, 30.0
"""Changes in line at most, and how long one stays there before it is told that the desk is busy."""
LOOK_S = 0.2
"""How often a change in line looks whether its client is still there."""
Kind = Literal["revise", "undo", "rerun", "warm"]


class CaseChanged(SgcadError):
    """The case on disk differs from the one on the person's screen."""


class DeskBusy(SgcadError):
    """Other changes are being made; this one was not, and may be asked for again."""


@dataclass(frozen=True)
class Order:
    """One change; `seen`: the stamp of the facts that were on the screen."""

    kind: Kind
    folder: Path
    edits: Mapping[str, Any] = field(default_factory=dict)
    who: str = ""
    why: str = ""
    seen: str | None = None
    permit: Path | None = None
    """A file that is there as long as the client is; None: the change is made in any case."""

    def wanted(self) -> bool:
        """Whether the change may still be written."""
        return self.permit is None or self.permit.exists()


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
        self._in_line = threading.Semaphore(WAITING)
        self._lock = threading.Lock()

    def warm(self, folder: Path) -> None:
        """Prepare an idle worker in the background for changes of cases of this config, once per config."""
        with self._lock:
            if folder.parent in self._warmed:
                return
            try:
                worker = self._idle.get_nowait()
            except queue.Empty:  # all are busy: another visit will do
                return
            self._warmed.add(folder.parent)
        threading.Thread(target=self._warm, args=(worker, folder), daemon=True, name="desk-warm").start()

    def _warm(self, worker: Worker, folder: Path) -> None:
        try:
            with suppress(SgcadError):  # the first change will tell
                worker.call(Order("warm", folder), timeout_s=MEND_S)
        finally:
            self._idle.put(worker)

    def change(self, order: Order, version: str) -> ChangeResult:
        """Make a change of the case as the person saw it.

        Raises CaseChanged, DeskBusy, WrongEdit and BadInput (nothing was changed), SimulationFailed (the process died).
        """
        if not self._in_line.acquire(blocking=False):
            raise DeskBusy(f"{WAITING} other changes wait already. Yours was not made: try again in a moment.")
        try:
            return self._change(order, version, time.monotonic() + WAIT_S)
        finally:
            self._in_line.release()

    def _change(self, order: Order, version: str, deadline: float) -> ChangeResult:
        with self._alone(order, deadline), self._worker(order, deadline) as worker:
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
    def _worker(self, order: Order, deadline: float) -> Iterator[Worker]:
        found: list[Worker] = []

        def take() -> bool:
            with suppress(queue.Empty):
                found.append(self._idle.get(timeout=LOOK_S))
            return bool(found)

        _wait_for(take, order, deadline)
        try:
            yield found[0]
        finally:
            self._idle.put(found[0])

    @contextmanager
    def _alone(self, order: Order, deadline: float) -> Iterator[None]:
        with self._lock:
            lock = self._busy.setdefault(order.folder, threading.Lock())
        _wait_for(lambda: lock.acquire(timeout=LOOK_S), order, deadline)
        try:
            yield
        finally:
            lock.release()


def _wait_for(take: Callable[[], bool], order: Order, deadline: float) -> None:
    """Try to take what a change needs. Raises DeskBusy when its time in line is over, WrongEdit without a client."""
    while not take():
        if not order.wanted():
            raise WrongEdit("the change was given up while it waited; nothing was changed")
        if time.monotonic() > deadline:
            raise DeskBusy(
                f"Other changes are being made; yours waited for {WAIT_S:g} s and was not made: try again in a moment."
            )


# ------------------------------------------------------------------ the far end
def work(order: Order) -> ChangeResult | None:
    """Make a change in the worker process. Raises WrongEdit, BadInput, ConfigError."""
    from flows.case import revise_case

    if order.kind == "warm":
        _warm_up(order.folder)
        return None
    if order.kind == "rerun":
        return _rerun(order)
    if order.kind == "undo":
        done = revise_case.undo(order.folder, seen=order.seen, wanted=order.wanted)
    else:
        done = revise_case.revise(
            order.folder, order.edits, who=order.who, why=order.why, seen=order.seen, wanted=order.wanted
        )
    said = {name: [_line(finding) for finding in found] for name, found in done.findings.items()}
    return ChangeResult(str(done.result["status"]), said, done.seconds, done.changed)


def _line(finding: Any) -> str:
    remedy = f" – {finding.remedy}" if finding.remedy else ""
    return f"{finding.what}{f': {finding.value}' if finding.value else ''}{remedy}"


def _rerun(order: Order) -> ChangeResult:
    """Run the whole case again under its config, with its edits."""
    from flows.case import revise_case, run_case
    from flows.case.chain import CaseRun
    from flows.case_files import find_cases
    from flows.case_files.case_folder import CaseFolder

    case = revise_case.opened(order.folder)
    digest = find_cases.digest_of(case.case, case.config)
    run = CaseRun(case.config, case.case)
    run.go()
    if not order.wanted():
        raise WrongEdit("the run was given up; nothing was changed")
    result = run_case.write_run(run, CaseFolder(case.folder.parent.parent, case.config.name, case.folder.name), digest)
    return ChangeResult(str(result["status"]), {}, float(sum(result["seconds"].values())), True)


def _warm_up(folder: Path) -> None:
    """Load what the first change would wait for: imports, plugins, the simulator's process, matplotlib's fonts.

    A config with a model is only built.
    """
    from matplotlib.figure import Figure

    from flows.case import revise_case
    from flows.case.chain import CaseRun

    case = revise_case.opened(folder)
    if case.config.backbone is None:
        CaseRun(case.config, case.case, edits=case.edits()).go()
    figure = Figure()
    figure.text(0, 0, "V1")
    figure.savefig(io.BytesIO(), format="png", backend="agg")


def told(fault: SgcadError) -> str:
    """A fault in words for the author of the change."""
    if isinstance(fault, SimulationFailed):
        return f"The change could not be made, nothing was changed: {fault}"
    return str(fault)
