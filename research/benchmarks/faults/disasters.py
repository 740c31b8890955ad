"""What a batch stands on, broken while it works: disk, permissions, database, programs, memory.

Each breaks one thing, lets the batch end by itself, mends it and runs the same command again. A disk is a small tmpfs
where this user may mount one, else it is said that it was not tried.
"""

from __future__ import annotations

import contextlib
import shutil
import sqlite3
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import psutil

from research.benchmarks.faults import meddling
from research.benchmarks.faults.kills import AGAIN_S, Undisturbed, again
from research.benchmarks.faults.places import Place

CASES_S = 5.0
"""A batch has begun its cases by then, or is about to."""
TRACE = "Traceback (most recent call last)"


@dataclass(frozen=True)
class Happened:
    """One disaster: what the command said when it struck, and what was wrong then or afterwards."""

    name: str
    said: str
    faults: tuple[str, ...]


def _place(peace: Undisturbed, folder: Path) -> Place:
    place = Place(folder, peace.home)
    peace.target.prepare(folder)
    return place


def _through(peace: Undisturbed, place: Place, limits: tuple[str, ...] = (), **more: str) -> tuple[int, list[str]]:
    """Run the command under the disaster; its exit code and faults: a traceback, no end, processes left."""
    process = place.start(peace.target.command(place.folder), more, limits)
    return _ended(process, place)


def _ended(process: subprocess.Popen[bytes], place: Place) -> tuple[int, list[str]]:
    try:
        code = process.wait(AGAIN_S)
    except subprocess.TimeoutExpired:
        place.wait_for_all(0)
        return -1, [f"does not end within {AGAIN_S:g} s"]
    faults = [f"still runs: {line}" for line in place.wait_for_all()]
    return code, faults + (["shows a traceback"] if TRACE in place.said() else [])


def _told(name: str, code: int, faults: list[str], place: Place, rest: list[str]) -> Happened:
    lines = [line for line in place.said().splitlines() if "error" in line or "failed" in line]
    said = f"exit {code}: {lines[0][:160] if lines else 'nothing'}".replace(str(place.folder), "").replace("|", "/")
    if not [*faults, *rest]:
        place.remove()
    return Happened(name, said, (*faults, *rest))


