"""A training as one Prefect flow run: `python -m research.training.train` as a process, its log in MLflow every few
minutes.

Import after `settings.quiet_libraries()` and with a server named or none wanted (flows/server.py).
"""

from __future__ import annotations

from pathlib import Path

from prefect import flow
from prefect.settings import PREFECT_FLOWS_HEARTBEAT_FREQUENCY, temporary_settings

from research.training.training_log import EVERY_S, Training, Watched, options


@flow(name="train-mini", persist_result=False)
def train_flow(
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
    """The flow for a person who watches: no heartbeat, the trainer's failure as an exit code."""
    training = watched.training
    with temporary_settings({PREFECT_FLOWS_HEARTBEAT_FREQUENCY: None}):
        try:
            train_flow(
                str(training.folder), list(watched.arguments), str(training.database), training.uri, watched.every_s,
                watched.held_out,
            )  # fmt: skip
        except RuntimeError:
            return 1
    return 0
