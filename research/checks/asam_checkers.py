"""ASAM's quality checkers over a folder of runs: every .xodr and .xosc, one line a file.

    .venv-qc/bin/python research/checks/asam_checkers.py runs/

A script for a virtual environment of its own: asam-qc-opendrive and asam-qc-openscenarioxml pin numpy < 2 and
lxml < 6, which the project's other libraries do not go with. Imports nothing of the project. Exit code 0: all
files pass; 1: a file has findings or a checker failed on it; 2: no such folder, or nothing in it.
"""

from __future__ import annotations

import logging
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from qc_baselib import Configuration, Result, StatusType
from qc_opendrive import constants as xodr_names
from qc_opendrive import main as xodr_checker
from qc_openscenario import constants as xosc_names
from qc_openscenario import main as xosc_checker

BUNDLES: dict[str, tuple[str, Callable[[Configuration, Result], None]]] = {
    ".xodr": (xodr_names.BUNDLE_NAME, xodr_checker.run_checks),
    ".xosc": (xosc_names.BUNDLE_NAME, xosc_checker.run_checks),
}


class Verdict(NamedTuple):
    """One file: rules that ran, were skipped or broke, and the findings by rule."""

    file: Path
    ran: int
    skipped: int
    broken: list[str]
    findings: Counter[str]
    examples: list[str]


def judge(file: Path) -> Verdict:
    """Run ASAM's rules on one file."""
    bundle, run_checks = BUNDLES[file.suffix]
    config, result = Configuration(), Result()
    config.set_config_param("InputFile", str(file))
    result.register_checker_bundle(name=bundle, description="", version="1", summary="")
    run_checks(config, result)
    states = Counter(c.status for c in result.get_checker_results(bundle))
    broken = [c.checker_id for c in result.get_checker_results(bundle) if c.status == StatusType.ERROR]
    issues = [i for c in result.get_checker_results(bundle) for i in c.issues]
    return Verdict(
        file, states[StatusType.COMPLETED], states[StatusType.SKIPPED], broken,
        Counter(i.rule_uid.rsplit(":", 1)[-1] for i in issues), [_where(i) for i in issues[:3]],
    )  # fmt: skip


def _where(issue: Any) -> str:
    places = [p.xpath for location in issue.locations for p in location.xml_location]
    return f"{issue.description} ({', '.join(places)})"


def main(folder: str) -> int:
    """Judge every file under the folder, print a line for each and a summary by rule."""
    found = (f for f in Path(folder).rglob("*") if f.suffix in BUNDLES)
    files = sorted(f for f in found if "mlflow-artifacts" not in f.parts)  # copies
    if not files:
        sys.stderr.write(f"{folder}: no .xodr and no .xosc in it; give a folder of runs\n")
        return 2
    logging.disable(logging.CRITICAL)
    verdicts = [judge(f) for f in files]
    for v in verdicts:
        state = "FAIL" if v.findings or v.broken else "ok"
        counts = f"{v.ran:3d} rules{v.skipped:3d} skipped{sum(v.findings.values()):4d} findings"
        sys.stdout.write(f"{state:5s}{counts}  {v.file}\n")
        for line in [*(f"{n} x {rule}" for rule, n in v.findings.items()), *v.broken, *v.examples]:
            sys.stdout.write(f"       {line}\n")
    bad = [v for v in verdicts if v.findings or v.broken]
    for suffix in BUNDLES:
        count = sum(v.file.suffix == suffix for v in verdicts)
        sys.stdout.write(f"{suffix}: {count - sum(v.file.suffix == suffix for v in bad)} of {count} files pass\n")
    return 1 if bad else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.stderr.write("usage: .venv-qc/bin/python research/checks/asam_checkers.py RUNS\n")
        sys.exit(2)
    sys.exit(main(sys.argv[1]))
