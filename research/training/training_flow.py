"""Training logs where they can be compared, and a training followed as one Prefect flow run.

    python -m research.training.training_flow import runs/mini                    # its log.jsonl so far; again \
        later: new lines only
    python -m research.training.training_flow train runs/mini -- --budget 3600    # python -m \
        research.training.train as a Prefect flow run

Knows the trainer as a program that leaves `log.jsonl` and `export/` in a folder, and trackers through the registry;
imports neither the trainer nor MLflow, and Prefect only once a server is named (flows/server.py).
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path
from typing import Any, cast

from sgcad_core import settings
from sgcad_core.errors import BadInput, SgcadError
from sgcad_core.interfaces import Tracker
from sgcad_core.registry import plugin_class
from sgcad_core.system.temp_folders import temp_folder

LOG, EXPORT = "log.jsonl", "export"
EXPERIMENT = "mini"
EVERY_S = 120.0
TRAINER, EVALUATOR = ("-m", "research.training.train"), ("-m", "research.training.evaluate")


@dataclass(frozen=True)
class Training:
    """One training's folder, and where its figures go: a sqlite file or, if given, an address (http://...)."""

    folder: Path
    database: Path = Path("runs/mlflow.db")
    uri: str = ""
    params: Mapping[str, str] = field(default_factory=dict)

    def lines(self) -> list[dict[str, Any]]:
        """The log so far, without a last line that is still being written. Raises BadInput."""
        file = self.folder / LOG
        try:
            whole = file.read_text(encoding="utf-8").split("\n")[:-1]
        except OSError as fault:
            raise BadInput(f"{file}: cannot be read ({fault.strerror}); give a training's folder") from fault
        return [self._line(number, text) for number, text in enumerate(whole, 1) if text.strip()]

    def _line(self, number: int, text: str) -> dict[str, Any]:
        try:
            line = json.loads(text)
        except ValueError as fault:
            raise BadInput(f"{self.folder / LOG}: line {number} is no JSON ({fault}); remove that line") from fault
        if not isinstance(line, dict):
            raise BadInput(f"{self.folder / LOG}: line {number} is no object; remove that line")
        return line

    def log(self) -> int:
        """Tell MLflow what is new; how many lines. Raises BadInput, ConfigError."""
        settings.quiet_libraries()
        name = self.folder.resolve().name
        return self._tracker.log_training(name, dict(self.params), self.lines())

    @property
    def _tracker(self) -> Tracker:
        fields = {"database": self.database.resolve(), "uri": self.uri, "experiment": EXPERIMENT}
        return cast("Tracker", plugin_class("tracker", "mlflow")(**fields))

    # -------------------------------------------------------------- held-out figures
    def judge(self, count: int) -> dict[str, float]:
        """Free-running figures of the export on held-out phrasings, appended to the log at its last step.

        Empty where there is no export yet, or the evaluation did not end well (one that is just being written).
        """
        last = next((line for line in reversed(self.lines()) if "step" in line), None)
        if last is None or not (self.folder / EXPORT).is_dir():
            return {}
        with temp_folder("judge") as place:
            found = place / "figures.json"
            command = [
                sys.executable,
                *EVALUATOR,
                str(self.folder / EXPORT),
                "--count",
                str(count),
                "--json",
                str(found),
            ]
            done = subprocess.run(command, cwd=settings.ROOT, stdout=subprocess.DEVNULL, check=False)  # noqa: S603 - ours
            if done.returncode or not found.is_file():
                return {}
            figures = held_out(json.loads(found.read_text(encoding="utf-8")))
        line = {"step": last["step"], "seconds": last.get("seconds", 0.0), **figures}
        with (self.folder / LOG).open("a", encoding="utf-8") as log:
            log.write(json.dumps(line) + "\n")
        return figures


def held_out(figures: Mapping[str, Any]) -> dict[str, float]:
    """research.training.evaluate's figures by name: {"held_out_text_ALL": share right, "held_out_refusals_recall":
    ...}."""
    found = {}
    for source, by in figures.items():
        for name, value in by.items():
            found[f"held_out_{source}_{name}"] = float(value[0] if isinstance(value, list) else value)
    return found


