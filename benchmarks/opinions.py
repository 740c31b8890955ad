"""How good are rules, model and both together at a crash's gist? Fits weights of a second opinion and prints a table.

    python -m benchmarks.opinions POOL.jsonl --out HEARD.jsonl [--config configs/gist.yaml] [--part validation]
                                  [--fit configs/prompts/mini_gist.json]

Asks a config's model for the gist of coded reports (benchmarks/told_rows.py says what their codes allow; blind ones are
never asked) and keeps values and probabilities in --out, so that a broken run goes on. The figures of "fused" are
cross-fitted: each half of the reports is decided with weights from the other half. Beside each field stand its shares
right, the sizes, the expected calibration error of the fused confidence in ten bins (Naeini et al. 2015, "Obtaining
well calibrated probabilities using Bayesian binning"), how many reports "fused" has right and the rules wrong and the
other way round, and the exact McNemar test of that. --fit writes the weights of all reports.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.incidents import Incident
from benchmarks.told_rows import WAYS, allowed, of_part
from flows.chain import ask_of
from sgcad_core.asking.opinion import seconded
from sgcad_core.config import Config
from sgcad_core.config import load as load_config
from sgcad_core.metrics.statistics import mcnemar
from sgcad_core.narrative.fusion import decide, terms
from sgcad_core.narrative.gist import FIELDS, RulesSay, alike, rules_say
from sgcad_core.narrative.reading import read
from sgcad_core.opinion import Heard, Opinion, Value, Weights
from sgcad_core.records import CrashReport

AT_ONCE = 12
BINS = 10
RIDGE = 1.0
"""Strength with which the fit holds to the weights of no knowledge: as much as one report of each kind."""
STEPS = 200


class Case(NamedTuple):
    """One report: what its codes allow, what both readers say."""

    id: str
    allowed: dict[str, tuple[Value, ...]]
    rules: RulesSay
    heard: dict[str, Heard]
    refused: bool = False
    """Whether the report stays refused whatever the model says: it gives no account of a crash."""


def ask_all(pool: Path, part: str, config: Config, out: Path, most: int | None = None) -> list[Case]:
    """Every report of a part, or the first so many, asked or remembered; a model that can answers several at once."""
    incidents = list(of_part(pool, part))[:most]
    ask, known = ask_of(config), _remembered(out)

    def heard(incident: Incident) -> tuple[str, dict[str, Heard]]:
        report = CrashReport(case=incident.id, narrative=incident.text)
        opinion = seconded(report, config.second_opinion, ask).opinion
        return incident.id, dict(opinion.heard) if opinion else {}

    with out.open("a", encoding="utf-8") as file, ThreadPoolExecutor(AT_ONCE) as pool_of_threads:
        for id, found in pool_of_threads.map(heard, (one for one in incidents if one.id not in known)):
            known[id] = found
            row = {"id": id, "heard": {key: one.model_dump() for key, one in found.items()}}
            file.write(json.dumps(row) + "\n")
            file.flush()
    return [_case(one, known[one.id]) for one in incidents]


def _case(incident: Incident, heard: dict[str, Heard]) -> Case:
    reading = read(incident.text)
    gap = reading.crash.gap
    return Case(incident.id, codes(incident.truth), rules_say(reading), heard, bool(gap and not gap.unread))


def codes(truth: Any) -> dict[str, tuple[Value, ...]]:
    """What codes allow, without those that writers take loosely: a place that is coded as none of a junction."""
    found = allowed(truth)
    if found.get("junction") == (False,):
        del found["junction"]
    if truth["subject"]["manoeuvre"] == "parked":
        found["subject"] = (*WAYS["parked"], "stopped")
    return found


def _remembered(out: Path) -> dict[str, dict[str, Heard]]:
    lines = out.read_text(encoding="utf-8").splitlines() if out.is_file() else []
    rows = [json.loads(line) for line in lines]
    return {row["id"]: {key: Heard(**one) for key, one in row["heard"].items()} for row in rows}


def right(value: Value | None, some: Iterable[Value]) -> bool:
    """Whether a value is among those allowed, or moves like one."""
    return value is not None and any(alike(value, other) for other in some)


# ------------------------------------------------------------------ weights
def fit(cases: Sequence[Case], key: str) -> Weights:
    """Weights of a field: logistic regression on the reports where the readers differ and one of both is right.

    Where the rules have no value the fit learns nothing: it would learn how often they have none.
    """
    rows, marks, agreed = [], [], []
    for case in cases:
        rule, heard = case.rules.values.get(key), case.heard.get(key)
        if key not in case.allowed or heard is None or rule is None or case.refused:
            continue
        ours, theirs = right(rule, case.allowed[key]), right(heard.value, case.allowed[key])
        if alike(rule, heard.value):
            agreed.append(ours)
        elif ours != theirs:
            rows.append(terms(heard.p, key in case.rules.told)[:3])
            marks.append(float(theirs))
    agree = (sum(agreed) + 0.9) / (len(agreed) + 1)
    found = logistic(np.array(rows).reshape(-1, 3), np.array(marks))
    differ, slope, told = (round(float(one), 3) for one in found)
    return Weights(differ=differ, slope=slope, told=told, agree=round(float(agree), 3))


def logistic(rows: NDArray[np.float64], marks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Newton's steps, halved while they lead up, for a ridge about (0, 1, 0, ...); columns: 1, logit of p, told, ..."""
    begun = np.zeros(rows.shape[1])
    begun[1] = 1.0

    def cost(at: NDArray[np.float64]) -> float:
        return float(np.logaddexp(0, rows @ at).sum() - marks @ (rows @ at) + RIDGE / 2 * ((at - begun) ** 2).sum())

    found = begun.copy()
    for _ in range(STEPS if len(rows) else 0):
        share = 1 / (1 + np.exp(-np.clip(rows @ found, -30, 30)))
        slope = rows.T @ (share - marks) + RIDGE * (found - begun)
        bend = (rows * (share * (1 - share))[:, None]).T @ rows + RIDGE * np.eye(len(begun))
        step = np.linalg.solve(bend, slope)
        while np.abs(step).max() > 1e-8 and cost(found - step) > cost(found):
            step /= 2
        if np.abs(step).max() <= 1e-8:
            break
        found -= step
    return found


