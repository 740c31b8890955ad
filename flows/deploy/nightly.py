"""The `nightly` deployment: a benchmark over a folder of cases, compared with the last accepted run.

Each run writes latest.json, and with `accept` accepted.json too. A drop beyond tolerance fails the flow run, whose
message names each figure, the accepted value and the new one. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from prefect import flow
from prefect.client.schemas.objects import State
from prefect.runtime import flow_run
from prefect.states import Completed, Failed

from flows.batch.batch_flow import run_inside_flow
from flows.batch.plan_batch import Batch, batch_of
from flows.batch.tracking.machine import git_commit
from flows.case_files import case_folder
from flows.case_files import find_cases as case_sets
from flows.case_files.folder_cases import left_out
from flows.deploy.case_table import CaseTable, named
from flows.deploy.defaults import cases_folder, overrides_of, results_folder
from flows.deploy.parameters import Config, Factor, Jobs, Share
from flows.results.measures import GENERATION, NETWORK_MEAN, NETWORK_WRONG, TRUTH, Measure, values_of
from flows.results.reading import Study, load_study
from sgcad_core import settings
from sgcad_core.errors import ConfigError

LATEST, ACCEPTED = "latest.json", "accepted.json"
SECONDS = Measure("seconds", "time a case", "mean", "s", "low")
COMPARED = (*GENERATION, *NETWORK_WRONG, *NETWORK_MEAN, *TRUTH, SECONDS)

Figures = Mapping[str, Mapping[str, float]]
"""config -> measure -> value over its cases, fractions, counts and seconds."""


class Tolerance(NamedTuple):
    """Allowed worsening: of shares and errors the difference (0.02 = two of a hundred cases), of others a factor."""

    share: float = 0.02
    count_factor: float = 1.1
    seconds_factor: float = 1.5


def _name() -> str:
    about = settings.configs_or_default(flow_run.parameters.get("configs"))
    return named("nightly", about=about, more=f"{datetime.now(UTC):%Y-%m-%d}")


@flow(name="nightly", flow_run_name=_name, persist_result=False)
def nightly_flow(
    cases: Path | None = None,
    configs: tuple[Config, ...] = (),
    truth: Path | None = None,
    out: Path | None = None,
    overrides: tuple[str, ...] = (),
    jobs: Jobs = None,
    fresh: bool = False,
    tolerance: Share = 0.02,
    seconds_factor: Factor = 1.5,
    accept: bool = False,
) -> State[Any]:
    """Run the benchmark; it fails if a figure is worse than the accepted one by more than the tolerance.

    Args:
        cases: Folder of cases. Empty: SGCAD_CASES, else the bundled reports.
        configs: Configs that are measured. Empty: the default one.
        truth: Folder of labels; without it only figures that need none are measured.
        out: Folder of the results. Empty: the folder nightly in SGCAD_OUT, else in runs.
        overrides: Changes of every config as key=value, such as max_attempts=3.
        jobs: Cases at a time. Empty: by the cores, or by the model's batch.
        fresh: Repeat unchanged cases too.
        tolerance: Allowed worsening of shares and errors; 0.02 is two of a hundred cases.
        seconds_factor: Allowed factor of the time a case.
        accept: Make this run the reference.
    """
    paths, found = settings.configs_or_default(configs), case_sets.cases_in([cases_folder(cases)])
    batch = batch_of(found, paths, results_folder(out, "nightly"), overrides_of(overrides), jobs, fresh)
    batch = replace(batch, left=left_out([cases_folder(cases)]))
    batch = batch if out else _in_one_database(batch, results_folder(None) / "mlflow.db")
    if truth and not truth.is_dir():
        raise ConfigError(f"truth {truth}: no such folder; give the one that holds <case>.json, or none")
    table = CaseTable()
    run_inside_flow(batch, table.add)
    table.show()
    latest = _about(batch, figures_of(batch, truth))
    case_folder.write_json(batch.out / LATEST, latest)
    if accept:
        case_folder.write_json(batch.out / ACCEPTED, latest)
    return _judged(batch.out, latest, Tolerance(tolerance, seconds_factor=seconds_factor))


def _in_one_database(batch: Batch, database: Path) -> Batch:
    """The batch with trackers that name no database logging to that of all results."""
    log = {"database": database.resolve()}
    trackers = [
        c.tracker.model_copy(update=log if getattr(c.tracker, "database", "") is None else {}) for c in batch.configs
    ]
    pairs = zip(batch.configs, trackers, strict=True)
    return replace(batch, configs=tuple(config.model_copy(update={"tracker": tracker}) for config, tracker in pairs))


def _judged(out: Path, latest: dict[str, Any], tolerance: Tolerance) -> State[Any]:
    if (accepted := _read(out / ACCEPTED)) is None:
        return Completed(message="measured; no run is accepted yet: run it with accept to make it the reference")
    if accepted["dataset_digest"] != latest["dataset_digest"]:
        return Failed(message=f"accepted was measured on other cases; look at {out / LATEST}, then run it with accept")
    if found := list(drops(accepted["figures"], latest["figures"], tolerance)):
        return Failed(message="; ".join(found) + f" (accepted {accepted['measured']})")
    return Completed(message=f"no figure is worse than accepted on {accepted['measured']}")


# ------------------------------------------------------------------ figures
def figures_of(batch: Batch, truth: Path | None) -> dict[str, dict[str, float]]:
    """Figures of a finished batch by config, from its folders; with truth also the errors against it."""
    names, ids = {c.name for c in batch.configs}, tuple(c.id for c in batch.cases)
    found = load_study(batch.out, truth)
    study = replace(found, arms=tuple(a for a in found.arms if a.name in names), cases=ids)
    return {arm.name: _figures(study, arm.name) for arm in study.arms}


def _figures(study: Study, arm: str) -> dict[str, float]:
    values = []
    for case, ran in study.ran[arm].items():
        seconds = {"seconds": float(sum(ran.result["seconds"].values()))}
        values.append(values_of(ran, study.labels.get(case)) | seconds)
    figures = {m.name: _value(m, values) for m in COMPARED}
    return {name: round(value, 6) for name, value in figures.items() if value is not None}


def _value(measure: Measure, values: Sequence[Mapping[str, float]]) -> float | None:
    """Value over the cases that have it: the mean, or of a ratio the quotient of the sums; None if no case has it."""
    if measure.kind == "ratio":
        above, below = (sum(v.get(key, 0.0) for v in values) for key in measure.keys)
        return above / below if below else None
    found = [v[measure.key] for v in values if measure.key in v]
    return sum(found) / len(found) if found else None


def drops(accepted: Figures, latest: Figures, tolerance: Tolerance) -> Iterator[str]:
    """Figures that are worse than the accepted ones by more than the tolerance, in words; a missing figure counts."""
    for config, figures in accepted.items():
        for measure in COMPARED:
            old, new = figures.get(measure.name), latest.get(config, {}).get(measure.name)
            if old is None or not measure.better:
                continue
            if new is None:
                yield f"{config}: {measure.name} was {old:.4g} and is no longer measured"
            elif _is_worse(measure, old, new, tolerance):
                yield f"{config}: {measure.name} was {old:.4g}, is {new:.4g} ({measure.better} is good)"


def _is_worse(measure: Measure, old: float, new: float, tolerance: Tolerance) -> bool:
    if measure.unit == "%":
        worse = old - new if measure.better == "high" else new - old
        return worse > tolerance.share + 1e-9
    factor = tolerance.seconds_factor if measure is SECONDS else tolerance.count_factor
    return new > old * factor if measure.better == "low" else new * factor < old


# ------------------------------------------------------------------ what is written
def _about(batch: Batch, figures: Figures) -> dict[str, Any]:
    return {
        "measured": datetime.now(UTC).isoformat(timespec="seconds"),
        "package": version("sg-cadvlm"),
        "git_commit": git_commit(),
        "dataset_digest": case_sets.dataset_digest(batch.cases),
        "cases": len(batch.cases),
        "figures": figures,
    }


def _read(file: Path) -> dict[str, Any] | None:
    try:
        about: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except ValueError as fault:
        raise ConfigError(f"{file}: cannot be read ({fault}); remove it and accept a run again") from fault
    return about