# ------------------------------------------------------------------ following a trainer
@dataclass(frozen=True)
class Watched:
    """A trainer to start: its own arguments, how often to look (s), on how many held-out reports to judge (0: none)."""

    training: Training
    arguments: tuple[str, ...] = ()
    every_s: float = EVERY_S
    held_out: int = 0

    def run(self) -> int:
        """Train to the end, logging on the way; the trainer's exit code. An interruption ends the trainer too."""
        self.training.folder.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, *TRAINER, "--out", str(self.training.folder.resolve()), *self.arguments]
        trainer = subprocess.Popen(command, cwd=settings.ROOT)  # noqa: S603 - our own module
        try:
            while True:
                try:
                    code = trainer.wait(self.every_s)
                except subprocess.TimeoutExpired:
                    self._look()
                else:
                    self._look()
                    return code
        finally:
            if trainer.poll() is None:
                trainer.terminate()
                trainer.wait()

    def _look(self) -> None:
        if (self.training.folder / LOG).is_file():
            if self.held_out:
                self.training.judge(self.held_out)
            self.training.log()


def options(arguments: Sequence[str]) -> dict[str, str]:
    """A trainer's arguments as parameters: --max-steps 2 is {"max_steps": "2"}."""
    named: dict[str, str] = {}
    for key, value in zip_longest(arguments, arguments[1:], fillvalue=""):
        if key.startswith("--"):
            name, equals, inline = key[2:].partition("=")
            named[name.replace("-", "_")] = inline if equals else "true" if value.startswith("--") else value or "true"
    return named


# ------------------------------------------------------------------ as a flow
def train(
    folder: str = "runs/mini",
    arguments: list[str] | None = None,
    database: str = "runs/mlflow.db",
    uri: str = "",
    every_s: float = EVERY_S,
    held_out: int = 0,
) -> int:
    """Train in a folder, going on where it stopped; the last step. Raises RuntimeError if the trainer fails."""
    given = tuple(arguments or ())
    training = Training(Path(folder), Path(database), uri, options(given))
    code = Watched(training, given, every_s, held_out).run()
    if code:
        raise RuntimeError(
            f"research.training.train ended with code {code}; its messages stand above, its log in {folder}"
        )
    return max((int(line["step"]) for line in training.lines() if "step" in line), default=0)


def run_flow(watched: Watched) -> int:
    """`train` as a flow run on a server, without heartbeat; the trainer's failure as an exit code."""
    settings.quiet_libraries()
    from flows.server import prefect_server

    with prefect_server() as server:
        from prefect import flow
        from prefect.settings import PREFECT_FLOWS_HEARTBEAT_FREQUENCY, temporary_settings

        if server:
            server.wait()
        training = watched.training
        with temporary_settings({PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None}):
            try:
                flow(name="train-mini", persist_result=False)(train)(
                    str(training.folder), list(watched.arguments), str(training.database), training.uri,
                    watched.every_s, watched.held_out,
                )  # fmt: skip
            except RuntimeError:
                return 1
    return 0


# ------------------------------------------------------------------ command line
def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m research.training.training_flow", description=__doc__)
    parser.add_argument("action", choices=("import", "train"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--database", type=Path, default=Path("runs/mlflow.db"))
    parser.add_argument("--uri", default="", help="an MLflow server instead of the sqlite file")
    parser.add_argument("--every", type=float, default=EVERY_S, help="seconds between looks at the log")
    parser.add_argument("--held-out", type=int, default=0, help="reports to judge the export on at every look")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point; what stands behind "--" is the trainer's."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    cut = given.index("--") if "--" in given else len(given)
    asked, own = _parser().parse_args(given[:cut]), tuple(given[cut + 1 :])
    training = Training(asked.folder, asked.database, asked.uri, options(own))
    try:
        if asked.action == "train":
            return run_flow(Watched(training, own, asked.every, asked.held_out))
        sys.stdout.write(f"{training.log()} new lines of {asked.folder / LOG}\n")
    except SgcadError as fault:
        sys.stderr.write(f"{fault}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
