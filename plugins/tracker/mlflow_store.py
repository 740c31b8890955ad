"""One MLflow experiment: its client, its number, and what is logged to a run of a known number.

Uses the client with explicit run ids (the fluent API's active run is thread-local and a re-entered parent would be
marked finished). Knows MLflow; no run folder and no config.
"""

from __future__ import annotations

import contextlib
import logging
import re
import sqlite3
import time
from collections.abc import Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from plugins.tracker import mlflow_database
from plugins.tracker.mlflow_database import ELSEWHERE, make_database
from sgcad_core import settings
from sgcad_core.errors import ConfigError

MAX_VALUE = 500
"""Limit of the characters of a parameter's value: MLflow's own is 6,000, a table shows far fewer."""
LEVEL, CASE, CONFIG, BATCH, PARENT = "sgcad.level", "sgcad.case", "sgcad.config", "sgcad.batch", "mlflow.parentRunId"
"""Tags that runs are found by; MLflow's pages nest runs by the last one."""

NOTE, KIND = "mlflow.note.content", "mlflow.experimentKind"
"""MLflow's tags for the description of a run or an experiment, in markdown, and for the kind of an experiment."""


@cache
def store_of(uri: str, experiment: str, artifacts: str) -> Store:
    """The experiment's store, shared by all arms of a study in this process."""
    return Store(uri, experiment, artifacts)


