"""The near end: a script goes over to a fresh interpreter and comes back as a scenario file or as one fault.

The interpreter starts in isolated mode with an empty environment, in an empty folder, as a process group of its
own that is killed as a whole. Its answer is as untrusted as the script: it is bounded, and it is only text.
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
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from typing import Any, Literal

from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool

Layer = Literal["parse", "rules", "execution", "limit"]
MAX_ANSWER = 16_000_000
MAX_ERRORS = 100_000
STARTED = b"."
"""The first byte of an answer: the walls stand. What goes wrong before it is not the script's fault."""
_BOOT = (
    "import sys; root, site = sys.argv[1:]; sys.path.append(root); "
    "from plugins.scenario_writer.sandbox.inside import main; sys.path.append(site); main(site)"
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
    walls: tuple[str, ...] = ()
    seconds: float = 0.0


def run_script(
    source: str, limits: Limits | None = None, *, allow_without_namespace: bool = False, unchecked: bool = False
) -> Ran:
    """Run a script that leaves an xosc.Scenario in `scenario`. Raises MissingTool without scenariogeneration,
    ConfigError where the system gives no network namespace and `allow_without_namespace` is not set.

    `unchecked` skips the rules, to show what the walls hold alone; nothing but tests sets it.
    """
    limits = limits or Limits()
    started = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="sgcad-script-") as folder:
        job = {
            "source": source, "folder": folder, "cpu_s": limits.cpu_s, "memory_mb": limits.memory_mb,
            "allow_without_namespace": allow_without_namespace, "unchecked": unchecked,
        }  # fmt: skip
        heard, ended = _serve(job, folder, limits.wall_s)
    ran = _read(heard, ended, limits)
    if ran is None:
        raise ConfigError(
            "the sandbox needs a network namespace of its own and the system gives none; allow user namespaces "
            "(sysctl user.max_user_namespaces, a container's seccomp profile), or set "
            "scenario_writer.allow_without_namespace: true to rely on its other walls"
        )
    return Ran(ran.xosc, ran.fault, ran.printed, ran.walls, time.monotonic() - started)


@cache
def _site() -> str:
    try:
        return str(distribution("scenariogeneration").locate_file("."))
    except PackageNotFoundError as fault:
        raise MissingTool("generated code needs scenariogeneration: `pip install scenariogeneration`") from fault


# ------------------------------------------------------------------ the process
@dataclass
class _Heard:
    """What the process wrote; `cut` is why we stopped listening."""

    said: bytearray = field(default_factory=bytearray)
    errors: bytearray = field(default_factory=bytearray)
    cut: Literal["", "time", "flood"] = ""


def _serve(job: dict[str, Any], folder: str, wall_s: float) -> tuple[_Heard, int]:
    """What it wrote and its exit code."""
    command = [sys.executable, "-I", "-S", "-B", "-c", _BOOT, str(settings.ROOT), _site()]
    with tempfile.TemporaryFile(prefix="sgcad-job-") as stdin:
        stdin.write(json.dumps(job).encode("utf-8", "surrogatepass"))
        stdin.seek(0)
        process = subprocess.Popen(  # noqa: S603 - our own interpreter and module
            command, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={}, cwd=folder,
            start_new_session=True, bufsize=0,
        )  # fmt: skip
    try:
        heard = _hear(process, time.monotonic() + wall_s)
    finally:
        _kill(process)
    return heard, process.returncode


def _hear(process: subprocess.Popen[bytes], deadline: float) -> _Heard:
    """Read the answer until it ends, the time is over or there is too much of it."""
    heard = _Heard()
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ, (heard.said, MAX_ANSWER))  # type: ignore[arg-type]
        selector.register(process.stderr, selectors.EVENT_READ, (heard.errors, MAX_ERRORS))  # type: ignore[arg-type]
        while selector.get_map() and not heard.cut:
            ready = selector.select(max(0.0, deadline - time.monotonic()))
            if not ready:
                heard.cut = "time"
            for key, _ in ready:
                kept, room = key.data
                chunk = os.read(key.fd, 1 << 16)
                kept += chunk
                if not chunk:
                    selector.unregister(key.fileobj)
                elif len(kept) > room:
                    heard.cut = "flood"
    return heard


def _kill(process: subprocess.Popen[bytes]) -> None:
    """End the whole group; one that has closed its pipes gets a moment to leave its exit code."""
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(0.1)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    for pipe in (process.stdout, process.stderr):
        if pipe:
            pipe.close()


# ------------------------------------------------------------------ its answer
def _read(heard: _Heard, ended: int, limits: Limits) -> Ran | None:
    """What came back; None where the sandbox could not be isolated. Raises MissingTool if it never started."""
    said = bytes(heard.said)
    if not said.startswith(STARTED):
        words = heard.errors[-1500:].decode("utf-8", "replace").strip()
        raise MissingTool(f"the sandbox did not start (exit code {ended}): {words or heard.cut or 'no words'}")
    if heard.cut == "time":
        return _over("TimeLimit", f"the script ran longer than {limits.wall_s:g} s")
    if heard.cut == "flood":
        return _over("OutputLimit", "the script floods its output")
    try:
        answer = json.loads(said[len(STARTED) :])
        return _answer(answer) if isinstance(answer, dict) else _death(ended, limits)
    except (ValueError, KeyError, TypeError, IndexError, RecursionError):
        return _death(ended, limits)


def _answer(answer: dict[str, Any]) -> Ran | None:
    layer = answer.get("layer")
    if layer == "isolation":
        return None
    walls = tuple(str(w) for w in answer.get("walls", ()))
    printed = str(answer.get("printed", ""))
    if answer["ok"]:
        return Ran(xosc=str(answer["xosc"]), printed=printed, walls=walls)
    line = answer.get("line")
    breaches = tuple((int(b[0]), str(b[1]), str(b[2]), str(b[3])) for b in answer.get("breaches", ()))
    fault = Fault(
        layer if layer in ("parse", "rules") else "execution", str(answer.get("kind", "")),
        str(answer.get("message", "")), line if isinstance(line, int) else None, breaches,
    )  # fmt: skip
    return Ran(fault=fault, printed=printed, walls=walls)


def _death(ended: int, limits: Limits) -> Ran:
    number = ended - 128 if ended > 128 else -ended
    if number in (signal.SIGXCPU, signal.SIGKILL):
        return _over("ProcessorLimit", f"the script computed for more than {limits.cpu_s} s")
    how = signal.Signals(number).name if number in set(signal.Signals) else f"exit code {ended}"
    return _over("Died", f"the script ended its interpreter ({how}) instead of finishing")


def _over(kind: str, message: str) -> Ran:
    return Ran(fault=Fault("limit", kind, message))
