"""What a long batch takes per case: memory, open files, databases. `python -m research.benchmarks.services.growth
[--cases 2000] [--cheap]`.

One `sgcad evaluate` of the config `template` with MLflow and its own Prefect server over made reports (every tenth is a
bundled one under a new name). Every two seconds it is looked at: cases done, resident memory and open files of the
command, of its worker processes and of Prefect's server, sizes of both databases. Each slope per case is fitted to the
means of twenty equal spans of cases behind the first tenth, so that looks that follow each other do not count as many;
the interval is 95 % (Student's t). `--place` keeps the folder; called again there, the batch goes on and later looks
are added, told apart by the process they were made of. `--cheap`: the rules without SUMO
and its checks, and nine reports of ten that tell no crash and are refused: more cases in the time, each tracked as any.
"""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil
import yaml

from research.benchmarks.faults.places import Place
from research.generator.report import make_report
from sgcad_core import settings

EVERY_S = 2.0
SPANS = 20
WARM = 0.1
"""Share of the cases that is left out at the beginning."""
SEED = 42_000_000
T_95 = 2.101
"""Student's t for 18 degrees of freedom, two-sided."""
WHAT = {
    "main_kb": "memory of the command, kB",
    "workers_kb": "memory of its workers, kB",
    "server_kb": "memory of Prefect's server, kB",
    "main_files": "open files of the command",
    "workers_files": "open files of its workers",
    "server_files": "open files of Prefect's server",
    "mlflow_kb": "MLflow's database, kB",
    "prefect_kb": "Prefect's database, kB",
}
Look = dict[str, float]


def cases(folder: Path, count: int, cheap: bool = False) -> None:
    """Case folders that are not there yet. `cheap`: nine of ten tell no crash."""
    bundled = sorted((settings.ROOT / "docs" / "demo").glob("*/report.txt"))
    for number in range(count):
        case = folder / f"report-{number:05d}"
        if case.is_dir():
            continue
        case.mkdir(parents=True)
        text = f"Nothing is known of day {number}." if cheap and number % 10 != 1 else _text(number, bundled)
        (case / "report.txt").write_text(text, encoding="utf-8")