class Store:
    """One experiment behind one address: sqlite:///<file>, postgresql://..., http://...

    `artifacts` is the address of the files; empty: beside a sqlite file, else the server's own place.
    """

    def __init__(self, uri: str, experiment: str, artifacts: str = "") -> None:
        self.uri = uri
        self.experiment = experiment
        self.artifacts = artifacts

    @cached_property
    def client(self) -> Any:
        """MlflowClient on the address; a sqlite file is made if there is none. Raises ConfigError."""
        settings.quiet_libraries()
        import mlflow
        from sqlalchemy import Engine, event
        from sqlalchemy.exc import SQLAlchemyError

        if not event.contains(Engine, "connect", _fast_commits):
            event.listen(Engine, "connect", _fast_commits)
        logging.getLogger("mlflow").setLevel(logging.WARNING)
        logging.getLogger("mlflow.system_metrics").setLevel(logging.ERROR)  # statements of a database that is locked
        logging.getLogger("mlflow.store.db.utils").setLevel(logging.CRITICAL)  # tracebacks of what it raises anyway
        try:
            if self.file:
                make_database(self.file)
            client = mlflow.MlflowClient(tracking_uri=self.uri)
            client.get_experiment("0")
        except (OSError, SQLAlchemyError, mlflow.MlflowException) as fault:
            if self.file and isinstance(fault, OSError | SQLAlchemyError):
                mlflow_database.check_file(self.file)  # gives a clearer message if it finds the same fault
            place = self.file or _no_password(self.uri)
            if mlflow_database.is_full(fault):
                raise ConfigError(f"{place}: {mlflow_database.reason(fault)}; make room, {ELSEWHERE}") from fault
            raise ConfigError(
                f"{place}: cannot be used as MLflow's database ({_first_line(fault)}); move it away, {ELSEWHERE}"
            ) from fault
        return client

    @cached_property
    def tracing(self) -> Any:
        """MLflow's client for traces, which takes finished spans."""
        _ = self.client
        from mlflow.tracing.client import TracingClient

        return TracingClient(self.uri)

    def check_file(self) -> None:
        """Raises FileNotFoundError where the database is no longer at its place: what is written goes into a file that
        was moved or deleted."""
        if self.file and not self.file.is_file():
            raise FileNotFoundError(
                f"{self.file} was moved or deleted meanwhile; the next command logs the cases again"
            )

    def identity(self) -> str:
        """Number and creation time of the experiment, read without starting MLflow; empty if they cannot be read.

        A new database at the same place has another identity, so its cases do not count as logged already.
        """
        if not self.file or not self.file.is_file():
            return ""
        with (
            contextlib.suppress(sqlite3.Error),
            contextlib.closing(sqlite3.connect(self.file, timeout=mlflow_database.LOCKED_S)) as found,
        ):
            asked = "SELECT experiment_id, creation_time FROM experiments WHERE name = ?"
            row = found.execute(asked, (self.experiment,)).fetchone()
            return " ".join(map(str, row)) if row else ""
        return ""

    @property
    def file(self) -> Path | None:
        """The sqlite file behind the address; None for a server."""
        return Path(self.uri.removeprefix("sqlite:///")) if self.uri.startswith("sqlite:///") else None

    @cached_property
    def experiment_id(self) -> str:
        """The experiment's id; artifacts beside a sqlite database are named by an absolute path."""
        import mlflow

        if found := self.client.get_experiment_by_name(self.experiment):
            return str(found.experiment_id)
        place = self.artifacts
        if self.file and not place:
            place = (self.file.parent / "mlflow-artifacts" / self.experiment).as_uri()
        try:
            return str(self.client.create_experiment(self.experiment, artifact_location=place or None))
        except mlflow.MlflowException:  # another process was faster
            found = self.client.get_experiment_by_name(self.experiment)
            if found is None:
                raise
            return str(found.experiment_id)

    # -------------------------------------------------------------- runs
    @property
    def runs_page(self) -> str:
        """The list of runs; without the query MLflow 3.17 opens an experiment on charts of its traces."""
        return f"#/experiments/{self.experiment_id}/runs?workflowType=machine_learning"

    def run_tagged(self, tag: str, value: str) -> str | None:
        """The oldest run with a tag's value."""
        order = ["attributes.start_time ASC", "attributes.run_id ASC"]
        text = f"tags.`{tag}` = '{value}'"
        found = self.client.search_runs([self.experiment_id], text, max_results=1, order_by=order)
        return str(found[0].info.run_id) if found else None

    def log(
        self,
        run: str,
        steps: Mapping[int, Mapping[str, float]],
        params: Mapping[str, str] | None = None,
        tags: Mapping[str, str] | None = None,
    ) -> None:
        """Logs figures by step, parameters and tags; MLflow's client splits them into batches."""
        from mlflow.entities import Metric, Param, RunTag

        now = int(time.time() * 1000)
        metrics = [Metric(plain(k), v, now, step) for step, figures in steps.items() for k, v in figures.items()]
        entries = [Param(plain(name), value[:MAX_VALUE]) for name, value in (params or {}).items()]
        told = [RunTag(plain(name), value[: 10 * MAX_VALUE]) for name, value in (tags or {}).items()]
        if metrics or entries or told:
            self.client.log_batch(run, metrics=metrics, params=entries, tags=told)

    def tag(self, run: str, tags: Mapping[str, str]) -> None:
        """Sets tags of a run."""
        self.log(run, {}, tags=tags)

    def describe(self, note: str) -> None:
        """Sets the experiment's description and kind unless they are set already, possibly by a user.

        MLflow 3.17 shows the kind only; which page it opens on, the browser remembers (docs/mlflow.md).
        """
        there = self.client.get_experiment(self.experiment_id).tags
        for tag, value in ((NOTE, note), (KIND, "custom_model_development")):
            if tag not in there:
                self.client.set_experiment_tag(self.experiment_id, tag, value)


def source_tags() -> dict[str, str]:
    """Tags that MLflow's pages show as a run's source."""
    return {"mlflow.source.name": "sgcad", "mlflow.source.type": "LOCAL"}


def trace_id(run: str) -> str:
    """The trace of a case's run: it has the run's number, so that it is found and deleted without a search."""
    return f"tr-{run}"


def repository(address: str, uri: str) -> Any:
    """The store of a run's files; the client's own method would read the whole run again."""
    from mlflow.store.artifact.artifact_repository_registry import get_artifact_repository

    return get_artifact_repository(address, tracking_uri=uri)


def plain(name: str) -> str:
    """A name that MLflow accepts: at most 250 letters, digits, "_", "-", ".", "/"."""
    return re.sub(r"[^\w./-]", "_", name, flags=re.ASCII).strip("./")[:250] or "_"


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


def _no_password(uri: str) -> str:
    return re.sub(r"//[^/@]*@", "//", uri)


def _first_line(fault: Exception) -> str:
    return (str(fault).strip().splitlines() or [type(fault).__name__])[0][:200]
