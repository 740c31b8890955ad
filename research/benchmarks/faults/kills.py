"""kill -9 at random points, of a command or of one of its children; then the same command again.

What is asked each time: no process is left, `sgcad doctor` names what lies about, the second run ends well, its
results are those of an undisturbed run, and the temporary folder is empty.
"""

from __future__ import annotations

import random
import signal
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

from flows.doctor import CHECKS
from flows.service_checks import CheckFailed
from research.benchmarks.faults.places import Place
from research.benchmarks.faults.targets import Target

AGAIN_S = 600.0
CHILD_SHARE = 0.3
"""Of the kills that hit a child (a worker, netconvert, Prefect's server), not the command itself."""
FRESH_SHARE = 0.15
"""Of the trials on a machine where Prefect has never run."""


@dataclass(frozen=True)
class Undisturbed:
    """A target's run that nothing happened to: its results, how long it took, and the Prefect home it left."""

    target: Target
    place: Place
    seconds: float

    @property
    def home(self) -> Path | None:
        """A Prefect home to copy."""
        return self.place.prefect if self.place.prefect.is_dir() else None


@dataclass(frozen=True)
class Trial:
    """One kill: what was hit when, and everything that was wrong afterwards."""

    target: str
    at_s: float
    hit: str
    faults: tuple[str, ...]


def undisturbed(target: Target, folder: Path, home: Path | None = None) -> Undisturbed:
    """Run a target in peace. Raises RuntimeError where even that fails."""
    place = Place(folder, home)
    target.prepare(folder)
    started = time.monotonic()
    code = place.start(target.command(folder)).wait(AGAIN_S)
    if code not in target.ends or place.wait_for_all():
        raise RuntimeError(f"{target.name} ends with {code} without any fault:\n{place.said()[-2000:]}")
    return Undisturbed(target, place, time.monotonic() - started)


def trial(peace: Undisturbed, folder: Path, rng: random.Random) -> Trial:
    """Start, kill, look, start again, compare."""
    target = peace.target
    place = Place(folder, None if rng.random() < FRESH_SHARE else peace.home)
    target.prepare(folder)
    at_s = rng.uniform(0.0, peace.seconds)
    hit = _kill(place, place.start(target.command(folder)), at_s, rng)
    faults = [f"still runs: {line}" for line in place.wait_for_all()]
    faults += _doctor(place)
    faults += again(peace, place)
    if not faults:
        place.remove()
    return Trial(target.name, at_s, hit, tuple(faults))


def _kill(place: Place, process: subprocess.Popen[bytes], at_s: float, rng: random.Random) -> str:
    """What was hit: the command, a child by name, or nothing because the run was over."""
    try:
        process.wait(at_s)
        return "nothing"
    except subprocess.TimeoutExpired:
        pass
    children = [p for p in place.alive() if p.pid != process.pid]
    if rng.random() < CHILD_SHARE and children:
        victim = rng.choice(sorted(children, key=lambda p: p.pid))
        name = _name(victim)
        _signal(victim)
        with suppress(subprocess.TimeoutExpired):  # then it still runs, which is a fault
            process.wait(AGAIN_S)
        return name
    process.send_signal(signal.SIGKILL)
    process.wait()
    return "command"


def _signal(victim: psutil.Process) -> None:
    try:
        victim.kill()
    except psutil.NoSuchProcess:
        return


def _name(process: psutil.Process) -> str:
    try:
        line = process.cmdline()
    except psutil.Error:
        return "child"
    known = ("sgcad_core.system.worker_process", "flows.server", "netconvert", "resource_tracker", "multiprocessing")
    return next((name for name in known if any(name in part for part in line)), "child")


def _doctor(place: Place) -> list[str]:
    """What `sgcad doctor` should have named and did not."""
    with place.as_temporary():
        try:
            said = CHECKS["leftovers"](place.folder / "out")
        except CheckFailed as told:  # processes of somebody else: ours have ended
            said = str(told)
    lying = {
        "half-written case folder": list(place.folder.glob("out/*/.partial-*")),
        "temporary folder": [name for name in place.leftovers() if name.startswith("sgcad-temp-")],
    }
    return [f"doctor does not name a {what}" for what, there in lying.items() if there and what not in said]


def again(peace: Undisturbed, place: Place) -> list[str]:
    """Run the same command in the same place; what is wrong then."""
    target = peace.target
    try:
        code = place.start(target.command(place.folder)).wait(AGAIN_S)
    except subprocess.TimeoutExpired:
        place.wait_for_all(0)
        return [f"run again it takes more than {AGAIN_S:g} s"]
    faults = [f"run again it ends with {code}: {place.said()[-300:]}"] if code not in target.ends else []
    faults += [f"still runs at the end: {line}" for line in place.wait_for_all()]
    if not faults:
        faults = target.faults(place.folder, peace.place.folder)
    return faults + [f"in the temporary folder: {name}" for name in place.leftovers()]