# ------------------------------------------------------------------ disk
@contextmanager
def _disk(folder: Path, size: str) -> Iterator[None]:
    """A tmpfs on a folder. Raises PermissionError where this user may mount none."""
    mount = shutil.which("mount") or "mount"
    folder.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([mount, "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)], capture_output=True)  # noqa: S603
    if done.returncode:
        raise PermissionError(done.stderr.decode().strip())
    try:
        yield
    finally:
        subprocess.run([shutil.which("umount") or "umount", str(folder)], check=True)  # noqa: S603 - what we mounted


def _remount(folder: Path, options: str) -> None:
    subprocess.run([shutil.which("mount") or "mount", "-o", f"remount,{options}", str(folder)], check=True)  # noqa: S603


def disk(peace: Undisturbed, folder: Path) -> Happened:
    """The disk of the results fills up in the midst of the batch; then there is room."""
    place = _place(peace, folder)
    try:
        with _disk(folder / "out", "64m"):
            (folder / "out" / "ballast").write_bytes(bytes(12_500_000))  # 50 MB are wanted free at the start
            process = place.start(peace.target.command(folder))
            _wait_for(folder / "out", "template/*/result.json")
            _fill(folder / "out" / "more")
            code, faults = _ended(process, place)
            faults += [] if code in (1, 2) else [f"ends with {code} on a full disk"]
            for name in ("ballast", "more"):
                (folder / "out" / name).unlink()
            return _told("disk", code, faults, place, again(peace, place))
    except PermissionError as fault:
        return Happened("disk", f"not tried, no tmpfs can be mounted ({fault})", ())


def _fill(file: Path) -> None:
    with contextlib.suppress(OSError), file.open("wb", buffering=0) as out:
        while True:
            out.write(bytes(65536))


def _wait_for(out: Path, pattern: str, patience_s: float = 120.0) -> None:
    deadline = time.monotonic() + patience_s
    while not any(out.glob(pattern)) and time.monotonic() < deadline:
        time.sleep(0.02)


def readonly(peace: Undisturbed, folder: Path) -> Happened:
    """The results' disk cannot be written (permissions bind no root, a read-only mount does)."""
    place = _place(peace, folder)
    try:
        with _disk(folder / "out", "256m"):
            _remount(folder / "out", "ro")
            code, faults = _through(peace, place)
            faults += [] if code == 2 else [f"ends with {code} where nothing can be written"]
            _remount(folder / "out", "rw")
            return _told("readonly", code, faults, place, again(peace, place))
    except PermissionError as fault:
        return Happened("readonly", f"not tried, no tmpfs can be mounted ({fault})", ())


# ------------------------------------------------------------------ database
def locked(peace: Undisturbed, folder: Path) -> Happened:
    """Another program locks MLflow's database in the midst of the batch and keeps it."""
    place = _place(peace, folder)
    process = place.start(peace.target.command(folder))
    _wait_for(folder / "out", "template/*/.tracked")
    with contextlib.closing(sqlite3.connect(folder / "out" / "mlflow.db", timeout=60, isolation_level=None)) as held:
        with contextlib.suppress(sqlite3.OperationalError):
            held.execute("BEGIN IMMEDIATE")
        code, faults = _ended(process, place)
    return _told("locked", code, faults, place, again(peace, place))


# ------------------------------------------------------------------ processes
def netconvert(peace: Undisturbed, folder: Path) -> Happened:
    """Whatever netconvert starts is killed for some seconds."""
    return _hunted(peace, folder, "netconvert")


def worker(peace: Undisturbed, folder: Path) -> Happened:
    """A worker process, in which libsumo runs, is killed again and again for some seconds."""
    return _hunted(peace, folder, "sgcad_core.system.worker_process")


def prefect(peace: Undisturbed, folder: Path) -> Happened:
    """Prefect's server is killed in the midst of the batch."""
    return _hunted(peace, folder, "flows.server", most=1, after="template/*/result.json")


def _hunted(peace: Undisturbed, folder: Path, name: str, most: int = 5, after: str = "") -> Happened:
    place = _place(peace, folder)
    process, hits = place.start(peace.target.command(folder)), 0
    if after:
        _wait_for(folder / "out", after)
    deadline, command = time.monotonic() + 120, psutil.Process(process.pid)
    while hits < most and process.poll() is None and time.monotonic() < deadline:
        hits += _kill_one(command, name)
        time.sleep(0.001)
    code, faults = _ended(process, place)
    faults += [] if hits else [f"{name} was never seen"]
    return _told(name, code, faults, place, again(peace, place))


def _kill_one(command: psutil.Process, name: str) -> int:
    """Kill the first descendant of a command that has the name; netconvert lives for 20 ms, so look quickly."""
    with contextlib.suppress(psutil.Error):
        for process in command.children(recursive=True):
            with contextlib.suppress(psutil.Error):
                if any(name in part for part in process.cmdline()[:4]):
                    process.kill()
                    return 1
    return 0


def memory(peace: Undisturbed, folder: Path) -> Happened:
    """A worker may not take another 32 MB of address space (RLIMIT_AS) once it works: allocations fail in it."""
    place = _place(peace, folder)
    process = place.start(peace.target.command(folder))
    deadline, limited = time.monotonic() + 120, False
    while not limited and process.poll() is None and time.monotonic() < deadline:
        limited = any(_limit(one) for one in place.alive())
        time.sleep(0.02)
    code, faults = _ended(process, place)
    faults = [f for f in faults if f != "shows a traceback"]  # a library's last words of its own thread
    return _told("memory", code, faults + ([] if limited else ["no worker was seen"]), place, again(peace, place))


def _limit(process: psutil.Process) -> bool:
    try:
        if "sgcad_core.system.worker_process" in process.cmdline() and process.memory_info().rss > 80e6:
            most = process.memory_info().vms + (32 << 20)
            process.rlimit(psutil.RLIMIT_AS, (most, most))
            return True
    except psutil.Error:
        pass
    return False


def _meddled(meddle: Callable[[Undisturbed, Path], meddling.Seen]) -> Callable[[Undisturbed, Path], Happened]:
    def happen(peace: Undisturbed, folder: Path) -> Happened:
        said, faults, place = meddle(peace, folder)
        if not faults:
            place.remove()
        return Happened(meddle.__name__, said, tuple(faults))

    return happen


DISASTERS: dict[str, Callable[[Undisturbed, Path], Happened]] = {
    f.__name__: f for f in (disk, readonly, locked, netconvert, worker, prefect, memory)
} | {f.__name__: _meddled(f) for f in (meddling.moved, meddling.edited, meddling.between, meddling.desk)}
