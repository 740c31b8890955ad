"""MLflow: a parent run for each arm, a child run and a trace for each case, the prompts, and training logs.

Knows the folder of a config and its cases; no plugin of another kind. docs/mlflow.md lists the names.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import Field, PrivateAttr

from plugins.tracker import mlflow_arm, mlflow_database
from plugins.tracker.case_spans import spans_of
from plugins.tracker.figures import attempt_figures, case_figures, case_parameters, parameters
from plugins.tracker.headline import case_note, experiment_note, in_words, prefect_links
from plugins.tracker.mlflow_arm import Parent, parent_of
from plugins.tracker.mlflow_store import CONFIG, NOTE, Store, repository, store_of
from plugins.tracker.mlflow_trace import log_trace
from plugins.tracker.mlflow_training import log_training
from sgcad_core.case.tracker_arm import Arm
from sgcad_core.case.verdict_told import verdict_sentence
from sgcad_core.interfaces import Tracker

UPDATE_S, UPDATE_SHARE = 10.0, 0.02
"""Means are updated at most this often, and in at most this share of the time."""


class MlflowTracker(Tracker):
    """Logs to MLflow: a sqlite file, a database or a server. View: `mlflow ui --backend-store-uri sqlite:///<database>`.

    experiment is the name of the MLflow experiment.
    """

    database: Path | None = Field(None, description="sqlite file; default: mlflow.db in the output folder")
    uri: str = Field("", description="a server (http://...) or database (postgresql://...) instead of the sqlite file")
    files_at: str = Field("", description="where a new experiment keeps files; default: beside the sqlite file")
    experiment: str = Field("sgcad", min_length=1)
    artifacts: bool = Field(True, description="copy every file of the case into its run, and its pictures to its trace")
    system_metrics_s: float = Field(10.0, ge=0, description="seconds between samples of the machine; 0: none")
    _runs: dict[tuple[str, str], tuple[Store, str]] = PrivateAttr(default_factory=dict)
    _begun: dict[str, Parent] = PrivateAttr(default_factory=dict)
    _live: set[str] = PrivateAttr(default_factory=set)

    def ready(self, out: Path) -> None:
        """Checks that the database or server can be logged to. Raises ConfigError within some 20 s."""
        mlflow_database.check(self._address(out))

    def begin(self, arm: Arm) -> None:
        """Opens the arm's parent run, with the data set, plugin versions, prompts, commit and hardware."""
        parent = parent_of(self._store(Path(arm.out)), arm.config, parameters(arm.params))
        about = {f"plugin.{name}": value for name, value in arm.plugins.items()}
        about |= {f"hardware.{name}": _param_text(value) for name, value in arm.hardware.items()}
        shared = {"sgcad.dataset": arm.dataset.digest[:16]}
        shared |= {"mlflow.source.git.commit": arm.git_commit} if arm.git_commit else {}
        parent.begin(about | mlflow_arm.prompts(parent.store, arm.prompts), shared, _dataset(arm))
        parent.store.describe(experiment_note(parent.store.runs_page))
        self._begun[arm.config] = parent
        if arm.live:
            self._live.add(arm.config)

    def log_case(self, config_name: str, params: dict[str, Any], case_dir: Path, result: dict[str, Any]) -> None:
        """Logs one child run with its trace, figures and files. Raises ConfigError on a bad database, FileNotFoundError
        for one that was moved or deleted meanwhile."""
        store, given = self._store(case_dir.parent.parent), parameters(params)
        parent = parent_of(store, config_name, given)
        if config_name in self._live:
            parent.watch(self.system_metrics_s)
        spans = spans_of(case_dir, result, given.get("backbone.model", given.get("backbone", "")))
        tags = _tags(config_name, result)
        made = parent.new_case(case_dir.name, tags, spans.step.began_s)
        run = str(made.info.run_id)
        self._runs[config_name, case_dir.name] = (store, run)
        # Before the run has figures: MLflow reads the whole run to set its status.
        status = "FAILED" if result["status"] == "failed" else "FINISHED"
        store.client.set_terminated(run, status, int(spans.step.ended_s * 1000))
        store.log(run, _steps(case_dir, result), case_parameters(given), self._about(case_dir, result))
        log_trace(store, run, spans, tags, _pictures(case_dir) if self.artifacts else {})
        if self.artifacts:
            repository(made.info.artifact_uri, store.uri).log_artifacts(str(case_dir))
        store.check_file()
        if config_name in self._live and time.monotonic() > parent.next_update:
            _update(parent)

    def _about(self, case_dir: Path, result: Mapping[str, Any]) -> dict[str, str]:
        """Tags with the case's description, its end in words, and its page in Prefect."""
        links = prefect_links(case_dir)
        tags = {"sgcad.prefect": links["Prefect flow run"]} if "Prefect flow run" in links else {}
        page = self.page(case_dir.parent.name, case_dir.name)
        note = case_note(case_dir, result, page.removeprefix("/"))
        return tags | {NOTE: note, mlflow_arm.OUTCOME: in_words(result)}

    def page(self, config_name: str, case: str) -> str:
        """The run's page; for a database without a known server, the part after the server's address."""
        if (config_name, case) not in self._runs:
            return ""
        store, run = self._runs[config_name, case]
        base = self.uri.rstrip("/") if self.uri.startswith(("http://", "https://")) else ""
        return f"{base}/#/experiments/{store.experiment_id}/runs/{run}"

    def end(self, arm: Arm, finished: bool) -> None:
        """Logs the final means of all cases of the parent, whichever process logged them, and closes the parent."""
        parent = self._begun.pop(arm.config, None)
        if parent is None:
            return
        self._live.discard(arm.config)
        if finished:
            _update(parent, Path(arm.out) / arm.config)
        parent.end("FINISHED" if finished else "FAILED" if arm.fault else "KILLED")

    def identity(self, out: Path) -> str:
        """The experiment's number and creation time, from the database itself."""
        return self._store(out).identity()

    def log_training(self, name: str, params: dict[str, Any], lines: Sequence[Mapping[str, Any]]) -> int:
        """Logs a training as one run, each line with a "step" as one step; skips lines that are logged already."""
        return log_training(self._store(Path()), name, parameters(params), lines)

    def _store(self, out: Path) -> Store:
        return store_of(self._address(out), self.experiment, self.files_at)

    def _address(self, out: Path) -> str:
        return self.uri or f"sqlite:///{(self.database or out / 'mlflow.db').resolve()}"


