"""Runs a script in a new interpreter and reads back a scenario file or one fault.

The interpreter starts in isolated mode with an empty environment, in an empty folder, as a process group of its own
that is killed as a whole. Two channels come back. *Status* names the walls (parts of the confinement) in place:
it is written and closed before a line of the script is read, so a script cannot forge it. The *answer* is as untrusted
as the script that may have written it. It comes from a process in which no line of the script runs, is bounded and read
by a strict model; an answer that does not fit is a fault of that script only.
"""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.system.temp_folders import temp_folder

Layer = Literal["parse", "rules", "execution", "limit"]
MAX_ANSWER = 15_000_000
MAX_ERRORS = 100_000
MAX_STATUS = 1_000
Wall = Literal["namespaces", "root", "calls"]
_BOOT = (
    "import sys; root, site, status = sys.argv[1:]; sys.path.append(root); "
    "from plugins.scenario_writer.sandbox.script_process import main; sys.path.append(site); main(site, int(status))"
)


@dataclass(frozen=True)
class Limits:
    """What a script may use: processor and wall seconds, address space in MB."""

    cpu_s: int = 5
    wall_s: float = 15.0
    memory_mb: int = 512


@dataclass(frozen=True)
class Fault:
    """Why a script gave no scenario; `line` is the script's, `breaches` are (line, what, value, remedy)."""

    layer: Layer
    kind: str = ""
    message: str = ""
    line: int | None = None
    breaches: tuple[tuple[int, str, str, str], ...] = ()


@dataclass(frozen=True)
class Ran:
    """What came back: the .xosc or a fault, what was printed, which walls stood, seconds of wall time."""

    xosc: str | None = None
    fault: Fault | None = None
    printed: str = ""
    walls: tuple[Wall, ...] = ()
    seconds: float = 0.0


