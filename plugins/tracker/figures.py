"""What trackers log of a case: flat parameters, flat figures, attempts as steps. Knows the run folder only.

Names are joined with "_" ("paper_ice", "seconds_road"); only finite numbers are figures, truth values are
0 or 1.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

STATUSES = ("generated", "refused", "exhausted", "failed")


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


def numbers(tree: Any) -> dict[str, float]:
    """The finite numbers among the leaves."""
    leaves = ((name, value) for name, value in flat(tree) if isinstance(value, (bool, int, float)))
    return {name: float(value) for name, value in leaves if math.isfinite(value)}


def case_figures(case_dir: Path, result: Mapping[str, Any]) -> dict[str, float]:
    """Final figures of a case: its status, the collision, the network, seconds, grounding, all metrics."""
    network = {k: v for k, v in (result.get("network") or {}).items() if k != "segments"}
    collision = result.get("collision") or {}
    figures = {status: float(result["status"] == status) for status in STATUSES}
    figures |= {
        "collision_declared": float(bool(collision.get("declared"))),
        "collision_observed": float(bool(collision.get("observed"))),
        "collision_realised": float(bool(collision.get("realised"))),
        "actors": float(len(result.get("actors") or ())),
    }
    parts = {"network": network, "attempts": result.get("attempts"), "seconds": result.get("seconds")}
    figures |= numbers(parts) | numbers({"grounding": result.get("grounding")})
    metrics = read_json(case_dir / "metrics.json") or {}
    return figures | numbers({k: v for k, v in metrics.items() if k != "thresholds"})


def attempt_figures(case_dir: Path) -> Iterator[tuple[int, dict[str, float]]]:
    """(attempt number, {"road_findings": n, "road_seconds": s, ...}) of every attempt kept."""
    for folder in sorted((case_dir / "attempts").glob("*-*")):
        stage, _, number = folder.name.rpartition("-")
        if not number.isdigit():
            continue
        findings = read_json(folder / "findings.json") or []
        about = read_json(folder / "attempt.json") or {}
        figures = {"findings": sum(f.get("severity") == "repair" for f in findings)} | numbers(about)
        figures.pop("number", None)
        yield int(number), {f"{stage}_{name}": float(value) for name, value in figures.items()}


def read_json(path: Path) -> Any:
    """Content of a JSON file; None where there is none."""
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