# ------------------------------------------------------------------ table
def fused_marks(cases: Sequence[Case], key: str, weights: Callable[[int], Weights]) -> list[tuple[float, bool]]:
    """Confidence of the fused value and whether it is right, of every report with a code."""
    found = []
    for at, case in enumerate(cases):
        if key in case.allowed:
            opinion = Opinion(heard={} if case.refused else case.heard, weights={key: weights(at)})
            one = decide(opinion, case.rules).get(key)
            found.append((one.p, right(one.value, case.allowed[key])) if one and not case.refused else (0.0, False))
    return found


def calibration_error(marks: Sequence[tuple[float, bool]]) -> float:
    """Expected calibration error over `BINS` bins of equal width."""
    total = 0.0
    for low in range(BINS):
        inside = [(p, hit) for p, hit in marks if min(int(p * BINS), BINS - 1) == low]
        total += abs(sum(p for p, _ in inside) - sum(hit for _, hit in inside))
    return total / max(1, len(marks))


def table(cases: Sequence[Case]) -> list[str]:
    """A line a field: rules, model, cross-fitted fusion, either of both, calibration error, mended and spoiled, p."""
    lines = [f"{'field':14s} {'n':>4s} rules model fused either  ece   mended, spoiled, p"]
    halves = cases[::2], cases[1::2]
    for key in FIELDS:
        some = [case for case in cases if key in case.allowed]
        if not some:
            continue
        ours = [not case.refused and right(case.rules.values.get(key), case.allowed[key]) for case in some]
        theirs = [right(h.value if (h := case.heard.get(key)) else None, case.allowed[key]) for case in some]
        of_half = fit(halves[1], key), fit(halves[0], key)
        marks = fused_marks(cases, key, lambda at, w=of_half: w[at % 2])  # type: ignore[misc]
        both = [hit for _, hit in marks]
        either = [a or b for a, b in zip(ours, theirs, strict=True)]
        shares = "  ".join(f"{sum(one) / len(some):.3f}" for one in (ours, theirs, both, either))
        gain = versus(list(zip(ours, both, strict=True)))
        lines.append(f"{key:14s} {len(some):4d} {shares}  {calibration_error(marks):.3f}  {gain}")
    return lines


def versus(pairs: Sequence[tuple[bool, bool]]) -> str:
    """How many the second has right and the first wrong, the other way round, and the exact McNemar test's p."""
    better = sum(b and not a for a, b in pairs)
    worse = sum(a and not b for a, b in pairs)
    before, after = zip(*pairs, strict=True) if pairs else ((), ())
    return f"+{better} -{worse}, {mcnemar(before, after):.3f}"


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--config", type=Path, default=Path("configs/gist.yaml"))
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--part", choices=("train", "validation"), default="validation")
    parser.add_argument("--most", type=int, help="so many reports at most")
    parser.add_argument("--fit", type=Path)
    args = parser.parse_args()
    cases = ask_all(args.pool, args.part, load_config(args.config, tuple(args.set)), args.out, args.most)
    for genre in sorted({case.id.partition("-")[0] for case in cases}):
        print(genre, *table([case for case in cases if case.id.startswith(genre)]), sep="\n")  # noqa: T201
    print("all", *table(cases), sep="\n")  # noqa: T201
    if args.fit:
        weights = {key: fit(cases, key).model_dump() for key in FIELDS}
        args.fit.write_text(json.dumps(weights, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
