"""A function in a process of its own, which may die without ending the batch.

    worker = Worker("plugins.simulator.libsumo:replay")       # starts nothing yet
    worker.begin()                                             # may be left out: starts it, and waits for nothing
    result = worker.call(net_xml, steps, timeout_s=30)         # replay(net_xml, steps) over there

The process starts at `begin` or at the first call and serves all later ones, since imports (libsumo: 0.5 s) are what
costs; a call after a death starts a new one. Arguments and results are pickled. An SgcadError that the
function raises is raised here; any other end of the process (signal, uncaught exception) is ProcessDied, a
timeout SimulationFailed, with the last lines of its error stream. Thread-safe: calls of one worker wait in line.

Knows no simulator. What the function prints goes to the error stream (file descriptor 2).
"""

from __future__ import annotations

import gc
import importlib
import os
import signal
import subprocess
import sys
import tempfile
import threading
import weakref
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import IO, Any

from sgcad_core import settings
from sgcad_core.errors import ProcessDied, SgcadError, SimulationFailed
from sgcad_core.system.subprocess_limits import ended_from_outside

START_S = 60.0
"""Longest start: imports on a busy machine with a cold disk."""
_LAST_WORDS = 2000
_COLLECTED = 20_000
"""So many objects more than went, and the worker's garbage is collected: trees of files make many that go by count."""


class Worker:
    """One persistent process for one function, `target` = "package.module:function"."""

    def __init__(self, target: str) -> None:
        self.target = target
        self._lock = threading.Lock()
        self._process: _Process | None = None
        self._killed = False

    def call(self, *args: Any, timeout_s: float = 60.0) -> Any:
        """`target(*args)` over there. Raises ProcessDied, SimulationFailed (timeout) or the function's SgcadError."""
        with self._lock:
            process = self._alive()
            if self._killed:
                process.popen.kill()
            try:
                done, result = process.ask(args, timeout_s)
            except _Died as death:
                self._process = None
                said = f"{self.target}: {process.end(str(death))}"
                if str(death):  # a reason is given where the time was over
                    raise SimulationFailed(said) from death
                raise ProcessDied(said, from_outside=ended_from_outside(process.popen.poll())) from death
        if done:
            return result
        raise result

    def begin(self) -> None:
        """Start the process without waiting for it, so that the first call finds it ready."""
        with self._lock:
            if not self._killed:
                self._alive()

    def said(self) -> str:
        """What the process wrote to its error stream since the last call began (at most 2000 characters)."""
        return self._process.said() if self._process else ""

    def close(self) -> None:
        """End the process; the next call starts a new one."""
        with self._lock:
            if self._process:
                self._process.finalize()
            self._process = None

    def kill(self) -> None:
        """End the process for good, even while a call waits for it: that and all later ones raise SimulationFailed."""
        self._killed = True
        if (process := self._process) is not None:
            process.popen.kill()

    def _alive(self) -> _Process:
        if self._process is None or not self._process.usable():
            self._process = _Process(self.target)
        return self._process


class _Died(Exception):
    """The pipe broke or the time is over."""


class _Process:
    """The near end: pipes, clock and error stream of one running process."""

    def __init__(self, target: str) -> None:
        self.owner = os.getpid()
        self.errors = _append_file()
        paths = os.pathsep.join(p for p in sys.path if p)
        self.pipe, far_end = Pipe()
        with settings.starting(sys.executable), far_end:
            self.popen = subprocess.Popen(  # noqa: S603 - our own interpreter and module
                [sys.executable, "-m", "sgcad_core.system.worker_process", target, str(far_end.fileno())],
                stdin=subprocess.DEVNULL,
                stdout=self.errors,  # what the function or a C++ library prints
                stderr=self.errors,
                env=settings.subprocess_environment() | {"PYTHONPATH": paths},
                start_new_session=True,  # Ctrl-C is for the parent, whose end closes the pipe
                pass_fds=[far_end.fileno()],
            )
        self.finalize = weakref.finalize(self, _end, self.popen, self.pipe, self.errors)
        self.ready = False
        self.busy = False

    def usable(self) -> bool:
        """False after its end or an interrupted call, and in a forked child, which shares the parent's pipe."""
        return not self.busy and self.owner == os.getpid() and self.popen.poll() is None

    def ask(self, args: tuple[Any, ...], timeout_s: float) -> tuple[bool, Any]:
        """Send one call, wait for its answer: (True, result) or (False, SgcadError)."""
        self.busy = True
        if not self.ready:
            self._receive(START_S, f"did not start within {START_S:g} s")
            self.ready = True
        self.errors.truncate(0)
        try:
            self.pipe.send(args)
        except BrokenPipeError as fault:
            raise _Died("") from fault
        answer: tuple[bool, Any] = self._receive(timeout_s, f"no answer within {timeout_s:g} s")
        self.busy = False
        return answer

    def _receive(self, timeout_s: float, late: str) -> Any:
        if not self.pipe.poll(timeout_s):
            raise _Died(late)
        try:
            return self.pipe.recv()
        except (EOFError, ConnectionResetError) as fault:
            raise _Died("") from fault

    def end(self, reason: str) -> str:
        """End the process and say how it ended, with its last words."""
        if not reason:
            try:
                code = self.popen.wait(5)
                reason = f"died of {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
            except subprocess.TimeoutExpired:
                reason = "closed its pipe"
        words = self.said()
        self.finalize()
        return f"the worker process {reason}" + (f"; its last words: {words}" if words else "")

    def said(self) -> str:
        self.errors.seek(0, os.SEEK_END)
        self.errors.seek(max(0, self.errors.tell() - _LAST_WORDS))
        return self.errors.read().decode("utf-8", "replace").strip()


def _append_file() -> IO[bytes]:
    """A nameless file that a child appends to while we read and truncate it (the offset is shared)."""
    made, path = tempfile.mkstemp(prefix="sgcad-worker-")
    os.close(made)
    try:
        return os.fdopen(os.open(path, os.O_RDWR | os.O_APPEND), "r+b")
    finally:
        os.unlink(path)


def _end(process: subprocess.Popen[bytes], pipe: Connection[Any, Any], errors: IO[bytes]) -> None:
    process.kill()
    process.wait()
    pipe.close()
    errors.close()


# ------------------------------------------------------------------ the far end
def _serve(target: str, calls: Connection[Any, Any]) -> None:
    """Answers calls until the pipe closes. Only SgcadErrors are answers; other errors end the process."""
    module, _, name = target.partition(":")
    function = getattr(importlib.import_module(module), name)
    calls.send("ready")
    gc.set_threshold(_COLLECTED)
    while True:
        try:
            args = calls.recv()
        except EOFError:
            return
        try:
            answer = (True, function(*args))
        except SgcadError as fault:
            answer = (False, fault)
        sys.stdout.flush()
        calls.send(answer)
        if not gc.get_freeze_count():  # what the first call imported stays: the collector need not walk it each time
            gc.collect()
            gc.freeze()


if __name__ == "__main__":
    _serve(sys.argv[1], Connection(int(sys.argv[2])))