def _steps(case_dir: Path, result: Mapping[str, Any]) -> dict[int, dict[str, float]]:
    """Figures by step: the final ones at step 0, each attempt's at its number."""
    steps = {0: case_figures(case_dir, result)}
    for step, figures in attempt_figures(case_dir):
        steps.setdefault(step, {}).update(figures)
    return steps


def _tags(config_name: str, result: Mapping[str, Any]) -> dict[str, str]:
    """Tags of a case's run and of its trace."""
    word = (result.get("account") or {}).get("verdict", "none")
    tags = {CONFIG: config_name, "sgcad.status": result["status"], "sgcad.account": word}
    return tags | ({"sgcad.verdict": said} if (said := verdict_sentence(result)) else {})


def _pictures(case_dir: Path) -> dict[str, Path]:
    """The report's drawings and the picture of the result, by name."""
    return {file.stem: file for file in sorted((*case_dir.glob("diagram*.png"), *case_dir.glob("picture.png")))}


def _update(parent: Parent, folder: Path | None = None) -> None:
    """Brings the arm's run up to date; the more time this takes, the less often it is done."""
    started = time.monotonic()
    mlflow_arm.update(parent, folder)
    now = time.monotonic()
    parent.next_update = now + max(UPDATE_S, (now - started) / UPDATE_SHARE)


def _dataset(arm: Arm) -> dict[str, str]:
    return {
        "name": arm.dataset.name,
        "digest": arm.dataset.digest[:16],
        "source_type": "local",
        "source": json.dumps({"uri": arm.dataset.source}),
        "profile": json.dumps({"cases": arm.dataset.cases, "sha256": arm.dataset.digest}),
    }


def _param_text(value: Any) -> str:
    return ", ".join(map(str, value)) or "none" if isinstance(value, (list, tuple)) else str(value)
