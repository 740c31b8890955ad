"""A function in a process of its own, which may die without taking the batch along.

    worker = Worker("plugins.simulator.libsumo:replay")       # starts nothing yet
    result = worker.call(net_xml, steps, timeout_s=30)         # replay(net_xml, steps) over there

The process starts at the first call and serves all later ones, since imports (libsumo: 0.5 s) are what
costs; a call after a death starts a new one. Arguments and results are pickled. An SgcadError that the
function raises is raised here; any other end of the process (signal, uncaught exception) is ProcessDied, a
timeout SimulationFailed, with the last lines of its error stream. Thread-safe: calls of one worker wait in line.

Knows no simulator. What the function prints goes to the error stream (file descriptor 2).
"""

from __future__ import annotations

import gc
import importlib
import os
import pickle
import selectors
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import weakref
from collections.abc import Callable
from typing import IO, Any

from sgcad_core import settings
from sgcad_core.errors import ProcessDied, SgcadError, SimulationFailed
from sgcad_core.system.subprocess_limits import ended_from_outside

START_S = 60.0
"""Longest start: imports on a busy machine with a cold disk."""
_HEADER = struct.Struct("!Q")
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
        with settings.starting(sys.executable):
            self.popen = subprocess.Popen(  # noqa: S603 - our own interpreter and module
                [sys.executable, "-m", "sgcad_core.system.worker_process", target],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.errors,
                env=settings.subprocess_environment() | {"PYTHONPATH": paths},
                start_new_session=True,  # Ctrl-C is for the parent, whose end closes the pipe
                bufsize=0,
            )
        self.finalize = weakref.finalize(self, _end, self.popen, self.errors)
        self.ready = False
        self.busy = False

    def usable(self) -> bool:
        """False after its end or an interrupted call, and in a forked child, which shares the parent's pipe."""
        return not self.busy and self.owner == os.getpid() and self.popen.poll() is None

    def ask(self, args: tuple[Any, ...], timeout_s: float) -> tuple[bool, Any]:
        """Send one call, wait for its answer: (True, result) or (False, SgcadError)."""
        self.busy = True
        if not self.ready:
            self._read(time.monotonic() + START_S, f"did not start within {START_S:g} s")
            self.ready = True
        self.errors.truncate(0)
        assert self.popen.stdin is not None  # noqa: S101 - for the type checker
        try:
            _write(self.popen.stdin.fileno(), args)
        except BrokenPipeError as fault:
            raise _Died("") from fault
        answer: tuple[bool, Any] = self._read(time.monotonic() + timeout_s, f"no answer within {timeout_s:g} s")
        self.busy = False
        return answer

    def _read(self, deadline: float, late: str) -> Any:
        size = _HEADER.unpack(self._bytes(_HEADER.size, deadline, late))[0]
        return pickle.loads(self._bytes(size, deadline, late))  # noqa: S301 - written by our own process

    def _bytes(self, count: int, deadline: float, late: str) -> bytes:
        assert self.popen.stdout is not None  # noqa: S101 - for the type checker
        pipe, data = self.popen.stdout.fileno(), bytearray()
        with selectors.DefaultSelector() as selector:
            selector.register(pipe, selectors.EVENT_READ)
            while len(data) < count:
                left = deadline - time.monotonic()
                if left <= 0 or not selector.select(left):
                    raise _Died(late)
                chunk = os.read(pipe, min(1 << 20, count - len(data)))
                if not chunk:
                    raise _Died("")
                data += chunk
        return bytes(data)

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


def _end(process: subprocess.Popen[bytes], errors: IO[bytes]) -> None:
    process.kill()
    process.wait()
    for pipe in (process.stdin, process.stdout, errors):
        if pipe:
            pipe.close()


# ------------------------------------------------------------------ the far end
def _serve(target: str) -> None:
    """Answer calls on standard input until it closes. Only SgcadErrors are answers; others end the process."""
    answers = os.dup(1)
    os.dup2(2, 1)  # prints of the function and of C++ libraries must not mix with the answers
    function = _load(target)
    _write(answers, "ready")
    gc.set_threshold(_COLLECTED)
    while True:
        header = sys.stdin.buffer.read(_HEADER.size)
        if len(header) < _HEADER.size:
            return
        args = pickle.loads(sys.stdin.buffer.read(_HEADER.unpack(header)[0]))  # noqa: S301 - written by our parent
        try:
            answer = (True, function(*args))
        except SgcadError as fault:
            answer = (False, fault)
        sys.stdout.flush()
        _write(answers, answer)
        if not gc.get_freeze_count():  # what the first call imported stays: the collector need not walk it each time
            gc.collect()
            gc.freeze()


def _load(target: str) -> Callable[..., Any]:
    module, _, name = target.partition(":")
    found: Callable[..., Any] = getattr(importlib.import_module(module), name)
    return found


def _write(pipe: int, value: Any) -> None:
    data = pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    rest = memoryview(_HEADER.pack(len(data)) + data)
    while rest:
        rest = rest[os.write(pipe, rest) :]


if __name__ == "__main__":
    _serve(sys.argv[1])
