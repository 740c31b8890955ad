"""Feed a kind's inputs in processes of limited time and memory, and count how they ended.

An input at which the process dies or hangs counts as such, and the next process goes on behind it.
"""

from __future__ import annotations

import json
import os
import selectors
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from research.benchmarks.attack.feeder import Fed
from sgcad_core import settings

BATCH = 250
"""Inputs of one process: its seed makes them all, so a new one makes those before it again."""
START_S = 120.0
LARGE_MB = 500.0
"""Memory above which an input is large."""
COLUMNS = ("n", "done", "refused", "tracebacks", "hung", "died", "slow", "over 500 MB", "wrong writes", "slowest s")


@dataclass(frozen=True)
class Limits:
    """Longest time for one input, s."""

    each_s: float


def fed(kind: str, count: int, seed: int, limits: Limits, folder: Path) -> Iterator[Fed]:
    """Every input of a kind, in order."""
    for first in range(0, count, BATCH):
        size = min(BATCH, count - first)
        yield from _batch(kind, f"{seed}.{first // BATCH}", size, limits, folder, first)


def _batch(kind: str, seed: str, size: int, limits: Limits, folder: Path, first: int) -> Iterator[Fed]:
    done = 0
    while done < size:
        (place := folder / f"{kind}-{seed}-{done}".replace(" ", "_")).mkdir(parents=True)
        process = _started(kind, seed, size, done, place)
        try:
            for line in _lines(process, limits.each_s):
                one = Fed(**json.loads(line))
                done = one.number + 1
                yield _moved(one, first)
        except TimeoutError:
            yield Fed(first + done, "hung", limits.each_s, said=f"no end within {limits.each_s:g} s")
            done += 1
        finally:
            _end(process)
        if done < size and process.returncode and process.returncode != -signal.SIGKILL:
            yield Fed(first + done, "died", said=_last_words(place, process.returncode))
            done += 1
        _remove(place)


def _moved(one: Fed, first: int) -> Fed:
    return replace(one, number=first + one.number)


def _started(kind: str, seed: str, size: int, skip: int, place: Path) -> subprocess.Popen[str]:
    own = {"TMPDIR": str(place), "HOME": str(place), "MPLCONFIGDIR": str(place / "matplotlib")}
    own |= {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(settings.ROOT), "OMP_NUM_THREADS": "1"}
    own |= {"PYTHONHASHSEED": "0"}  # the same inputs every time
    command = [sys.executable, "-m", "research.benchmarks.attack.feeder", kind, seed, str(size), str(skip), str(place)]
    with (place / "err.log").open("ab") as errors:
        return subprocess.Popen(  # noqa: S603 - our own interpreter and module
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors, text=True, cwd=place,
            env=os.environ | own, start_new_session=True,
        )  # fmt: skip


def _lines(process: subprocess.Popen[str], each_s: float) -> Iterator[str]:
    """Lines of a process until it ends. Raises TimeoutError where one is late; the first may take longer."""
    assert process.stdout is not None  # noqa: S101 - it is a pipe
    descriptor, rest, wait = process.stdout.fileno(), b"", START_S + each_s
    with selectors.DefaultSelector() as selector:
        selector.register(descriptor, selectors.EVENT_READ)
        while selector.select(wait):
            piece = os.read(descriptor, 65536)
            if not piece:
                return
            *whole, rest = (rest + piece).split(b"\n")
            yield from (line.decode("utf-8") for line in whole)
            wait = each_s if whole else wait
    raise TimeoutError


def _end(process: subprocess.Popen[str]) -> None:
    """End a process and its children."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(5 if process.poll() is None else 0)
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    if process.stdout:
        process.stdout.close()


def _last_words(place: Path, code: int) -> str:
    lines = (place / "err.log").read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return f"exit code {code}: {lines[-1][:200] if lines else 'nothing said'}"


def _remove(place: Path) -> None:
    import shutil

    shutil.rmtree(place, ignore_errors=True)


# ------------------------------------------------------------------ counting
def is_fault(one: Fed) -> bool:
    """Whether an input ended otherwise than it should."""
    return one.end not in ("done", "refused") or one.slow or one.grown_mb > LARGE_MB or bool(one.wrote)


def in_words(one: Fed) -> str:
    """A fault in a line."""
    told = [one.said or one.end] if one.end not in ("done", "refused") else []
    told += [f"{one.seconds:.1f} s for {one.size} bytes"] if one.slow else []
    told += [f"{one.grown_mb:.0f} MB"] if one.grown_mb > LARGE_MB else []
    told += [f"writes {one.wrote}"] if one.wrote else []
    return f"{one.number}: {'; '.join(told)}"


def row(kind: str, found: Sequence[Fed]) -> str:
    """A kind's counts as a row of Markdown."""
    ends = [sum(one.end == end for one in found) for end in ("done", "refused", "traceback", "hung", "died")]
    large, wrote = (sum(one.grown_mb > LARGE_MB for one in found), sum(bool(one.wrote) for one in found))
    more = [sum(one.slow for one in found), large, wrote]
    slowest = max((one.seconds for one in found), default=0.0)
    return f"| {kind} | {' | '.join(f'{n:,}' for n in (len(found), *ends, *more))} | {slowest:.2f} |"


def head() -> str:
    """The table's head."""
    return f"| kind | {' | '.join(COLUMNS)} |\n|---|{'---:|' * len(COLUMNS)}"