class _Strict(BaseModel):
    """A model that reads bytes from an untrusted source."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class _Status(_Strict):
    """What stands before the script is read; `isolated` is False where it must not run."""

    isolated: bool
    walls: tuple[Wall, ...] = ()


_Line = Annotated[int, Field(ge=0, le=10_000_000)]
_Printed = Annotated[str, Field(max_length=2_000)]
_Words = Annotated[str, Field(max_length=4_000)]


class _Written(_Strict):
    """The answer of a script that left a scenario."""

    ok: Literal[True]
    xosc: Annotated[str, Field(max_length=5_000_000)]
    printed: _Printed = ""


class _Failed(_Strict):
    """The answer of a script that did not."""

    ok: Literal[False]
    layer: Literal["parse", "rules", "execution"]
    kind: _Words = ""
    message: _Words = ""
    line: _Line | None = None
    breaches: Annotated[tuple[tuple[_Line, _Words, _Words, _Words], ...], Field(max_length=12)] = ()
    printed: _Printed = ""


_ANSWER: TypeAdapter[_Written | _Failed] = TypeAdapter(Annotated[_Written | _Failed, Field(discriminator="ok")])


def run_script(
    source: str, limits: Limits | None = None, *, allow_without_namespace: bool = False, unchecked: bool = False
) -> Ran:
    """Run a script that leaves an xosc.Scenario in `scenario`. Raises MissingTool without scenariogeneration,
    ConfigError where the system gives no network namespace and `allow_without_namespace` is not set.

    `unchecked` skips the rules, to show what the walls hold alone; nothing but tests sets it.
    """
    limits = limits or Limits()
    started = time.monotonic()
    with temp_folder("script") as folder:
        job = {
            "source": source, "folder": str(folder), "cpu_s": limits.cpu_s, "memory_mb": limits.memory_mb,
            "allow_without_namespace": allow_without_namespace, "unchecked": unchecked,
        }  # fmt: skip
        channels, ended = _run_process(job, str(folder), limits.wall_s)
    status = _status(channels, ended)
    if not status.isolated:
        raise ConfigError(
            "the sandbox needs a network namespace of its own and the system gives none; allow user namespaces "
            "(sysctl user.max_user_namespaces, a container's seccomp profile), or set "
            "scenario_writer.allow_without_namespace: true to rely on its other walls"
        )
    ran = _ran(channels, ended, limits)
    return replace(ran, walls=status.walls, seconds=time.monotonic() - started)


@cache
def _site() -> str:
    try:
        return str(distribution("scenariogeneration").locate_file("."))
    except PackageNotFoundError as fault:
        raise MissingTool("generated code needs scenariogeneration: `pip install scenariogeneration`") from fault


# ------------------------------------------------------------------ the process
@dataclass
class _Channels:
    """What the process wrote on each channel; `cut` is why reading stopped early."""

    status: bytearray = field(default_factory=bytearray)
    said: bytearray = field(default_factory=bytearray)
    errors: bytearray = field(default_factory=bytearray)
    cut: Literal["", "time", "flood"] = ""


def _run_process(job: dict[str, Any], folder: str, wall_s: float) -> tuple[_Channels, int]:
    """What it wrote and its exit code."""
    ours, theirs = os.pipe()
    try:
        process = _start(job, folder, theirs)
    finally:
        os.close(theirs)
    try:
        channels = _read_channels(process, ours, time.monotonic() + wall_s)
    finally:
        os.close(ours)
        _kill(process)
    return channels, process.returncode


def _start(job: dict[str, Any], folder: str, status: int) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-I", "-S", "-B", "-c", _BOOT, str(settings.ROOT), _site(), str(status)]
    with tempfile.TemporaryFile(prefix="sgcad-job-") as stdin:
        stdin.write(json.dumps(job).encode("utf-8", "surrogatepass"))
        stdin.seek(0)
        return subprocess.Popen(  # noqa: S603 - our own interpreter and module
            command, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={}, cwd=folder,
            start_new_session=True, bufsize=0, pass_fds=(status,),
        )  # fmt: skip


def _read_channels(process: subprocess.Popen[bytes], status: int, deadline: float) -> _Channels:
    """Read all channels until they end, the time is over or there is too much on one."""
    channels = _Channels()
    with selectors.DefaultSelector() as selector:
        selector.register(status, selectors.EVENT_READ, (channels.status, MAX_STATUS))
        selector.register(process.stdout, selectors.EVENT_READ, (channels.said, MAX_ANSWER))  # type: ignore[arg-type]
        selector.register(process.stderr, selectors.EVENT_READ, (channels.errors, MAX_ERRORS))  # type: ignore[arg-type]
        while selector.get_map() and not channels.cut:
            ready = selector.select(max(0.0, deadline - time.monotonic()))
            if not ready:
                channels.cut = "time"
            for key, _ in ready:
                kept, room = key.data
                chunk = os.read(key.fd, 1 << 16)
                kept += chunk
                if not chunk:
                    selector.unregister(key.fileobj)
                elif len(kept) > room:
                    channels.cut = "flood"
    return channels


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Ends the process group; a process that has closed its pipes gets a moment to leave its exit code."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(0.1)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    for pipe in (process.stdout, process.stderr):
        if pipe:
            _await_end(pipe.fileno())
            pipe.close()


def _await_end(channel: int) -> None:
    """Reads on until every process that could write there is gone, which after the kill is a moment."""
    until = time.monotonic() + 2.0
    with selectors.DefaultSelector() as selector:
        selector.register(channel, selectors.EVENT_READ)
        while selector.select(max(0.0, until - time.monotonic())) and os.read(channel, 1 << 20):
            continue


# ------------------------------------------------------------------ its answer
def _status(channels: _Channels, ended: int) -> _Status:
    """Which walls stand. Raises MissingTool if the sandbox never came so far."""
    try:
        return _Status.model_validate_json(bytes(channels.status))
    except ValidationError as fault:
        words = channels.errors[-1500:].decode("utf-8", "replace").strip()
        said = words or channels.cut or "no words"
        raise MissingTool(f"the sandbox did not start (exit code {ended}): {said}") from fault


def _ran(channels: _Channels, ended: int, limits: Limits) -> Ran:
    """What came back; never raises, whatever the script wrote."""
    if channels.cut == "time":
        return _limit_fault("TimeLimit", f"the script ran longer than {limits.wall_s:g} s")
    if channels.cut == "flood":
        return _limit_fault("OutputLimit", "the script floods its output")
    said = bytes(channels.said)
    if not said:
        return _death(ended, limits)
    try:
        answer = _ANSWER.validate_json(said)
    except ValidationError:
        return _limit_fault("ForgedAnswer", "what came back on the sandbox's channel is not the sandbox's own answer")
    if isinstance(answer, _Written):
        return Ran(xosc=answer.xosc, printed=answer.printed)
    fault = Fault(answer.layer, answer.kind, answer.message, answer.line, answer.breaches)
    return Ran(fault=fault, printed=answer.printed)


def _death(ended: int, limits: Limits) -> Ran:
    number = ended - 128 if ended > 128 else -ended
    if number in (signal.SIGXCPU, signal.SIGKILL):
        return _limit_fault("ProcessorLimit", f"the script computed for more than {limits.cpu_s} s")
    how = signal.Signals(number).name if number in set(signal.Signals) else f"exit code {ended}"
    return _limit_fault("Died", f"the script ended its interpreter ({how}) instead of finishing")


def _limit_fault(kind: str, message: str) -> Ran:
    return Ran(fault=Fault("limit", kind, message))
