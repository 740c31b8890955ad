"""The machine of a run: processor, memory, graphics cards, and the commit of the code; no host or user name."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from pathlib import Path
from typing import Any

from sgcad_core import settings

ASK_S = 20.0


def hardware() -> dict[str, Any]:
    """Processor, cores that this process may use, memory (GiB), graphics cards (empty where there is none)."""
    import psutil

    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "system": platform.system(),
        "processor": _processor(),
        "cores": usable,
        "memory_gib": round(psutil.virtual_memory().total / 2**30, 1),
        "gpus": _asked(["nvidia-smi", "--query-gpu=name,memory.total", "--format=csv,noheader"]),
        "python": platform.python_version(),
    }


def git_commit() -> str | None:
    """The commit of the code, with "-dirty" appended if the work tree differs; None outside a repository."""
    commit = _asked(["git", "rev-parse", "HEAD"])
    if not commit or not (settings.ROOT / ".git").exists():
        return None
    return commit[0] + ("-dirty" if _asked(["git", "status", "--porcelain", "--untracked-files=no"]) else "")


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines() if cpuinfo.is_file() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def _asked(command: list[str]) -> list[str]:
    """A program's output lines; empty if it is missing, fails or hangs."""
    program = shutil.which(command[0])
    if program is None:
        return []
    try:
        done = subprocess.run(  # noqa: S603 - a program on the user's path with fixed arguments
            [program, *command[1:]], cwd=settings.ROOT, capture_output=True, text=True, timeout=ASK_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return []
    return [line.strip() for line in done.stdout.splitlines() if line.strip()] if done.returncode == 0 else []
