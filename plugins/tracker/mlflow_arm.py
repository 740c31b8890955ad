"""The run of an arm in MLflow: its cases' runs and their means, its config, the table of its cases, its prompts.

A case has one run in each arm: logged again, it replaces the run before. What an arm holds of its cases is read from
their runs, also those that other processes logged.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import time
from collections.abc import Iterable, Iterator, Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from plugins.tracker.figures import means
from plugins.tracker.headline import HEADLINE, arm_note, headline
from plugins.tracker.mlflow_database import database_lock
from plugins.tracker.mlflow_store import (
    BATCH,
    CASE,
    CONFIG,
    LEVEL,
    NOTE,
    PARENT,
    Store,
    repository,
    source_tags,
    trace_id,
)
from sgcad_core.system.locks import lock_file
from sgcad_core.system.temp_folders import temp_folder

MAX_RUNS = 50
"""Runs that are read at a time."""
OUTCOME = "sgcad.outcome"
"""Tag of a case's run: its end in words."""
TABLE, CONFIG_FILE = "cases.json", "config.yaml"
OF_TABLE = (*(name for name in HEADLINE if "/" in name or name == "collision_realised"), "seconds/total")
"""Figures in the table; those of the status stand there in words."""


def parent_of(store: Store, config: str, params: Mapping[str, str]) -> Parent:
    """The run of an arm, a config with these parameters; found again if a batch is resumed."""
    key = hashlib.sha256(json.dumps([config, params], sort_keys=True).encode()).hexdigest()[:16]
    return _parent(store, config, key, tuple(params.items()))


@cache
def _parent(store: Store, config: str, key: str, params: tuple[tuple[str, str], ...]) -> Parent:
    _ = store.experiment_id  # made before the lock is taken, which making a database takes as well
    with lock_file(database_lock(store.file)) if store.file else contextlib.nullcontext():
        return Parent(store, _found_or_made(store, config, key, dict(params)), config)


def _found_or_made(store: Store, config: str, key: str, params: Mapping[str, str]) -> str:
    """The oldest run of the key: of runs that several processes make at once, only the oldest stays."""
    if found := store.run_tagged(BATCH, key):
        return found
    tags = {BATCH: key, CONFIG: config, LEVEL: "config", **source_tags()}
    made = str(store.client.create_run(store.experiment_id, run_name=config, tags=tags).info.run_id)
    oldest = store.run_tagged(BATCH, key) or made
    if oldest != made:
        store.client.delete_run(made)
        return oldest
    store.log(made, {}, params)
    store.client.set_terminated(made)
    return made


class Parent:
    """The run of one arm: its cases' runs, and their means under the cases' own names."""

    def __init__(self, store: Store, run: str, name: str) -> None:
        self.store = store
        self.run = run
        self.name = name
        self.tags: dict[str, str] = {}
        self.next_update = 0.0
        self._monitor: Any = None
        found = store.client.get_run(run).info
        self.started, self.artifacts = found.start_time / 1000, found.artifact_uri

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
        """The runs of all cases, newest first, a page in memory at a time."""
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
            client.delete_traces(self.store.experiment_id, trace_ids=[trace_id(before)])
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

    def cases(self) -> Iterator[tuple[str, Any]]:
        """Name, and last figures, parameters and tags of every case."""
        return ((case, run.data) for case, run in self._newest())

    def tag(self, tags: Mapping[str, str]) -> None:
        """Sets tags of the arm's run."""
        self.store.tag(self.run, tags)

    def end(self, status: str) -> None:
        """Stops the system metrics and sets the status: FINISHED, KILLED (interrupted) or FAILED (a fault)."""
        if self._monitor is not None:
            self._monitor.finish()
            self._monitor = None
        self.store.client.set_terminated(self.run, status)


# ------------------------------------------------------------------ means and the table of cases
def update(parent: Parent, folder: Path | None) -> None:
    """Logs the means of all cases; with the config's folder, at the end, its config.yaml and the table of cases too."""
    rows: list[list[Any]] = []
    found = means(_collected(parent.cases(), rows))
    parent.log_means(headline(found) | found)  # MLflow's comparison opens on what was logged first
    told = {NOTE: arm_note(parent.name, found)}
    if folder is not None:
        _log_files(parent, rows, folder / CONFIG_FILE)
        told["mlflow.loggedArtifacts"] = json.dumps([{"path": TABLE, "type": "table"}])
    parent.tag(told)


def _collected(cases: Iterable[tuple[str, Any]], rows: list[list[Any]]) -> Iterator[dict[str, float]]:
    """The figures of every case; its row of the table is added to the rows."""
    for case, data in cases:
        tags, figures = data.tags, data.metrics
        told = [tags.get(name, "") for name in ("sgcad.status", "sgcad.account", OUTCOME)]
        rows.append([case, *told, *(figures.get(name) for name in OF_TABLE)])
        yield figures


def _log_files(parent: Parent, rows: Iterable[list[Any]], config: Path) -> None:
    table = {"columns": ["case", "status", "verdict", "outcome", *OF_TABLE], "data": sorted(rows)}
    place = repository(parent.artifacts, parent.store.uri)
    with temp_folder("table") as folder:
        file = folder / TABLE
        file.write_text(json.dumps(table, ensure_ascii=False), encoding="utf-8")
        place.log_artifact(str(file))
    if config.is_file():
        place.log_artifact(str(config))


# ------------------------------------------------------------------ prompts
def prompts(store: Store, texts: Mapping[str, str]) -> dict[str, str]:
    """The tag that links a run to its prompts, registered as a new version where the text is new; empty without any."""
    linked = [{"name": name, "version": _version(store.client, name, text)} for name, text in texts.items()]
    return {"mlflow.linkedPrompts": json.dumps(linked)} if linked else {}


def _version(client: Any, name: str, text: str) -> str:
    """The version of a prompt's text: the newest if that is its text, else a new one."""
    newest = client.load_prompt(f"prompts:/{name}@latest", allow_missing=True, cache_ttl_seconds=0)
    if newest is None or newest.template != text:
        newest = client.register_prompt(name, text, commit_message=f"configs/prompts/{name}.md")
    return str(newest.version)
