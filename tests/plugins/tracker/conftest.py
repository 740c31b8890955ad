"""One output folder with an MLflow database, which takes seconds to make, and an experiment for each test."""

import json
import os
from itertools import count

import pytest

from plugins.tracker import mlflow_arm
from plugins.tracker.mlflow import MlflowTracker
from plugins.tracker.mlflow_store import store_of

numbers = count()


@pytest.fixture(scope="session")
def out(tmp_path_factory):
    """One output folder with cases c1 to c4; making its database costs seconds, so it is shared."""
    folder = tmp_path_factory.mktemp("out")
    for case in ("c1", "c2", "c3", "c4"):
        for number, findings in ((1, 2), (2, 0)):
            place = folder / "kit" / case / "attempts" / f"road-{number:02d}"
            place.mkdir(parents=True)
            (place / "findings.json").write_text(json.dumps([{"severity": "repair"}] * findings))
            (place / "attempt.json").write_text(json.dumps({"number": number, "seconds": 0.5 * number}))
        (folder / "kit" / case / "player.html").write_text("<html>")
    return folder


@pytest.fixture
def tracker(out):
    """Makes trackers of an experiment of the test's own, each as a process of its own would have it."""
    experiment = f"study/test-{os.getpid()}-{next(numbers)}"

    def make(**fields):
        store_of.cache_clear()
        mlflow_arm._parent.cache_clear()
        return MlflowTracker(
            **{"database": out / "mlflow.db", "experiment": experiment, "system_metrics_s": 0, **fields}
        )

    return make
