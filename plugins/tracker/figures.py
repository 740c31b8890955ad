"""The parameters and figures that trackers log of a case, flat, with attempts as steps. Knows the run folder only.

A figure is named by its group and what it is, joined with "_" ("paper/time_to_collision_s", "seconds/road"): MLflow
draws one section of charts a group. Status and collision have no group. Only finite numbers are figures, truth values
are 0 or 1. Parameters have the names of the YAML and of `--set` ("decoder", "decoder.alpha"). docs/mlflow.md lists the
names.
"""

from __future__ import annotations

import math
from array import array
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from statistics import fmean
from typing import Any

from plugins.tracker.attempts import attempts_of, read_json

STATUSES = ("generated", "refused", "exhausted", "failed")
OF_ONE_CASE = ("attempt/", "grounding/")
"""Prefixes of figures without a mean: steps of attempts, fields that only some specs have."""
OF_ANSWER = ("prompt_tokens", "answer_tokens", "model_calls")
"""Figures of a model's answer in an attempt; the trace has the rest."""
TELL_APART = (
    "backbone", "backbone.model", "decoder", "road_writer", "scenario_writer", "retriever", "second_opinion", "seed",
    "drive.drivers",
)  # fmt: skip
"""Parameters that a case has too, beside those of the decoder: all others are its arm's alone."""


def flat(tree: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Leaves of nested mappings and lists with their joined names; list items are numbered from 0."""
    if isinstance(tree, Mapping):
        items: Any = tree.items()
    elif isinstance(tree, (list, tuple)):
        items = enumerate(tree)
    else:
        yield name, tree
        return
    for key, value in items:
        yield from flat(value, f"{name}_{key}" if name else str(key))


def parameters(params: Mapping[str, Any]) -> dict[str, str]:
    """A config's values: a plugin's name under its kind, its fields behind a dot; lists of plugins by their names."""
    named = (item for key, entry in params.items() for item in _of(key, entry))
    return {name: "none" if value is None else str(value) for name, value in named}


def case_parameters(params: Mapping[str, str]) -> dict[str, str]:
    """Those of `parameters` by which cases of different arms are told apart."""
    return {name: value for name, value in params.items() if name in TELL_APART or name.startswith("decoder.")}


def _of(key: str, entry: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(entry, Mapping):
        if "name" in entry:
            yield key, entry["name"]
        for field, value in entry.items():
            if field != "name":
                yield from _of(f"{key}.{field}", value)
    elif isinstance(entry, (list, tuple)):
        plugins = [item for item in entry if isinstance(item, Mapping) and "name" in item]
        yield key, ",".join(str(item["name"] if item in plugins else item) for item in entry)
        for item in plugins:
            fields = {field: value for field, value in item.items() if field != "name"}
            yield from _of(f"{key}.{item['name']}", fields)
    else:
        yield key, entry


def numbers(tree: Any) -> dict[str, float]:
    """The finite numbers among the leaves."""
    leaves = ((name, value) for name, value in flat(tree) if isinstance(value, (bool, int, float)))
    return {name: float(value) for name, value in leaves if math.isfinite(value)}


def case_figures(case_dir: Path, result: Mapping[str, Any]) -> dict[str, float]:
    """Final figures of a case: its status, the collision, the network, seconds, grounding, all metrics."""
    network = {k: v for k, v in (result.get("network") or {}).items() if k != "segments"}
    collision, near = result.get("collision") or {}, result.get("near_crash") or {}
    person = result.get("person") or {}
    figures = {status: float(result["status"] == status) for status in STATUSES}
    figures |= {
        "collision_declared": float(bool(collision.get("declared"))),
        "collision_observed": float(bool(collision.get("observed"))),
        "collision_realised": float(bool(collision.get("realised"))),
        "near_crash_declared": float(bool(near)),
        "near_crash_realised": float(bool(near.get("realised"))),
        "actors": float(len(result.get("actors") or ())),
        "person_facts": float(person.get("facts", 0)),
        "person_disagreed": float(person.get("disagreed", 0)),
    }
    account = {k: v for k, v in (result.get("account") or {}).items() if k not in ("verdict", "sentence", "items")}
    figures |= {f"account/{name}": float(count) for name, count in account.items()}
    figures["account/disagreements"] = float(len(result.get("disagreements") or ()))
    figures["account/whole"] = float((result.get("account") or {}).get("verdict") == "whole")
    seconds = dict(result.get("seconds") or {})
    groups = {"network": network, "attempts": result.get("attempts"), "grounding": result.get("grounding")}
    metrics = read_json(case_dir / "metrics.json") or {}
    groups |= {"seconds": seconds | {"total": sum(seconds.values())}, "driven": _driven(metrics.get("drive") or {})}
    return figures | grouped(groups) | grouped({k: v for k, v in metrics.items() if k != "thresholds"})


def grouped(groups: Mapping[str, Any]) -> dict[str, float]:
    """The numbers of every group behind its name and "/"; a number without a group keeps its name."""
    found = {name: numbers(tree if isinstance(tree, Mapping) else {"": tree}) for name, tree in groups.items()}
    return {f"{group}/{name}" if name else group: v for group, tree in found.items() for name, v in tree.items()}


def _driven(drivers: Mapping[str, Any]) -> Mapping[str, Any]:
    """Figures by role of the config's only driver, so that arms with different drivers use the same names."""
    return next(iter(drivers.values())) if len(drivers) == 1 else {}


def attempt_figures(case_dir: Path) -> Iterator[tuple[int, dict[str, float]]]:
    """(attempt number, {"attempt/road_findings": n, "attempt/road_seconds": s, ...}) of every attempt kept."""
    for one in attempts_of(case_dir):
        repairs = sum(finding.get("severity") == "repair" for finding in one.findings)
        figures = {"findings": float(repairs), "seconds": one.seconds}
        figures |= numbers({name: (one.generation or {}).get(name) for name in OF_ANSWER})
        yield one.number, {f"attempt/{one.stage}_{name}": value for name, value in figures.items()}


def means(cases: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Every figure's mean over the cases that have it, under its own name, and the number of cases by status.

    Uses 8 bytes for each figure and case: the means of arms of 10,000 cases are computed often.
    """
    columns: dict[str, array[float]] = defaultdict(lambda: array("d"))
    count = 0
    for figures in cases:
        count += 1
        for name, value in figures.items():
            if not name.startswith(OF_ONE_CASE):
                columns[name].append(value)
    found = {name: fmean(columns[name]) for name in sorted(columns)}
    counts = {f"cases_{status}": float(sum(columns.get(status, ()))) for status in STATUSES}
    return found | counts | {"cases": float(count)}
