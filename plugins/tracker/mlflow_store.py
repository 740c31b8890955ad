"""One MLflow experiment: its client, and the parent run of every arm with the runs of its cases.

Uses the client with explicit run ids (the fluent API's active run is thread-local and a re-entered parent would be
marked finished). A case has one run in each parent: logged again, it replaces the run before. Knows MLflow; no run
folder and no config.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import logging
import re
import sqlite3
import time
from collections.abc import Iterator, Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from plugins.tracker import mlflow_database
from plugins.tracker.mlflow_database import ELSEWHERE, database_lock, make_database
from sgcad_core import settings
from sgcad_core.errors import ConfigError
from sgcad_core.system.locks import lock_file

MAX_VALUE = 500
"""Limit of the characters of a parameter's value: MLflow's own is 6,000, a table shows far fewer."""
MAX_RUNS = 50
"""Runs that are read at a time."""
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
        self.parents: dict[str, Parent] = {}

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
            if self._file:
                make_database(self._file)
            client = mlflow.MlflowClient(tracking_uri=self.uri)
            client.get_experiment("0")
        except (OSError, SQLAlchemyError, mlflow.MlflowException) as fault:
            if self._file and isinstance(fault, OSError | SQLAlchemyError):
                mlflow_database.check_file(self._file)  # gives a clearer message if it finds the same fault
            place = self._file or _no_password(self.uri)
            if mlflow_database.is_full(fault):
                raise ConfigError(f"{place}: {mlflow_database.reason(fault)}; make room, {ELSEWHERE}") from fault
            raise ConfigError(
                f"{place}: cannot be used as MLflow's database ({_first_line(fault)}); move it away, {ELSEWHERE}"
            ) from fault
        return client

    def identity(self) -> str:
        """Number and creation time of the experiment, read without starting MLflow; empty if they cannot be read.

        A new database at the same place has another identity, so its cases do not count as logged already.
        """
        if not self._file or not self._file.is_file():
            return ""
        with (
            contextlib.suppress(sqlite3.Error),
            contextlib.closing(sqlite3.connect(self._file, timeout=mlflow_database.LOCKED_S)) as found,
        ):
            asked = "SELECT experiment_id, creation_time FROM experiments WHERE name = ?"
            row = found.execute(asked, (self.experiment,)).fetchone()
            return " ".join(map(str, row)) if row else ""
        return ""

    @property
    def _file(self) -> Path | None:
        return Path(self.uri.removeprefix("sqlite:///")) if self.uri.startswith("sqlite:///") else None

    @cached_property
    def experiment_id(self) -> str:
        """The experiment's id; artifacts beside a sqlite database are named by an absolute path."""
        import mlflow

        if found := self.client.get_experiment_by_name(self.experiment):
            return str(found.experiment_id)
        place = self.artifacts
        if self._file and not place:
            place = (self._file.parent / "mlflow-artifacts" / self.experiment).as_uri()
        try:
            return str(self.client.create_experiment(self.experiment, artifact_location=place or None))
        except mlflow.MlflowException:  # another process was faster
            found = self.client.get_experiment_by_name(self.experiment)
            if found is None:
                raise
            return str(found.experiment_id)

    # -------------------------------------------------------------- runs
    def parent(self, config: str, params: Mapping[str, str]) -> Parent:
        """The parent run of a config with these parameters; found again if a batch is resumed."""
        key = hashlib.sha256(json.dumps([config, params], sort_keys=True).encode()).hexdigest()[:16]
        if key not in self.parents:
            _ = self.experiment_id  # made before the lock is taken, which making a database takes as well
            with lock_file(database_lock(self._file)) if self._file else contextlib.nullcontext():
                self.parents[key] = Parent(self, self._found_or_made(config, key, params), config)
        return self.parents[key]

    def _found_or_made(self, config: str, key: str, params: Mapping[str, str]) -> str:
        """The oldest run of the key: of runs that several processes make at once, only the oldest stays."""
        if found := self.run_tagged(BATCH, key):
            return found
        tags = {BATCH: key, CONFIG: config, LEVEL: "config", **source_tags()}
        made = str(self.client.create_run(self.experiment_id, run_name=config, tags=tags).info.run_id)
        oldest = self.run_tagged(BATCH, key) or made
        if oldest != made:
            self.client.delete_run(made)
            return oldest
        self.log(made, {}, params)
        self.client.set_terminated(made)
        return made

    def run_tagged(self, tag: str, value: str) -> str | None:
        """The oldest run with a tag's value."""
        order = ["attributes.start_time ASC", "attributes.run_id ASC"]
        text = f"tags.`{tag}` = '{value}'"
        found = self.client.search_runs([self.experiment_id], text, max_results=1, order_by=order)
        return str(found[0].info.run_id) if found else None

    def log(self, run: str, steps: Mapping[int, Mapping[str, float]], params: Mapping[str, str] | None = None) -> None:
        """Logs figures by step and parameters; MLflow's client splits them into batches."""
        from mlflow.entities import Metric, Param

        now = int(time.time() * 1000)
        metrics = [Metric(plain(k), v, now, step) for step, figures in steps.items() for k, v in figures.items()]
        entries = [Param(plain(name), value[:MAX_VALUE]) for name, value in (params or {}).items()]
        if metrics or entries:
            self.client.log_batch(run, metrics=metrics, params=entries)

    def tag(self, run: str, tags: Mapping[str, str]) -> None:
        """Sets tags of a run."""
        from mlflow.entities import RunTag

        self.client.log_batch(run, tags=[RunTag(plain(name), value[: 10 * MAX_VALUE]) for name, value in tags.items()])

    def describe(self, note: str) -> None:
        """Sets the experiment's description and kind unless they are set already, possibly by a user.

        The kind makes MLflow open on runs and charts; because of the traces it would assume a chat application.
        """
        there = self.client.get_experiment(self.experiment_id).tags
        for tag, value in ((NOTE, note), (KIND, "custom_model_development")):
            if tag not in there:
                self.client.set_experiment_tag(self.experiment_id, tag, value)


