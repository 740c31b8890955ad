"""What is killed: commands on small inputs, and how their results are compared with an undisturbed run's."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import yaml

from research.benchmarks.faults import alike
from sgcad_core import settings
from sgcad_core.revision import read_edits

TEXT = (
    "The crash occurred on a {lanes}-lane, undivided road with a speed limit of {limit} mph, in daylight. Vehicle #1, "
    "a passenger car, was traveling {way} behind Vehicle #2. Vehicle #2 was stopped. Vehicle #1 struck the back of "
    "Vehicle #2 with its front. This is report {number}.\n"
)
CASES = 4
STEPS = 8
"""Of the training."""
STUDY = {
    "title": "Faults",
    "reference": "three",
    "arms": [
        {"name": "three", "config": "template.yaml", "set": ["max_attempts=3"]},
        {"name": "two", "config": "template.yaml", "set": ["max_attempts=2"]},
    ],
}


@dataclass(frozen=True)
class Target:
    """One command, as arguments of Python. `faults`: what is wrong with a place's results, given undisturbed ones."""

    name: str
    prepare: Callable[[Path], None]
    command: Callable[[Path], list[str]]
    faults: Callable[[Path, Path], list[str]]
    out: str = "out"
    """Folder of its results, for `sgcad doctor`."""
    ends: tuple[int, ...] = (0,)
    """Exit codes of a run that went well."""


def reports(folder: Path, count: int = CASES) -> None:
    """Case folders of small reports, every one with its own road."""
    for number in range(count):
        (case := folder / f"report-{number:05d}").mkdir(parents=True)
        (case / "report.txt").write_text(_text(number), encoding="utf-8")


def _case_folders() -> list[str]:
    return [f"cases/report-{number:05d}" for number in range(CASES)]


def _text(number: int) -> str:
    way = ("north", "east", "south", "west")[number % 4]
    return TEXT.format(lanes=("two", "four")[number % 2], limit=25 + 5 * (number % 8), way=way, number=number)


# ------------------------------------------------------------------ evaluate, study
def _sgcad(*arguments: str) -> list[str]:
    return ["-c", "from flows.cli import main; main()", *arguments]


def _results(folder: str, configs: tuple[str, ...]) -> Callable[[Path, Path], list[str]]:
    def faults(ours: Path, theirs: Path) -> list[str]:
        told = [f for c in configs for f in alike.differences(ours, theirs, Path("out", folder, c))]
        told += [f for c in configs for f in alike.unlinked(ours / "out" / folder / c)]
        return told + alike.unlogged(ours / "out" / "mlflow.db", dict.fromkeys(configs, CASES))

    return faults


def _study(folder: Path) -> None:
    reports(folder / "cases")
    (folder / "faults.yaml").write_text(yaml.safe_dump(STUDY), encoding="utf-8")


# ------------------------------------------------------------------ inbox
def _inbox(folder: Path) -> None:
    (inbox := folder / "inbox").mkdir()
    for number in range(CASES):
        (inbox / f"report-{number:05d}.txt").write_text(_text(number), encoding="utf-8")
    raw = yaml.safe_load((settings.CONFIGS / "template.yaml").read_text(encoding="utf-8"))
    (folder / "inbox.yaml").write_text(yaml.safe_dump(raw | {"tracker": {"name": "jsonl"}}), encoding="utf-8")


def _inbox_faults(ours: Path, theirs: Path) -> list[str]:
    told = alike.differences(ours, theirs, Path("out", "inbox"))
    done = len(list((ours / "inbox" / "done").glob("*/*.txt")))
    left = [p.name for p in (ours / "inbox").glob("*.txt")]
    tries = [p.name for p in (ours / "inbox" / ".inbox" / "tries").glob("*")]
    told += [f"{done} of {CASES} reports under done/"] if done != CASES else []
    return told + [f"{len(left)} reports and {len(tries)} tries left"] * bool(left or tries)


# ------------------------------------------------------------------ revise, play
EDIT = "roads.N.lanes_forward=2"
KEPT = ("result.json", "specs.json", "road.net.xml", "road.xodr", "scenario.xosc", "trajectories.csv", "metrics.json")


