"""How often files and scenarios came out right, and where the others failed: the table of a runs folder.

    python -m research.benchmarks.services.generation runs [CONFIG ...]

Reads result.json and attempts/ of every case. First attempt and last are given apart: what a model writes by
itself, and what refinement makes of it. Counts are per file (AER, the paper's) and per scenario (GSR).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from research.benchmarks.run_tables import options_of, show
from sgcad_core.case.records import Finding
from sgcad_core.metrics.generation import LAYERS, AttemptRecord, CaseRecord, Layer, Quality, quality

HEAD = (
    "| config | cases | refused | GSR first | GSR | AER first | AER | scenarios with an error, first | last | "
    "attempts a case | files failed at first by layer | after refinement |"
)


def cases_of(config: Path) -> Iterator[CaseRecord]:
    """The finished cases of one config's folder."""
    for file in sorted(config.glob("*/result.json")):
        result = json.loads(file.read_text(encoding="utf-8"))
        attempts = (_attempt(place) for place in sorted((file.parent / "attempts").glob("*-*")))
        yield CaseRecord(result["status"], tuple(attempts))


def _attempt(place: Path) -> AttemptRecord:
    stage = place.name.rsplit("-", 1)[0]
    if stage not in ("road", "scenario"):
        raise SystemExit(f"{place}: no attempt of a stage; expected road-NN or scenario-NN")
    findings = json.loads((place / "findings.json").read_text(encoding="utf-8"))
    return AttemptRecord("road" if stage == "road" else "scenario", tuple(Finding(**f) for f in findings))


def table(runs: Path, configs: list[str]) -> str:
    """The Markdown table of all configs in a folder, or of those named."""
    folders = [runs / c for c in configs] or sorted(p for p in runs.iterdir() if p.is_dir())
    found = {folder.name: quality(cases) for folder in folders if (cases := list(cases_of(folder)))}
    lines = [HEAD, "|" + "---|" * (HEAD.count("|") - 1), *(_row(name, q) for name, q in found.items())]
    return "\n".join(lines)


def _row(name: str, q: Quality) -> str:
    shares = (
        q.first_success, q.success, q.first_file_errors, q.file_errors, q.first_scenario_errors, q.scenario_errors,
    )  # fmt: skip
    percents = " | ".join(f"{100 * share:.1f} %" for share in shares)
    ends = f"{q.attempts:.1f} | {_layers(q.first_layers)} | {_layers(q.layers)}"
    return f"| {name} | {q.cases} | {q.refused} | {percents} | {ends} |"


def _layers(counts: Mapping[Layer, int]) -> str:
    return ", ".join(f"{layer} {counts[layer]}" for layer in LAYERS if layer in counts) or "-"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    options = options_of(__doc__, arguments)
    show(table(options.runs, options.configs))


if __name__ == "__main__":
    main()
