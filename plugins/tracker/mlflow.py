"""MLflow: a parent run for each arm, a child run for each case, a span for each model call, and training logs.

A training run is identified by its log's first step line; a tag counts the lines that are logged. Times follow from the
log, so lines logged twice after an interruption are the same points, which MLflow keeps once. Knows the run folder and
result.json; no plugin of another kind. docs/mlflow.md lists the names.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import Field, PrivateAttr

from plugins.tracker import mlflow_database
from plugins.tracker.figures import attempt_figures, case_figures, means, numbers, parameters
from plugins.tracker.headline import arm_note, case_note, experiment_note, headline, prefect_links
from plugins.tracker.mlflow_store import CONFIG, LEVEL, MAX_VALUE, NOTE, Parent, Store, plain, source_tags, store_of
from sgcad_core.case.records import Generation, Query
from sgcad_core.case.tracker_arm import Arm
from sgcad_core.interfaces import Tracker

LOG, LINES = "sgcad.log", "sgcad.lines"
"""Tags of a training run: the key of its log, and how many lines of it are logged."""
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
    artifacts: bool = Field(True, description="copy every file of the case into the run")
    system_metrics_s: float = Field(10.0, ge=0, description="seconds between samples of the machine; 0: none")
    _runs: dict[tuple[str, str], tuple[Store, str]] = PrivateAttr(default_factory=dict)
    _begun: dict[str, Parent] = PrivateAttr(default_factory=dict)

    def ready(self, out: Path) -> None:
        """Checks that the database or server can be logged to. Raises ConfigError within some 20 s."""
        mlflow_database.check(self._address(out))

    def begin(self, arm: Arm) -> None:
        """Opens the arm's parent run, with the data set, plugin versions, commit and hardware."""
        parent = self._store(Path(arm.out)).parent(arm.config, parameters(arm.params))
        about = {f"plugin.{name}": value for name, value in arm.plugins.items()}
        about |= {f"hardware.{name}": _param_text(value) for name, value in arm.hardware.items()}
        shared = {"sgcad.dataset": arm.dataset.digest[:16]}
        shared |= {"mlflow.source.git.commit": arm.git_commit} if arm.git_commit else {}
        parent.begin(about, shared, _dataset(arm))
        parent.store.describe(experiment_note())
        self._begun[arm.config] = parent

    def log_case(self, config_name: str, params: dict[str, Any], case_dir: Path, result: dict[str, Any]) -> None:
        """Logs one child run: parameters, attempts as steps, figures, files. Raises ConfigError on a bad database."""
        store, given = self._store(case_dir.parent.parent), parameters(params)
        parent = store.parent(config_name, given)
        if config_name in self._begun:
            parent.watch(self.system_metrics_s)
        account = (result.get("account") or {}).get("verdict", "none")
        tags = {CONFIG: config_name, "sgcad.status": result["status"], "sgcad.account": account}
        made = parent.new_case(case_dir.name, tags, time.time() - sum((result.get("seconds") or {}).values()))
        run = str(made.info.run_id)
        self._runs[config_name, case_dir.name] = (store, run)
        store.tag(run, self._about(case_dir, result))
        # Before the run has figures: MLflow reads the whole run to set its status.
        store.client.set_terminated(run, "FAILED" if result["status"] == "failed" else "FINISHED")
        store.log(run, _steps(case_dir, result), given)
        if self.artifacts:
            _repository(made.info.artifact_uri, store.uri).log_artifacts(str(case_dir))
        if config_name in self._begun and time.monotonic() > parent.next_update:
            _update(parent)

    def _about(self, case_dir: Path, result: Mapping[str, Any]) -> dict[str, str]:
        """Tags with the case's description and its page in Prefect."""
        links = prefect_links(case_dir)
        tags = {"sgcad.prefect": links["Prefect flow run"]} if "Prefect flow run" in links else {}
        page = self.page(case_dir.parent.name, case_dir.name)
        return tags | {NOTE: case_note(case_dir, result, page.removeprefix("/"))}

    def log_generation(self, config_name: str, case: str, query: Query, generation: Generation) -> None:
        """Logs one span in the case's run; called after `log_case`."""
        if (config_name, case) in self._runs:
            store, run = self._runs[config_name, case]
            _span(store, run, case, query, generation)

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
        import mlflow

        if finished:
            mlflow.flush_trace_async_logging()
            _update(parent)
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
    """Figures by step: the final ones and the machine's at step 0, each attempt's at its number."""
    figures = case_figures(case_dir, result)
    steps = {0: headline(figures) | figures | _machine()}  # MLflow's comparison opens on what was logged first
    for step, figures in attempt_figures(case_dir):
        steps.setdefault(step, {}).update({f"attempt_{name}": value for name, value in figures.items()})
    return steps


def _machine() -> dict[str, float]:
    """The machine at the end of a case: processor use since the case before, memory in use, this process's memory."""
    import psutil

    memory = psutil.virtual_memory()
    return {
        "system/cpu_utilization_percentage": psutil.cpu_percent(),
        "system/system_memory_usage_percentage": memory.percent,
        "system/process_memory_megabytes": psutil.Process().memory_info().rss / 1e6,
    }


def _update(parent: Parent) -> None:
    """Reads the cases' figures and logs their means; the more time this takes, the less often it is done."""
    started = time.monotonic()
    found = means(parent.figures())
    parent.log_means(found)
    parent.tag({NOTE: arm_note(parent.name, found)})
    now = time.monotonic()
    parent.next_update = now + max(UPDATE_S, (now - started) / UPDATE_SHARE)


def _repository(address: str, uri: str) -> Any:
    """The store of a run's files; the client's own method would read the whole run again."""
    from mlflow.store.artifact.artifact_repository_registry import get_artifact_repository

    return get_artifact_repository(address, tracking_uri=uri)


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


def _span(store: Store, run: str, case: str, query: Query, generation: Generation) -> None:
    """Logs one model call as a trace of its run, with the call's duration."""
    import mlflow

    mlflow.set_tracking_uri(store.uri)  # spans go where the fluent API points
    end = time.time_ns()
    figures = {
        "prompt_tokens": generation.prompt_tokens,
        "answer_tokens": len(generation.tokens),
        "model_calls": generation.model_calls,
        "seconds": generation.seconds,
    }
    span = mlflow.start_span_no_context(
        f"{case}[{query.attempt}]",
        span_type="LLM",
        inputs={"task": query.task, "passages": [p.id for p in query.passages], "repair": query.repair},
        attributes={"stage": query.stage, "attempt": query.attempt, "finish": generation.finish, **figures},
        metadata={"mlflow.sourceRun": run},
        experiment_id=store.experiment_id,
        start_time_ns=end - int(generation.seconds * 1e9),
    )
    span.end(outputs={"text": generation.text, "grounding": dict(generation.grounding)}, end_time_ns=end)


# ------------------------------------------------------------------ training logs
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
