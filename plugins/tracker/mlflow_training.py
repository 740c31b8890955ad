"""A training log (JSON lines) as one MLflow run: a step a line. Knows no trainer: any line with a "step" counts.

A run is known by its log's first step line, so a log that is begun anew is another run. What is there already is
known by a count in a tag; times follow from the log itself, so that lines written twice after a kill are the same
points, which MLflow keeps once.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from plugins.tracker.figures import numbers
from plugins.tracker.mlflow_store import LEVEL, MAX_METRICS, MAX_PARAMS, MAX_VALUE, Store, plain, source_tags

LOG, LINES = "sgcad.log", "sgcad.lines"


def log_training(store: Store, name: str, params: Mapping[str, str], lines: Sequence[Mapping[str, Any]]) -> int:
    """Log the lines that the run does not have; how many. 0 where the log has no step yet."""
    first = next((line for line in lines if "step" in line), None)
    if first is None:
        return 0
    key = hashlib.sha256(json.dumps([name, first], sort_keys=True).encode()).hexdigest()[:16]
    run = store.run_tagged(LOG, key) or _made(store, name, key, lines)
    found = store.client.get_run(run)
    done = int(found.data.tags.get(LINES, 0))
    if done < len(lines):
        fresh = {k: v for k, v in params.items() if plain(k) not in found.data.params}
        _log(store, run, fresh, list(lines[done:]), found.info.start_time)
        for number, line in enumerate(lines[done:], done):
            if "event" in line:
                told = ", ".join(f"{k} {v}" for k, v in line.items() if k != "event")
                store.client.set_tag(run, f"event.{number}", f"{line['event']}: {told}"[:MAX_VALUE])
        store.client.set_tag(run, LINES, str(len(lines)))
        store.client.set_terminated(run)
    return max(0, len(lines) - done)


def _made(store: Store, name: str, key: str, lines: Sequence[Mapping[str, Any]]) -> str:
    """A run that began when its log says: now less the seconds of its last line."""
    spent = max((float(line.get("seconds", 0.0)) for line in lines), default=0.0)
    tags = {LOG: key, LEVEL: "training", **source_tags()}
    started = int((time.time() - spent) * 1000)
    made = store.client.create_run(store.experiment_id, run_name=name, tags=tags, start_time=started)
    return str(made.info.run_id)


def _log(store: Store, run: str, params: Mapping[str, str], lines: Sequence[Mapping[str, Any]], began_ms: int) -> None:
    from mlflow.entities import Param

    metrics = list(_metrics(lines, began_ms))
    entries = [Param(plain(name), value[:MAX_VALUE]) for name, value in params.items()][:MAX_PARAMS]
    room = MAX_METRICS - MAX_PARAMS
    for start in range(0, max(1, len(metrics)), room):
        store.client.log_batch(run, metrics=metrics[start : start + room], params=entries if start == 0 else ())


def _metrics(lines: Sequence[Mapping[str, Any]], began_ms: int) -> Iterator[Any]:
    from mlflow.entities import Metric

    for line in lines:
        if "step" in line:
            at = began_ms + int(float(line.get("seconds", 0.0)) * 1000)
            for name, value in numbers({k: v for k, v in line.items() if k != "step"}).items():
                yield Metric(plain(name), value, at, int(line["step"]))