def finished_case(folder: Path) -> None:
    """A finished case in `out/template/c`, its report in `cases/c`."""
    from flows.batch import config_folder
    from flows.case.run_case import run_case
    from flows.case_files.find_cases import Case, digest_of
    from sgcad_core.config import load

    shutil.copytree(settings.ROOT / "docs" / "demo" / "left-turn-at-signal", folder / "cases" / "c")
    config, case = load(settings.CONFIGS / "template.yaml", ("tracker=none",)), Case(folder / "cases" / "c", "c")
    config_folder.write(folder / "out" / config.name, config)
    run_case(config, case, folder / "out", digest_of(case, config))


def revision(folder: Path) -> list[str]:
    """The command that changes a fact of it."""
    return _sgcad("revise", "out/template/c", "--set", EDIT, "--who", "ann", "--why", "seen")


def revision_faults(ours: Path, theirs: Path) -> list[str]:
    """What is wrong with facts and results of a changed case."""
    told = [f"{name} differs" for name in KEPT if not alike.same_file(ours, theirs, Path("out", "template", "c", name))]
    edits = [(e.field, e.value) for e in read_edits(ours / "cases" / "c" / "facts.yaml")]
    told += [] if edits == [("roads.N.lanes_forward", 2)] else [f"facts.yaml holds {edits}"]
    lying = [f.name for f in (ours / "cases" / "c").iterdir() if f.suffix in (".journal", ".lock")]
    return told + [f"{name} lies beside the report" for name in lying]


def _scenario(folder: Path) -> None:
    from research.benchmarks.fuzz.making import example

    folder.mkdir(parents=True, exist_ok=True)
    for name, text in zip(("road.xodr", "scenario.xosc"), example()[2:4], strict=True):
        (folder / name).write_text(text, encoding="utf-8")


def _played_faults(ours: Path, theirs: Path) -> list[str]:
    return alike.differences(ours, theirs, "played")


# ------------------------------------------------------------------ all
def _nothing(folder: Path) -> None:
    """The command brings its own input."""


def _index_faults(ours: Path, theirs: Path) -> list[str]:
    beside = [p.name for p in ours.iterdir() if "-partial-" in p.name]
    return alike.same(alike.index_rows, ours / "knowledge", theirs / "knowledge") + [f"{b} is left" for b in beside]


def _training_faults(ours: Path, theirs: Path) -> list[str]:
    return alike.same(alike.weights, ours / "training", theirs / "training")


def _training(folder: Path) -> list[str]:
    small = ["--size", "tiny", "--workers", "1", "--ranks", "1", "--texts", "100", "--tokens", "1500"]
    steps = ["--total-steps", str(STEPS), "--max-steps", str(STEPS), "--budget", "1000", "--stage", "all"]
    return ["-m", "research.training.train", "--out", "training", *small, *steps, "--save-every", "0"]


TARGETS = {
    t.name: t
    for t in (
        Target(
            "evaluate",
            lambda folder: reports(folder / "cases"),
            lambda folder: _sgcad("evaluate", "cases", "--config", "template", "--out", "out"),
            _results("", ("template",)),
        ),
        Target(
            "study",
            _study,
            lambda folder: _sgcad("study", "faults.yaml", "--cases", "cases", "--out", "out"),
            _results("studies/faults", ("three", "two")),
        ),
        Target(
            "inbox",
            _inbox,
            lambda folder: [
                "-m", "flows.deploy.inbox.inbox", "inbox", "--config", "inbox.yaml", "--out", "out", "--settle-s", "0",
            ],
            _inbox_faults,
        ),
        Target(
            "run",
            lambda folder: reports(folder / "cases"),
            lambda folder: _sgcad("run", *_case_folders(), "--config", "template", "--out", "out"),
            _results("", ("template",)),
        ),
        Target("revise", finished_case, revision, revision_faults),
        Target("play", _scenario, lambda folder: _sgcad("play", "scenario.xosc", "--out", "played"), _played_faults),
        Target("index", _nothing, lambda folder: _sgcad("index", "build", "--out", "knowledge"), _index_faults),
        Target("training", _nothing, _training, _training_faults),
    )
}  # fmt: skip
