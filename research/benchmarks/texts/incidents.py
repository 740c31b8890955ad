"""How well are incident reports drawn whose vehicles have no numbers? Prints the measures of three groups.

    python -m research.benchmarks.texts.incidents --dev CASES TRUTH [--pool POOL.jsonl] --out OUT [--sample N] \
        [--score-only]
                                   [--config CONFIG.yaml]

Runs `sgcad evaluate` with a config, the template one unless told otherwise, over the cases and scores what it leaves
(research/benchmarks/texts/incident_scores.py). A pool's line is a report with its codes: {"id", "text", "contact",
"subject", "other", "road"}. Of the pool the reports whose id's SHA-256 is a multiple of six are *blind*: never
read, only their totals are printed; the others are *seen*. `--sample` takes that many of the seen ones, as their
hashes fall; blind and dev are always taken whole. Beside the measures stand how many were generated, refused and
exhausted, and the false successes: a contact is told, none came about, and the status is "generated". The first part of
an id, up to "-", is its genre; `--only` takes one. Where some reports give no account of a crash (they refer to another
report, or it is blacked out), a second line has the figures of those that do: what could be read at all.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

from research.benchmarks.texts.incident_scores import MEASURES, Run, false_success, scores
from research.rows.coded_incidents import Incident, of_dev, of_pool

CONFIG = Path(__file__).resolve().parents[3] / "configs" / "template.yaml"
STATUSES = ("generated", "refused", "exhausted", "failed")


def write_cases(incidents: Iterable[Incident], folder: Path) -> None:
    """One folder a report, its text alone."""
    for incident in incidents:
        case = folder / incident.id
        case.mkdir(parents=True, exist_ok=True)
        (case / "report.txt").write_text(incident.text, encoding="utf-8")


def run_cases(cases: Path, runs: Path, config: Path = CONFIG) -> None:
    """All case folders with a config; cases that fail are results."""
    command = [sys.executable, "-c", "from flows.cli import main; main()", "evaluate", str(cases)]
    subprocess.run([*command, "--config", str(config), "--out", str(runs)], check=False)  # noqa: S603 - our own command


def table(incidents: Sequence[Incident], runs: Path) -> list[str]:
    """The figures of every group and genre, one line each; of the blind ones totals, like of all others."""
    lines = []
    for group, genre in sorted({(i.group, i.genre) for i in incidents}):
        members = [i for i in incidents if (i.group, i.genre) == (group, genre)]
        lines.append(_line(f"{group} {genre}", members, runs))
        telling = [i for i in members if not Run.of(runs / i.id).silent]
        if len(telling) < len(members):
            lines.append(_line(f"{group} {genre} with an account", telling, runs))
    return lines


def _line(name: str, members: Sequence[Incident], runs: Path) -> str:
    statuses: Counter[str] = Counter()
    measured: dict[str, list[bool]] = {}
    wrong = 0
    for incident in members:
        run = Run.of(runs / incident.id)
        statuses[run.status] += 1
        wrong += false_success(run, incident.truth)
        for measure, verdict in scores(run, incident.truth).items():
            measured.setdefault(measure, []).append(verdict)
    shares = [f"{m} {sum(v) / len(v):.3f} ({len(v)})" for m in MEASURES if (v := measured.get(m))]
    counts = [f"{statuses[s]} {s}" for s in STATUSES if statuses[s]]
    return f"{name}: {', '.join(shares)}; {', '.join(counts) or 'none run'}; false success {wrong}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Write cases, run them, print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dev", type=Path, nargs=2, metavar=("CASES", "TRUTH"))
    parser.add_argument("--pool", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--sample", type=int)
    parser.add_argument("--config", type=Path, default=CONFIG, help="whose runs are scored (template.yaml)")
    parser.add_argument("--only", default="", help="a genre, such as sgo")
    parser.add_argument("--score-only", action="store_true", help="score what --out holds from before")
    args = parser.parse_args(arguments)
    incidents = (of_dev(*args.dev) if args.dev else []) + (of_pool(args.pool, args.sample) if args.pool else [])
    incidents = [i for i in incidents if i.genre == args.only or not args.only]
    if not incidents:
        parser.error("nothing to measure: give --dev CASES TRUTH, --pool POOL.jsonl, or both")
    write_cases(incidents, args.out / "cases")
    if not args.score_only:
        run_cases(args.out / "cases", args.out / "runs", args.config)
    print("\n".join(table(incidents, args.out / "runs" / args.config.stem)))  # noqa: T201 - a command prints


if __name__ == "__main__":
    main()
