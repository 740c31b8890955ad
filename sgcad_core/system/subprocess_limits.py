"""A program run with limits: wall time, memory and the size of what it writes.

Its input may be made to use the machine up (a road of a million lanes). Knows no program.
"""

from __future__ import annotations

import resource
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

MEMORY_MB, FILE_MB = 2_000, 200
"""Of netconvert on a report's roads: twenty times what the largest of them takes."""


def ended_from_outside(code: int | None) -> bool:
    """Whether an exit code of `subprocess` is that of a signal that no crash sends: a kill, or lack of memory."""
    return -(code or 0) in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)


def run_limited(
    command: Sequence[str],
    folder: Path,
    environment: Mapping[str, str],
    timeout_s: float,
    *,
    memory_mb: int = MEMORY_MB,
    file_mb: int = FILE_MB,
) -> subprocess.CompletedProcess[bytes]:
    """Run a program in a folder; its output is caught. Raises subprocess.TimeoutExpired after it was killed.

    Over `memory_mb` (address space) an allocation fails, over `file_mb` the program dies of SIGXFSZ. Where the system
    knows no limits of other processes (not Linux) only the time is limited.
    """
    with subprocess.Popen(  # noqa: S603 - the caller's program, no shell
        command, cwd=folder, env=dict(environment), stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        if sys.platform.startswith("linux"):
            _limit(process.pid, resource.RLIMIT_AS, memory_mb)
            _limit(process.pid, resource.RLIMIT_FSIZE, file_mb)
        try:
            out, err = process.communicate(timeout=timeout_s)
        except BaseException:
            process.kill()
            raise
    return subprocess.CompletedProcess(command, process.returncode, out, err)


def _limit(process: int, what: int, megabytes: int) -> None:
    try:
        resource.prlimit(process, what, (megabytes << 20, megabytes << 20))
    except ProcessLookupError:  # it has ended already
        return
