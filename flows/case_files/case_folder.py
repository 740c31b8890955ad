"""A case's folder on disk (docs/configs.md): written whole or not at all.

Files are written into a hidden folder beside the target, result.json and the digest last, which is then renamed: a
kill, a full disk or Ctrl-C leaves no half-written case that looks finished.
"""

from __future__ import annotations

import contextlib
import csv
import errno
import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sgcad_core.case.records import Attempt, CrashReport, RoadNetwork, Scenario, Trajectory
from sgcad_core.case.traffic import ROLE
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.result import CaseRecord
from sgcad_core.system.private_folders import open_as_parent
from sgcad_core.system.report_files import read_regular

CONFIG = "config.yaml"
"""In the folder of a config's cases: the effective config."""
DIGEST = ".digest"
TRACKED = ".tracked"
CRASH = "crash"
"""Role of an actor of the crash in trajectories.csv; that of a background vehicle is `ROLE`."""
PARTIAL = ".partial-"
REPLACE_TRIES = 20
"""Maximum tries to replace a folder that other processes replace at the same time."""
MAX_JSON_BYTES = 64 * 2**20
MIN_FREE_MB = 50
"""Free space below which nothing is started; a case takes 1 to 3 MB."""


@dataclass(frozen=True)
class CaseFolder:
    """The folder of one case of one config."""

    out: Path
    config: str
    case: str

    @property
    def path(self) -> Path:
        """The folder itself."""
        return self.out / self.config / self.case

    def finished(self, digest: str) -> dict[str, Any] | None:
        """result.json if the case is finished with this digest, else None."""
        try:
            if (self.path / DIGEST).read_text(encoding="utf-8") != digest:
                return None
        except (OSError, ValueError):
            return None
        return self.result()

    def result(self) -> dict[str, Any] | None:
        """result.json of any digest; None if it is missing or cannot be read."""
        result = read_json(self.path / "result.json")
        return result if "status" in result else None

    @contextmanager
    def writing(self) -> Iterator[Path]:
        """A new folder that becomes the case's folder if the block succeeds, and is removed otherwise."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        partial = Path(tempfile.mkdtemp(prefix=f"{PARTIAL}{os.getpid()}-", dir=self.path.parent))
        try:
            yield partial
            open_as_parent(partial)
            self._replace(partial)
        finally:
            shutil.rmtree(partial, ignore_errors=True)

    def _replace(self, partial: Path) -> None:
        """Replace the old folder by the new one, also while another process does the same (the last one stays)."""
        old = Path(tempfile.mkdtemp(prefix=f"{PARTIAL}{os.getpid()}-", dir=self.path.parent))
        try:
            for turn in range(REPLACE_TRIES):
                with contextlib.suppress(FileNotFoundError):
                    self.path.rename(old / str(turn))
                with _unless_there():
                    partial.rename(self.path)
                    return
            raise OSError(errno.EBUSY, "other processes write the same case", str(self.path))
        finally:
            shutil.rmtree(old, ignore_errors=True)

    def tracked(self, tracker: str) -> bool:
        """Whether this tracker has the case already."""
        mark = self.path / TRACKED
        return mark.is_file() and tracker in mark.read_text(encoding="utf-8").splitlines()

    def mark_tracked(self, tracker: str) -> None:
        """Note that this tracker has the case."""
        with (self.path / TRACKED).open("a", encoding="utf-8") as file:
            file.write(tracker + "\n")


@contextmanager
def _unless_there() -> Iterator[None]:
    """Ignore the error of a target folder that exists."""
    try:
        yield
    except OSError as fault:
        if fault.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise


def check_writable(out: Path) -> None:
    """Make the output folder, for its user alone. Raises ConfigError if it cannot be written or the disk is full."""
    try:
        out.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(prefix=PARTIAL, dir=out):
            pass
    except OSError as fault:
        raise ConfigError(f"--out {out}: cannot be written ({fault.strerror}); choose another folder") from fault
    free_mb = shutil.disk_usage(out).free // 2**20
    if free_mb < MIN_FREE_MB:
        raise ConfigError(f"--out {out}: {free_mb} MB free, {MIN_FREE_MB} are needed; free some or choose another disk")


def clear_partial(folder: Path, *, own: bool = False) -> int:
    """Remove folders that killed processes left, and with `own` those of this process; their number."""
    mine = str(os.getpid()) if own else ""
    found = ((p, p.name.split("-")[1]) for p in folder.glob(f"{PARTIAL}*-*") if p.is_dir())
    left = [p for p, process in found if process == mine or not _alive(process)]
    for partial in left:
        shutil.rmtree(partial, ignore_errors=True)
    return len(left)


def _alive(pid: str) -> bool:
    """Whether a process runs; a killed one stays listed until its parent asks for its end."""
    import psutil

    try:
        return bool(psutil.Process(int(pid)).status() != psutil.STATUS_ZOMBIE)
    except psutil.AccessDenied:
        return True
    except (ValueError, psutil.Error):
        return False


# ------------------------------------------------------------------ files
def write_artifacts(folder: Path, report: CrashReport | None, attempts: Iterable[Attempt], record: CaseRecord) -> None:
    """Write report, attempts, road network, scenario and trajectories, as far as they exist."""
    write_report(folder, report)
    write_attempts(folder, attempts)
    if record.network:
        write_network(folder, record.network)
    if record.scenario:
        write_scenario(folder, record.scenario)
    if record.execution:
        write_trajectories(folder / "trajectories.csv", record.execution.trajectories)


def write_report(folder: Path, report: CrashReport | None) -> None:
    """report.txt (empty if the report could not be read) and diagram.png, diagram-2.png, ..."""
    (folder / "report.txt").write_text(report.narrative if report else "", encoding="utf-8")
    for number, diagram in enumerate(report.diagrams if report else (), 1):
        (folder / ("diagram.png" if number == 1 else f"diagram-{number}.png")).write_bytes(diagram.png)


def write_attempts(folder: Path, attempts: Iterable[Attempt]) -> None:
    """attempts/<stage>-<nn>/: prompt.txt, answer.txt, findings.json, attempt.json."""
    (folder / "attempts").mkdir()
    for attempt in attempts:
        place = folder / "attempts" / f"{attempt.stage}-{attempt.number:02d}"
        place.mkdir()
        (place / "prompt.txt").write_text(attempt.prompt, encoding="utf-8", errors="replace")
        (place / "answer.txt").write_text(attempt.answer, encoding="utf-8", errors="replace")
        write_json(place / "findings.json", [f.model_dump() for f in attempt.findings])
        write_json(place / "attempt.json", _about(attempt))


def _about(attempt: Attempt) -> dict[str, Any]:
    about: dict[str, Any] = {"stage": attempt.stage, "number": attempt.number, "seconds": round(attempt.seconds, 4)}
    if attempt.held:
        about["held"] = [hold.line() for hold in attempt.held]
    if generation := attempt.generation:
        about["generation"] = {
            "finish": generation.finish,
            "prompt_tokens": generation.prompt_tokens,
            "answer_tokens": len(generation.tokens),
            "model_calls": generation.model_calls,
            "seconds": generation.seconds,
            "grounding": dict(generation.grounding),
            "conflicts": [c.model_dump() for c in generation.conflicts],
            "notes": list(generation.notes),
        }
    return about


def write_network(folder: Path, network: RoadNetwork) -> None:
    """road.net.xml and road.xodr, as far as they were compiled."""
    for name, text in (("road.net.xml", network.net_xml), ("road.xodr", network.xodr)):
        if text is not None:
            (folder / name).write_text(text, encoding="utf-8")


def write_scenario(folder: Path, scenario: Scenario) -> None:
    """scenario.xosc or scenario.rou.xml."""
    for name, text in (("scenario.xosc", scenario.xosc), ("scenario.rou.xml", scenario.routes_xml)):
        if text is not None:
            (folder / name).write_text(text, encoding="utf-8")


def write_trajectories(file: Path, trajectories: Sequence[Trajectory], traffic: Sequence[Trajectory] = ()) -> None:
    """trajectories.csv: t_s, actor, x_m, y_m, heading_rad, speed_mps; all actors of an instant together.

    Where an actor rolls over, a column roll_rad follows; where there is traffic, a column role (crash or traffic).
    """
    rolls = any(track.roll_rad is not None for track in trajectories)
    rows = []
    for k, track in enumerate((*trajectories, *traffic)):
        columns = (track.t_s, track.x_m, track.y_m, track.heading_rad, track.speed_mps, track.rolls)
        role = f",{CRASH if k < len(trajectories) else ROLE}" if traffic else ""
        for t, x, y, heading, speed, roll in zip(*columns, strict=True):
            more = (f",{roll:.5f}" if rolls else "") + role
            rows.append((float(t), k, f"{t:.2f},{track.actor},{x:.6f},{y:.6f},{heading:.7f},{speed:.4f}{more}\n"))
    with file.open("w", encoding="utf-8", newline="") as out:
        names = f"{',roll_rad' if rolls else ''}{',role' if traffic else ''}"
        out.write(f"t_s,actor,x_m,y_m,heading_rad,speed_mps{names}\n")
        out.writelines(row for _, _, row in sorted(rows))


def read_trajectories(file: Path, role: str = CRASH) -> tuple[Trajectory, ...]:
    """Read a trajectories.csv, actors in the order of the file: those of the crash, or the vehicles of its traffic.

    Raises BadInput for any other content.
    """
    needed = ("t_s", "x_m", "y_m", "heading_rad", "speed_mps")
    rows: dict[str, list[list[float]]] = {}
    with file.open(encoding="utf-8", newline="") as lines:
        try:
            table = csv.DictReader(lines)
            names = [*needed, *(name for name in table.fieldnames or () if name == "roll_rad")]
            for row in table:
                if row.get("role", CRASH) == role:
                    rows.setdefault(row["actor"], []).append([_finite(row[name]) for name in names])
        except (KeyError, TypeError, ValueError, csv.Error) as fault:
            raise BadInput(
                f"{file}: cannot be read as trajectories ({str(fault)[:100]}): every row needs actor "
                f"and, as finite numbers, {', '.join(needed)}; run the case again"
            ) from fault
    return tuple(
        Trajectory(actor=actor, **dict(zip(names, np.array(values).T, strict=True))) for actor, values in rows.items()
    )


def _finite(text: str) -> float:
    if not math.isfinite(value := float(text)):
        raise ValueError(f"{text!r} is not a finite number")
    return value


def read_json(file: Path) -> dict[str, Any]:
    """A JSON object; empty where the file is missing, still being written, no regular file or no object."""
    try:
        content = json.loads(read_regular(file, most=MAX_JSON_BYTES))
    except (BadInput, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def write_json(file: Path, content: Any) -> None:
    """Indented UTF-8 JSON; NaN and infinities are refused (no strict reader takes them)."""
    file.write_text(json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
