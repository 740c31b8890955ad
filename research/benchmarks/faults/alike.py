"""Whether two results are the same but for times: trees of files, an index's rows, a training's weights.

Seconds, dates and random names are left out of the comparison and nothing else is.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

from flows.case_files import case_links

TIMES = re.compile(rb'"seconds": ?(\{[^{}]*\}|[0-9.eE+-]+)|"shared": ?\[[^\]]*\]|"(began|ended)_s": ?[0-9.eE+-]+')
"""How long something took, when a step began, and which stages another arm had done by then."""
SKIPPED = (".tracked", ".tracking", "links.json")
"""A tracker's marks hold when its database was made, links the ids of runs."""
STAGED = re.compile(rb"sgcad-temp-inbox-\w+")
"""A folder of random name, in which the inbox keeps a copy of a report while it works on it."""


def differences(one: Path, other: Path, inner: str | Path) -> list[str]:
    """Files below `inner` of two places that are there once or differ, times and the places' names left out."""
    ours, theirs = _tree(one / inner, one), _tree(other / inner, other)
    lone = [f"{name} is there once" for name in sorted(ours.keys() ^ theirs.keys())]
    return lone + [f"{name} differs" for name in sorted(ours.keys() & theirs.keys()) if ours[name] != theirs[name]]


def _tree(folder: Path, place: Path) -> dict[str, str]:
    files = (f for f in sorted(folder.rglob("*")) if f.is_file() and f.name not in SKIPPED)
    return {str(f.relative_to(folder)): hashlib.sha256(_content(f, place)).hexdigest() for f in files}


def _content(file: Path, place: Path) -> bytes:
    """A file's bytes without times and without the place where the trial lies."""
    return STAGED.sub(b"STAGED", TIMES.sub(b"", file.read_bytes())).replace(os.fsencode(place), b"PLACE")


def same_file(one: Path, other: Path, inner: Path) -> bool:
    """Whether a file of two places is there in both, and the same but for times and the places' names."""
    both = (one / inner).is_file() and (other / inner).is_file()
    return both and _content(one / inner, one) == _content(other / inner, other)


def unlinked(folder: Path) -> list[str]:
    """Cases of a config's folder that do not say where MLflow has them."""
    cases = sorted(case for case in folder.iterdir() if (case / "result.json").is_file())
    return [f"{case.name} has no link to MLflow" for case in cases if "mlflow" not in case_links.kept(case)]


def unlogged(database: Path, cases: dict[str, int]) -> list[str]:
    """What is wrong with MLflow's runs: every case of a config once, every config's run FINISHED."""
    if not database.is_file():
        return [f"there is no {database.name}"]
    with closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as found:
        asked = (
            "SELECT c.value, l.value, r.status FROM runs r JOIN tags l ON l.run_uuid = r.run_uuid AND "
            "l.key = 'sgcad.level' JOIN tags c ON c.run_uuid = r.run_uuid AND c.key = 'sgcad.config' "
            "WHERE r.lifecycle_stage = 'active'"
        )
        rows = list(found.execute(asked))
    told = [f"run of {config} is {status}" for config, _, status in rows if status != "FINISHED"]
    for config, count in cases.items():
        logged = sum(name == config and level == "case" for name, level, _ in rows)
        parents = sum(name == config and level == "config" for name, level, _ in rows)
        if (logged, parents) != (count, 1):
            told.append(f"{config}: {logged} of {count} cases and {parents} parent runs in MLflow")
    return told


def index_rows(folder: Path) -> Any:
    """An index's rows in order, and what its manifest says but for the time."""
    import lancedb

    about = json.loads((folder / "index.json").read_text(encoding="utf-8"))
    table = lancedb.connect(folder).open_table("chunks")
    table.checkout(about["table_version"])
    rows = sorted(json.dumps(row, sort_keys=True, default=str) for row in table.to_arrow().to_pylist())
    return {k: v for k, v in about.items() if k not in ("written", "table_version")}, rows


def weights(folder: Path) -> Any:
    """A training's optimizer, progress and exported weights, as digests."""
    import torch

    state = torch.load(folder / "state.pt", map_location="cpu", weights_only=True)
    found = {k: state[k] for k in ("steps", "rows", "places")}
    found["optimizer"] = _digest(state["optimizer"])
    export = sorted(f for f in (folder / "export").rglob("*") if f.is_file())
    return found | {f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in export}


def _digest(value: Any) -> str:
    found = hashlib.sha256()

    def feed(value: Any) -> None:
        if isinstance(value, dict):
            for key in sorted(value, key=str):
                found.update(str(key).encode())
                feed(value[key])
        elif hasattr(value, "numpy"):
            found.update(value.detach().float().numpy().tobytes())
        else:
            found.update(repr(value).encode())

    feed(value)
    return found.hexdigest()


def same(of: Callable[[Path], Any], one: Path, other: Path) -> list[str]:
    """Differences in words of what a function makes of two folders."""
    return [] if of(one) == of(other) else [f"{of.__name__} of {other.name} are others than undisturbed"]