class Parent:
    """The run of one arm: its cases' runs, and their means under the cases' own names."""

    def __init__(self, store: Store, run: str, name: str) -> None:
        self.store = store
        self.run = run
        self.name = name
        self.tags: dict[str, str] = {}
        self.next_update = 0.0
        self._monitor: Any = None
        self.started = store.client.get_run(run).info.start_time / 1000

    @cached_property
    def runs(self) -> dict[str, str]:
        """Run ids by case, including those of an earlier batch."""
        return {case: str(run.info.run_id) for case, run in self._newest()}

    def _newest(self) -> Iterator[tuple[str, Any]]:
        """The newest run of every case, with its name."""
        seen: set[str] = set()
        for run in self._children():
            if (case := run.data.tags.get(CASE, "")) not in seen:
                seen.add(case)
                yield case, run

    def _children(self) -> Iterator[Any]:
        """All runs of cases, newest first, a page in memory at a time."""
        where, order = f"tags.`{PARENT}` = '{self.run}'", ["attributes.start_time DESC"]
        token: str | None = ""
        while token is not None:
            page = self.store.client.search_runs(
                [self.store.experiment_id], where, max_results=MAX_RUNS, order_by=order, page_token=token or None
            )
            yield from page
            token = page.token or None

    def new_case(self, case: str, tags: Mapping[str, str], started_s: float) -> Any:
        """A new run of a case that began at a Unix time; deletes the case's run before, if any."""
        before = self.runs.get(case)
        about = {PARENT: self.run, LEVEL: "case", CASE: case, **source_tags(), **self.tags, **tags}
        client = self.store.client
        made = client.create_run(self.store.experiment_id, run_name=case, tags=about, start_time=int(started_s * 1000))
        if before:
            client.delete_run(before)
        self.runs[case] = str(made.info.run_id)
        return made

    def begin(self, about: Mapping[str, str], shared: Mapping[str, str], dataset: Mapping[str, str]) -> None:
        """Marks the run as running and logs its tags, those shared with the cases' runs, and the data set."""
        from mlflow.entities import Dataset, DatasetInput, InputTag

        client, self.tags = self.store.client, dict(shared)
        client.update_run(self.run, status="RUNNING")
        self.tag({**about, **shared})
        client.log_inputs(self.run, [DatasetInput(Dataset(**dataset), [InputTag("mlflow.data.context", "evaluation")])])

    def watch(self, interval_s: float) -> None:
        """Logs MLflow's own system metrics into the parent until `end`; 0: none."""
        if self._monitor is None and interval_s > 0:
            from mlflow.system_metrics.system_metrics_monitor import SystemMetricsMonitor

            self._monitor = SystemMetricsMonitor(
                self.run, sampling_interval=interval_s, resume_logging=True, tracking_uri=self.store.uri
            )
            self._monitor.start()

    def log_means(self, figures: Mapping[str, float]) -> None:
        """Logs the arm's present figures; the step is the seconds since the arm's first begin."""
        self.store.log(self.run, {max(0, int(time.time() - self.started)): figures})

    def figures(self) -> Iterator[dict[str, float]]:
        """Last figures of every case."""
        return (run.data.metrics for _, run in self._newest())

    def tag(self, tags: Mapping[str, str]) -> None:
        """Sets tags of the arm's run."""
        self.store.tag(self.run, tags)

    def end(self, status: str) -> None:
        """Stops the system metrics and sets the status: FINISHED, KILLED (interrupted) or FAILED (a fault)."""
        if self._monitor is not None:
            self._monitor.finish()
            self._monitor = None
        self.store.client.set_terminated(self.run, status)


def source_tags() -> dict[str, str]:
    """Tags that MLflow's pages show as a run's source."""
    return {"mlflow.source.name": "sgcad", "mlflow.source.type": "LOCAL"}


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
