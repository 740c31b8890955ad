"""MLflow on sqlite: a parent run per config, a child run per case, a span per model call.

Uses the client with explicit run ids (the fluent API's active run is thread-local and a re-entered parent
would be marked finished). Knows the run folder and result.json; no plugin of another kind.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import logging
import re
import sqlite3
import time
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import Field, PrivateAttr

from plugins.tracker.figures import attempt_figures, case_figures, flat
from sgcad_core import settings
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Tracker
from sgcad_core.records import Generation, Query

MAX_VALUE = 500
"""Characters of a parameter's value: MLflow's own limit is 6,000, a table shows far fewer."""
MAX_BATCH = 1000
"""MLflow's limit of metrics a batch."""


class MlflowTracker(Tracker):
    """Logs to a sqlite database; look at it with `mlflow ui --backend-store-uri sqlite:///<database>`."""

    database: Path | None = Field(None, description="sqlite file; default: mlflow.db in the output folder")
    experiment: str = Field("sgcad", min_length=1)
    artifacts: bool = Field(True, description="copy every file of the case into the run")
    _stores: dict[Path, _Store] = PrivateAttr(default_factory=dict)
    _runs: dict[tuple[str, str], tuple[_Store, str]] = PrivateAttr(default_factory=dict)

    def log_case(self, config_name: str, params: dict[str, Any], case_dir: Path, result: dict[str, Any]) -> None:
        """One child run: parameters, attempts as steps, final figures, files. Raises ConfigError on a bad database."""
        store = self._store(case_dir.parent.parent)
        run = store.case_run(config_name, params, case_dir.name, result)
        self._runs[config_name, case_dir.name] = (store, run)
        store.log(run, params, case_dir, result)
        if self.artifacts:
            store.client.log_artifacts(run, str(case_dir))
        failed = result["status"] == "failed"
        store.client.set_terminated(run, "FAILED" if failed else "FINISHED")

    def log_generation(self, config_name: str, case: str, query: Query, generation: Generation) -> None:
        """One span in the case's run; call it after `log_case`."""
        if (config_name, case) in self._runs:
            store, run = self._runs[config_name, case]
            store.span(run, case, query, generation)

    def _store(self, out: Path) -> _Store:
        database = (self.database or out / "mlflow.db").resolve()
        if database not in self._stores:
            self._stores[database] = _Store(database, self.experiment)
        return self._stores[database]


