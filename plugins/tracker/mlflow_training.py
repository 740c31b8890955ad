"""Training logs in MLflow: one run a training, one step a line.

A training run is identified by its log's first step line; a tag counts the lines that are logged. Times follow from the
log, so lines logged twice after an interruption are the same points, which MLflow keeps once.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from plugins.tracker.figures import numbers
from plugins.tracker.mlflow_store import LEVEL, MAX_VALUE, Store, plain, source_tags

LOG, LINES = "sgcad.log", "sgcad.lines"
"""Tags of a training run: the key of its log, and how many lines of it are logged."""


def log_training(store: Store, name: str, params: Mapping[str, str], lines: Sequence[Mapping[str, Any]]) -> int:
    """Logs the lines that the run does not have and returns how many; 0 if the log has no step yet."""
    first = next((line for line in lines if "step" in line), None)
    if first is None:
        return 0
    key = hashlib.sha256(json.dumps([name, first], sort_keys=True).encode()).hexdigest()[:16]
    run = store.run_tagged(LOG, key) or _made(store, name, key, lines)
    found = store.client.get_run(run)
    done = int(found.data.tags.get(LINES, 0))
    if done < len(lines):
        fresh = {k: v for k, v in params.items() if plain(k) not in found.data.params}
        store.log(run, {}, fresh)
        store.client.log_batch(run, metrics=list(_metrics(lines[done:], found.info.start_time)))
        for number, line in enumerate(lines[done:], done):
            if "event" in line:
                told = ", ".join(f"{k} {v}" for k, v in line.items() if k != "event")
                store.client.set_tag(run, f"event.{number}", f"{line['event']}: {told}"[:MAX_VALUE])
        store.client.set_tag(run, LINES, str(len(lines)))
        store.client.set_terminated(run)
    return max(0, len(lines) - done)


def _made(store: Store, name: str, key: str, lines: Sequence[Mapping[str, Any]]) -> str:
    """A new run that began by the log's own time: now less the seconds of its last line."""
    spent = max((float(line.get("seconds", 0.0)) for line in lines), default=0.0)
    tags = {LOG: key, LEVEL: "training", **source_tags()}
    started = int((time.time() - spent) * 1000)
    made = store.client.create_run(store.experiment_id, run_name=name, tags=tags, start_time=started)
    return str(made.info.run_id)


def _metrics(lines: Sequence[Mapping[str, Any]], began_ms: int) -> Iterator[Any]:
    from mlflow.entities import Metric

    for line in lines:
        if "step" in line:
            at = began_ms + int(float(line.get("seconds", 0.0)) * 1000)
            for name, value in numbers({k: v for k, v in line.items() if k != "step"}).items():
                yield Metric(plain(name), value, at, int(line["step"]))