def _text(number: int, bundled: Sequence[Path]) -> str:
    return bundled[number // 10 % len(bundled)].read_text(encoding="utf-8") if number % 10 == 0 else _made(number)


def _made(number: int) -> str:
    return make_report(SEED + number, length=(number % 7) / 7, modes={"text": 1.0}).narrative


def batch(place: Place, count: int, cheap: bool = False) -> Iterator[Look]:
    """Run it; a look every two seconds. Raises RuntimeError where it does not end as a batch does."""
    config = _cheap(place.folder / "template.yaml") if cheap else "template"
    command = ["-c", "from flows.cli import main; main()", "evaluate", "cases", "--config", config, "--out", "out"]
    process = place.start(command)
    while process.poll() is None:
        yield _look(place, process)
        time.sleep(EVERY_S)
    done = _done(place.folder)
    if process.returncode not in (0, 1) or done < count:
        raise RuntimeError(f"{done} of {count} cases, exit code {process.returncode}:\n{place.said()[-2000:]}")


def _cheap(file: Path) -> str:
    raw = yaml.safe_load((settings.CONFIGS / "template.yaml").read_text(encoding="utf-8"))
    names = ("evidence_gate", "road_narrative", "behavior_narrative")
    few = {"validators": [{"name": name} for name in names], "simulator": {"name": "kinematic"}}
    file.write_text(yaml.safe_dump(raw | few), encoding="utf-8")
    return file.name


def _look(place: Place, process: subprocess.Popen[bytes]) -> Look:
    found = dict.fromkeys(("main_kb", "workers_kb", "server_kb", "main_files", "workers_files", "server_files"), 0.0)
    for one in place.alive():
        with suppress(psutil.Error):
            who = "main" if one.pid == process.pid else "server" if "flows.server" in one.cmdline() else "workers"
            found[f"{who}_kb"] += one.memory_info().rss / 1000
            found[f"{who}_files"] += one.num_fds()
    sizes = {"mlflow_kb": place.folder / "out" / "mlflow.db", "prefect_kb": place.prefect / "prefect.db"}
    stored = {name: sum(_size(Path(f"{file}{tail}")) for tail in ("", "-wal")) / 1000 for name, file in sizes.items()}
    return {"pid": process.pid, "done": _done(place.folder), **found, **stored}


def _size(file: Path) -> int:
    return file.stat().st_size if file.is_file() else 0


def _done(folder: Path) -> int:
    """Cases that have their folder, which is renamed into place when it is whole."""
    with suppress(FileNotFoundError):
        return sum(not entry.name.startswith(".") for entry in os.scandir(folder / "out" / "template"))
    return 0


def slope(looks: Sequence[Look], name: str) -> tuple[float, float]:
    """Growth per case and half its 95 % interval; of the last process that was looked at.

    Raises ValueError where there are not enough looks for SPANS means.
    """
    mine = [look for look in looks if look["pid"] == looks[-1]["pid"]]
    done, value = (np.array([look[key] for look in mine]) for key in ("done", name))
    first = done[0] + WARM * (done[-1] - done[0])
    span = np.floor((done - first) / max(1e-9, (done[-1] - first)) * SPANS * (1 - 1e-9))
    means = [(done[span == i].mean(), value[span == i].mean()) for i in range(SPANS) if (span == i).any()]
    if len(means) < SPANS:
        raise ValueError(f"{len(mine)} looks fall into {len(means)} of {SPANS} spans: use more cases")
    x, y = np.array(means).T
    by = float(((x - x.mean()) * (y - y.mean())).sum() / ((x - x.mean()) ** 2).sum())
    rest = y - y.mean() - by * (x - x.mean())
    return by, T_95 * float(np.sqrt((rest**2).sum() / (SPANS - 2) / ((x - x.mean()) ** 2).sum()))


def table(looks: Sequence[Look]) -> str:
    """Slopes as Markdown."""
    lines = ["| | at the first look | at the last | a case, 95 % interval |", "|---|---:|---:|---:|"]
    mine = [look for look in looks if look["pid"] == looks[-1]["pid"]]
    for name, what in WHAT.items():
        by, half = slope(looks, name)
        first = next(look for look in mine if look["done"] >= WARM * mine[-1]["done"])
        lines.append(f"| {what} | {first[name]:,.0f} | {mine[-1][name]:,.0f} | {by:.3f} +- {half:.3f} |")
    return "\n".join(lines) + "\n"


def read_looks(file: Path) -> list[Look]:
    """Looks of a file, none if there is none."""
    if not file.is_file():
        return []
    with file.open(encoding="utf-8", newline="") as rows:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(rows)]


def keep(file: Path, look: Look) -> None:
    """Add a look to a file."""
    fresh = not file.is_file()
    with file.open("a", encoding="utf-8", newline="") as rows:
        writer = csv.DictWriter(rows, ["pid", "done", *WHAT])
        if fresh:
            writer.writeheader()
        writer.writerow(look)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m research.benchmarks.services.growth", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--place", type=Path, help="folder to work in, which stays")
    parser.add_argument("--cheap", action="store_true", help="without SUMO; nine reports of ten tell no crash")
    parser.add_argument("--show", action="store_true", help="only the table of the looks in --place so far")
    asked = parser.parse_args(arguments)
    folder = asked.place or Path(tempfile.mkdtemp(prefix="sgcad-growth-"))
    looks = folder / "looks.csv"
    if not asked.show:
        place = Place(folder, stays=True)
        cases(folder / "cases", asked.cases, asked.cheap)
        for look in batch(place, asked.cases, asked.cheap):
            keep(looks, look)
    found = read_looks(looks)
    sys.stdout.write(f"{found[-1]['done']:.0f} cases done, {len(found)} looks in {looks}\n\n{table(found)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
