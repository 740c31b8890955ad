"""Another player's motion for the same scenario file: esmini, run as a user has it, and how far ours lies from it.

Both are played with one step length, since conditions fire at steps. Knows nothing of our player but its result.
"""

from __future__ import annotations

import csv
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sgcad_core.formats.openscenario.playing.body import Body
from sgcad_core.formats.openscenario.playing.player import Played
from sgcad_core.formats.openscenario.reading.files import Variation
from sgcad_core.geometry.plane import Floats

TIMEOUT_S = 30.0
LIMIT_M = 0.3


class Apart(NamedTuple):
    """Largest distance of box centers over the common time, its actor, and when it first passes the limit."""

    worst_m: float
    actor: str
    first_s: float | None
    common_s: float


class Judged(NamedTuple):
    """The judge's (n, 4) t, x, y, heading of the origin by entity; its own words where it gave none."""

    motion: Mapping[str, Floats]
    why_not: str


def judged(
    esmini: Path,
    variation: Variation,
    distribution: tuple[Path, int] | None,
    dt_s: float,
    until_s: float,
    maps: Sequence[Path] = (),
) -> Judged:
    """Run the judge. `distribution`: the file of parameter sets and the number of the set; `maps`: folders of maps that
    the scenario may name, also without the ending (as CARLA's do)."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "out.csv"
        command = [
            str(esmini), "--osc", str(variation.file.resolve()), "--headless", "--fixed_timestep", f"{dt_s:g}",
            "--csv_logger", str(log), "--disable_stdout", "--logfile_path", str(Path(folder) / "log.txt"),
            "--traj_filter", "0", "--disable_controllers", "--path", str(_linked(maps, Path(folder) / "maps")),
        ]  # fmt: skip
        if distribution:
            command += ["--param_dist", str(distribution[0].resolve()), "--param_permutation", str(distribution[1])]
        ending = _run(command, Path(folder), until_s)
        logs = sorted(Path(folder).glob("out*.csv"))  # with a distribution the set's number stands in the name
        motion = _motion(logs[0], until_s) if logs else {}
        words = _last_error(Path(folder) / "log.txt")
    return Judged(motion, "" if motion else words or ending)


def _linked(maps: Sequence[Path], folder: Path) -> Path:
    """A folder with the maps by name and by stem."""
    folder.mkdir()
    for file in (file for place in maps for file in sorted(place.glob("*.xodr"))):
        for name in {file.name, file.stem}:
            (folder / name).symlink_to(file.resolve())
    return folder


def _run(command: list[str], folder: Path, until_s: float) -> str:
    """Run until it ends by itself or has had its time: what was logged until then counts."""
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=TIMEOUT_S)  # noqa: S603 - the user's own
    except subprocess.TimeoutExpired:
        return f"not over within {TIMEOUT_S:g} s"
    return f"exit code {done.returncode}"


def _motion(log: Path, until_s: float) -> dict[str, Floats]:
    with log.open(newline="", encoding="utf-8", errors="replace") as file:
        lines = csv.reader(file, skipinitialspace=True)
        header = next((line for line in lines if line and line[0].startswith("Index")), None)
        if header is None:
            return {}
        names = [column.strip() for column in header]
        width = sum(name.startswith("#1 ") for name in names)
        at = [next(i for i, n in enumerate(names) if n.startswith(f"#1 {what}")) - 2 for what in _COLUMNS]
        return _rows(lines, width, at, until_s)


_COLUMNS = ("Entity_Name", "World_Position_X", "World_Position_Y", "World_Heading_Angle")


def _rows(lines: csv.reader, width: int, at: list[int], until_s: float) -> dict[str, Floats]:  # type: ignore[valid-type]
    rows: dict[str, list[tuple[float, ...]]] = {}
    for line in lines:
        t_s = float(line[1]) if len(line) > width else until_s + 1
        if t_s > until_s:
            break
        for begin in range(2, len(line) - width + 1, width):
            name, *values = (line[begin + i] for i in at)
            rows.setdefault(name.strip(), []).append((t_s, *map(float, values)))
    return {name: np.array(found) for name, found in rows.items()}


def _last_error(log: Path) -> str:
    text = log.read_text(errors="replace") if log.is_file() else ""
    errors = [line for line in text.splitlines() if "[error]" in line]
    return errors[-1].strip()[:200] if errors else ""


def apart(played: Played, judge: Mapping[str, Floats], dt_s: float) -> Apart | None:
    """Our box centers against the judge's; None where no entity is in both."""
    worst: Apart | None = None
    for motion in played.trajectories:
        if motion.actor not in judge:
            continue
        found = _of_one(motion.actor, np.column_stack((motion.t_s, motion.x_m, motion.y_m)), judge, played.bodies, dt_s)
        if found and (worst is None or found.worst_m > worst.worst_m):
            worst = found
    return worst


def _of_one(
    name: str, ours: Floats, judge: Mapping[str, Floats], bodies: Mapping[str, Body], dt_s: float
) -> Apart | None:
    theirs = judge[name]
    centers = bodies[name].box.centers(theirs[:, 1:3], theirs[:, 3])
    steps = np.round(theirs[:, 0] / dt_s).astype(int)
    both = (steps < len(ours)) & (np.abs(theirs[:, 0] - steps * dt_s) < dt_s / 10)
    if not both.any():
        return None
    gap = np.hypot(*(centers[both] - ours[steps[both], 1:]).T)
    if not np.isfinite(gap).all():
        return None  # the judge lost it
    over = np.flatnonzero(gap > LIMIT_M)
    times = theirs[both, 0]
    return Apart(float(gap.max()), name, float(times[over[0]]) if len(over) else None, float(times[-1]))
