"""How good are rules, model and both together at a crash's gist? Fits weights of a second opinion and prints a table.

    python -m research.benchmarks.texts.fuse_weights POOL.jsonl --out HEARD.jsonl [--config configs/gist.yaml] \
        [--part validation]
                                  [--fit configs/prompts/mini_gist.json]

Asks a config's model for the gist of coded reports (research/rows/coded_rows.py says what their codes allow; blind ones
are never asked) and keeps values and probabilities in --out, so that a broken run goes on. The figures of "fused" are
cross-fitted: each half of the reports is decided with weights from the other half. Beside each field stand its shares
right, the sizes, the expected calibration error of the fused confidence in ten bins (Naeini et al. 2015, "Obtaining
well calibrated probabilities using Bayesian binning"), how many reports "fused" has right and the rules wrong and the
other way round, and the exact McNemar test of that. --fit writes the weights of all reports.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from flows.case.steps import ask_of
from research.benchmarks.texts import answer_cache
from research.rows.coded_incidents import Incident
from research.rows.coded_rows import WAYS, allowed, incidents_of_part
from research.training.weight_fit import calibration_error, logistic, versus
from sgcad_core.asking.second_opinion import with_gist_opinion
from sgcad_core.case.records import CrashReport
from sgcad_core.config import Config
from sgcad_core.config import load as load_config
from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader.combiner import terms
from sgcad_core.reading.second_reader.fuse_gist import decide
from sgcad_core.reading.second_reader.seven_question_gist import FIELDS, RuleValues, alike, rule_values
from sgcad_core.records.second_reader import Heard, Opinion, Value, Weights

AT_ONCE = 12


class Case(NamedTuple):
    """One report: what its codes allow, what both readers say."""

    id: str
    allowed: dict[str, tuple[Value, ...]]
    rules: RuleValues
    heard: dict[str, Heard]
    refused: bool = False
    """Whether the report stays refused whatever the model says: it gives no account of a crash."""


def ask_all(pool: Path, part: str, config: Config, out: Path, most: int | None = None) -> list[Case]:
    """Every report of a part, or the first so many, asked or remembered; a model that can answers several at once."""
    incidents = {one.id: one for one in list(incidents_of_part(pool, part))[:most]}
    ask = ask_of(config)

    def heard(incident: Incident) -> dict[str, Any]:
        report = CrashReport(case=incident.id, narrative=incident.text)
        opinion = with_gist_opinion(report, config.second_opinion, ask).opinion
        return {key: one.model_dump() for key, one in opinion.heard.items()} if opinion else {}

    known = answer_cache.answers(incidents, heard, "heard", out, AT_ONCE)
    said = {id: {key: Heard(**one) for key, one in row.items()} for id, row in known.items()}
    return [_case(one, said[id]) for id, one in incidents.items()]


def _case(incident: Incident, heard: dict[str, Heard]) -> Case:
    reading = read(incident.text)
    gap = reading.crash.gap
    return Case(incident.id, codes(incident.truth), rule_values(reading), heard, bool(gap and not gap.unread))


def codes(truth: Any) -> dict[str, tuple[Value, ...]]:
    """What codes allow, without those that writers take loosely: a place that is coded as none of a junction."""
    found = allowed(truth)
    if found.get("junction") == (False,):
        del found["junction"]
    if truth["subject"]["manoeuvre"] == "parked":
        found["subject"] = (*WAYS["parked"], "stopped")
    return found


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


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--config", type=Path, default=Path("configs/gist.yaml"))
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--part", choices=("train", "validation"), default="validation")
    parser.add_argument("--most", type=int, help="so many reports at most")
    parser.add_argument("--fit", type=Path)
    args = parser.parse_args(arguments)
    cases = ask_all(args.pool, args.part, load_config(args.config, tuple(args.set)), args.out, args.most)
    for genre in sorted({case.id.partition("-")[0] for case in cases}):
        print(genre, *table([case for case in cases if case.id.startswith(genre)]), sep="\n")  # noqa: T201
    print("all", *table(cases), sep="\n")  # noqa: T201
    if args.fit:
        weights = {key: fit(cases, key).model_dump() for key in FIELDS}
        args.fit.write_text(json.dumps(weights, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