class _Store:
    """One database: its client, experiment and parent runs."""

    def __init__(self, database: Path, experiment: str) -> None:
        self.database = database
        self.experiment = experiment
        self.parents: dict[str, str] = {}

    @cached_property
    def client(self) -> Any:
        """MlflowClient on the database, which is made if there is none."""
        settings.quiet_libraries()
        import mlflow
        from sqlalchemy import Engine, event
        from sqlalchemy.exc import SQLAlchemyError

        if not event.contains(Engine, "connect", _fast_commits):
            event.listen(Engine, "connect", _fast_commits)
        logging.getLogger("mlflow").setLevel(logging.WARNING)
        uri = f"sqlite:///{self.database}"
        try:
            self.database.parent.mkdir(parents=True, exist_ok=True)
            mlflow.set_tracking_uri(uri)
            client = mlflow.MlflowClient(tracking_uri=uri)
            client.get_experiment("0")
        except (OSError, SQLAlchemyError, mlflow.MlflowException) as fault:
            raise ConfigError(
                f"{self.database}: cannot be used as MLflow's database ({_first_line(fault)}); move it away, or set "
                "tracker.database=<file>, or tracker=jsonl"
            ) from fault
        return client

    @cached_property
    def experiment_id(self) -> str:
        """The experiment's id; artifacts lie beside the database, named by an absolute path."""
        import mlflow

        found = self.client.get_experiment_by_name(self.experiment)
        if found is not None:
            return str(found.experiment_id)
        place = (self.database.parent / "mlflow-artifacts" / self.experiment).as_uri()
        try:
            return str(self.client.create_experiment(self.experiment, artifact_location=place))
        except mlflow.MlflowException:  # another process was faster
            found = self.client.get_experiment_by_name(self.experiment)
            if found is None:
                raise
            return str(found.experiment_id)

    def case_run(self, config_name: str, params: dict[str, Any], case: str, result: dict[str, Any]) -> str:
        """A new child run; it starts when the case did."""
        tags = {
            "mlflow.parentRunId": self.parent(config_name, params),
            "sgcad.config": config_name,
            "sgcad.case": case,
            "sgcad.status": result["status"],
        }
        started = int((time.time() - sum((result.get("seconds") or {}).values())) * 1000)
        made = self.client.create_run(self.experiment_id, run_name=case, tags=tags, start_time=started)
        return str(made.info.run_id)

    def parent(self, config_name: str, params: dict[str, Any]) -> str:
        """The parent run of a config with these parameters; found again when a batch is resumed."""
        digest = hashlib.sha256(json.dumps(params, sort_keys=True, default=str).encode()).hexdigest()[:16]
        key = f"{config_name}-{digest}"
        if key not in self.parents:
            found = self.client.search_runs([self.experiment_id], f"tags.`sgcad.batch` = '{key}'", max_results=1)
            self.parents[key] = found[0].info.run_id if found else self._new_parent(config_name, params, key)
        return self.parents[key]

    def _new_parent(self, config_name: str, params: dict[str, Any], key: str) -> str:
        tags = {"sgcad.batch": key, "sgcad.config": config_name}
        run = str(self.client.create_run(self.experiment_id, run_name=config_name, tags=tags).info.run_id)
        self.client.log_batch(run, params=_params(params))
        self.client.set_terminated(run)
        return run

    def log(self, run: str, params: dict[str, Any], case_dir: Path, result: dict[str, Any]) -> None:
        """Parameters, attempts as steps and final figures, in as few transactions as MLflow allows."""
        from mlflow.entities import Metric

        now = int(time.time() * 1000)
        metrics = [Metric(_plain(name), value, now, 0) for name, value in case_figures(case_dir, result).items()]
        for step, figures in attempt_figures(case_dir):
            metrics += [Metric(_plain(f"attempt_{name}"), value, now, step) for name, value in figures.items()]
        self.client.log_batch(run, metrics=metrics[:MAX_BATCH], params=_params(params))
        for start in range(MAX_BATCH, len(metrics), MAX_BATCH):
            self.client.log_batch(run, metrics=metrics[start : start + MAX_BATCH])

    def span(self, run: str, case: str, query: Query, generation: Generation) -> None:
        """One model call as a trace that points to its run, as long as the call took."""
        import mlflow

        end = time.time_ns()
        span = mlflow.start_span_no_context(
            f"{case}[{query.attempt}]",
            span_type="LLM",
            inputs={"task": query.task, "passages": [p.id for p in query.passages], "repair": query.repair},
            attributes={"attempt": query.attempt, "finish": generation.finish, **_call_figures(generation)},
            metadata={"mlflow.sourceRun": run},
            experiment_id=self.experiment_id,
            start_time_ns=end - int(generation.seconds * 1e9),
        )
        span.end(outputs={"text": generation.text, "grounding": dict(generation.grounding)}, end_time_ns=end)


def _fast_commits(connection: Any, record: Any) -> None:
    """One write a commit instead of two flushes of the disk: 7 commits a case are 10 to 100 ms otherwise.

    With a write-ahead log, "normal" loses at most the last commits to a power cut and never corrupts.
    """
    if not isinstance(connection, sqlite3.Connection):
        return
    with contextlib.suppress(sqlite3.DatabaseError):  # no database: MLflow says so, here it would try for minutes
        mode = connection.execute("PRAGMA journal_mode=WAL").fetchone()
        if mode and str(mode[0]).lower() == "wal":
            connection.execute("PRAGMA synchronous=NORMAL")


def _call_figures(generation: Generation) -> dict[str, Any]:
    return {
        "prompt_tokens": generation.prompt_tokens,
        "answer_tokens": len(generation.tokens),
        "model_calls": generation.model_calls,
        "seconds": generation.seconds,
    }


def _params(params: dict[str, Any]) -> list[Any]:
    from mlflow.entities import Param

    return [Param(_plain(name), str(value)[:MAX_VALUE]) for name, value in list(flat(params))[:100]]


def _plain(name: str) -> str:
    """A name as MLflow takes it: at most 250 letters, digits, "_", "-", "."."""
    return re.sub(r"[^\w.-]", "_", name, flags=re.ASCII).strip(".")[:250] or "_"


def _first_line(fault: Exception) -> str:
    return (str(fault).strip().splitlines() or [type(fault).__name__])[0][:200]
