"""Rules, learned reader and model on coded narratives: how much is right field by field, and the combiner's weights.

    python -m research.benchmarks.texts.coded_fusion POOL.jsonl[.gz] [--part blind|apart] [--most N]
                                                     [--answers FILE.jsonl [--ask]] [--fit WEIGHTS.json]

The readings of the rules alone, with the learned reader's answers, and with the model's too are laid out and held
against the codes (`coded_cases`, as `disagree` does), without planning. Behind the shares stand how many verdicts each
has right and the rules wrong, the other way round, and the exact McNemar test. With --answers, of the lines whose
answers of the model are in the file; --ask asks for those that are not. Parts are those of
`research.rows.numbered_rows`: blind lines give these totals and nothing else.

`--fit configs/prompts/whole_learned.json` fits the combiner's figures of the kinds of fields that codes judge
(`coded_claims`) on the part `apart`, which taught the readers nothing, and writes them over those of the file; its
calibration is told cross-fitted in five folds.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from flows.case.steps import ask_of
from research.benchmarks.texts import answer_cache
from research.benchmarks.texts.coded_cases import FIELDS, Verdict, drawn_of, verdicts
from research.benchmarks.texts.coded_claims import JUDGED, Judge
from research.rows.coded_incidents import by_hash
from research.rows.numbered_rows import lines_of, part_of
from research.training.weight_fit import SIGNS, calibration_error, logistic, versus
from sgcad_core.asking.second_opinion import load_weights, with_model_opinion
from sgcad_core.case.records import CrashReport
from sgcad_core.config import load as load_config
from sgcad_core.reading.reading import Reading, read
from sgcad_core.reading.second_reader.answered_values import model_claims
from sgcad_core.reading.second_reader.combiner import FIGURES, FILLS, needed, terms
from sgcad_core.reading.second_reader.field_claims import KINDS, kind_of, rules_claim
from sgcad_core.reading.second_reader.fuse_whole import agree, fused_with_answer
from sgcad_core.reading.second_reader.learned_support import support_of
from sgcad_core.reading.second_reader.numbered.fuse_numbered import fused_with_guesses
from sgcad_core.reading.second_reader.numbered.numbered_reader import guesses
from sgcad_core.records.second_reader import HEARD, WHOLE, Answered, Guess, Opinion, Weights

AT_ONCE = 8
FOLDS = 5
LEAST = 20
"""Fields in which one of both is right that a fit needs; a kind with fewer keeps its figures."""


@dataclass(frozen=True)
class Case:
    """A line with what all three readers make of its text."""

    line: Mapping[str, Any]
    answered: Answered | None = None

    @cached_property
    def rules(self) -> Reading:
        """The rules' reading."""
        return read(self.line["text"])

    @cached_property
    def guesses(self) -> Mapping[str, Guess]:
        """The learned reader's answers."""
        return guesses(self.line["text"])

    @cached_property
    def learned(self) -> Reading:
        """The rules' reading with those of them that are taken."""
        return fused_with_guesses(self.rules, self.guesses)

    def fused(self, heard: Mapping[str, Weights], unheard: Mapping[str, Weights]) -> Reading:
        """That with the model's answers too; weights where the learned reader says something, and where it does not."""
        weights = heard if self.guesses else unheard
        opinion = Opinion(weights=weights, answered=self.answered, guesses=self.guesses, takes=FILLS)
        return fused_with_answer(self.learned, opinion)

    def verdicts(self, reading: Reading) -> list[Verdict]:
        """The fields of a reading of it that codes judge."""
        return verdicts(self.line, drawn_of(reading))


# ------------------------------------------------------------------ weights
@dataclass(frozen=True)
class Differing:
    """A field in which model and rules (with the learned reader) differ; `told`: None where the rules have no value."""

    id: str
    kind: str
    terms: tuple[float, ...]
    told: float | None
    rules_right: bool
    model_right: bool


def differing(case: Case) -> Iterator[Differing]:
    """Those of one case that codes judge."""
    reading = case.learned
    if (
        case.answered is None
        or not case.guesses
        or reading.crash.gap
        or reading.crash.near_crash
        or reading.crash.unnumbered
    ):
        return
    rules, model, judge = rules_claim(reading), model_claims(case.answered), Judge(case.line, reading)
    support = support_of(reading.crash, rules, model, case.guesses)
    for key, said in model.items():
        rule, kind = rules.get(key), kind_of(key)
        if kind not in JUDGED or (rule is not None and agree(key, rule, said)):
            continue
        theirs, ours = judge.right(key, said.value), judge.right(key, rule.value) if rule is not None else False
        if theirs is None or ours is None:
            continue
        told = None if rule is None else rule.told
        found = terms(said.p, told or 0.0, said.nats, said.told, learned=support.get(key, 0.0))
        yield Differing(case.line["id"], kind, found, told, bool(ours), bool(theirs))


def fit(some: Sequence[Differing], before: Weights) -> Weights:
    """Figures of a kind, from where one of both is right."""
    rows = [one for one in some if one.rules_right != one.model_right]
    found = logistic(
        np.array([r.terms for r in rows]).reshape(-1, len(SIGNS)), np.array([float(r.model_right) for r in rows]), SIGNS
    )
    return before.model_copy(update=dict(zip(FIGURES, (round(float(x), 3) for x in found), strict=True)))


def fitted(some: Sequence[Differing], before: Mapping[str, Weights]) -> tuple[dict[str, Weights], list[str]]:
    """Weights of all kinds, and a line for each that codes judge: what it changes, cross-fitted, and how calibrated."""
    after, lines = dict(before), []
    for kind in JUDGED:
        mine = [one for one in some if one.kind == kind]
        if sum(one.rules_right != one.model_right for one in mine) < LEAST:
            continue
        ends = []
        for fold in range(FOLDS):
            weights = fit([one for one in mine if by_hash(one.id) % FOLDS != fold], before[kind])
            ends += [(one, p_of(weights, one)) for one in mine if by_hash(one.id) % FOLDS == fold]
        lines.append(
            f"{kind}, cross-fitted: {_words(ends)}; as it was: {_words([(o, p_of(before[kind], o)) for o in mine])}"
        )
        after[kind] = fit(mine, before[kind])
    return after, lines


def p_of(weights: Weights, one: Differing) -> float:
    """How likely the model is right where one of both is."""
    return 1 / (1 + float(np.exp(-np.dot([getattr(weights, name) for name in FIGURES], one.terms))))


def _words(ends: Sequence[tuple[Differing, float]]) -> str:
    taken = [(one, p >= needed(FILLS, one.told)) for one, p in ends]
    marks = [(one.rules_right, one.model_right if took else one.rules_right) for one, took in taken]
    one_right = [(p, one.model_right) for one, p in ends if one.rules_right != one.model_right]
    count = sum(took for _, took in taken)
    error = f"ece {calibration_error(one_right):.3f} of {len(one_right)}"
    return f"{len(ends)} differ, {count} taken, {versus(marks)}, {error}"


# ------------------------------------------------------------------ table
def table(cases: Sequence[Case], weights: Mapping[str, Weights] | None) -> Iterator[str]:
    """A line a field: shares right of the rules, with the learned reader, and with the model too."""
    marks: dict[str, list[tuple[bool, ...]]] = defaultdict(list)
    unheard = load_weights(WHOLE, KINDS)
    for case in cases:
        readings = [case.rules, case.learned, *([case.fused(weights, unheard)] if weights is not None else [])]
        for several in zip(*(case.verdicts(reading) for reading in readings), strict=True):
            marks[several[0].field].append(tuple(v.right for v in several))
    for field in FIELDS:
        if found := marks[field]:
            columns = list(zip(*found, strict=True))
            parts = [f"{field:17s} {len(found):5d}  rules {sum(columns[0]) / len(found):.4f}"]
            for name, column in zip(("learned", "model too"), columns[1:], strict=False):
                parts.append(
                    f"{name} {sum(column) / len(found):.4f} ({versus(list(zip(columns[0], column, strict=True)))})"
                )
            yield "  ".join(parts)


def answers_of(
    lines: Mapping[str, Mapping[str, Any]], file: Path, ask: bool, config: str
) -> dict[str, Answered | None]:
    """The model's answers in a file by id; with `ask` also those that are not there yet."""
    asker = ask_of(load_config(config, ())) if ask else None

    def answer(line: Mapping[str, Any]) -> Any:
        report = CrashReport(case=line["id"], narrative=line["text"])
        opinion = with_model_opinion(report, asker).opinion if asker else None
        return opinion.answered.model_dump(mode="json") if opinion and opinion.answered else None

    known = answer_cache.answers(lines if ask else {}, answer, "answered", file, AT_ONCE)
    return {id: Answered(**known[id]) if known[id] else None for id in lines if id in known}


def main(arguments: Sequence[str] | None = None) -> None:
    """Read, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--part", choices=("apart", "blind"), default="blind")
    parser.add_argument("--most", type=int)
    parser.add_argument("--answers", type=Path)
    parser.add_argument("--ask", action="store_true")
    parser.add_argument("--config", default="fused.yaml")
    parser.add_argument("--fit", type=Path, help="write the weights here; reads the part apart")
    args = parser.parse_args(arguments)
    part = "apart" if args.fit else args.part
    lines = {line["id"]: line for line in lines_of(args.pool) if part_of(line) == part}
    lines = dict(sorted(lines.items(), key=lambda item: by_hash(item[0]))[: args.most])
    answers = answers_of(lines, args.answers, args.ask, args.config) if args.answers else dict.fromkeys(lines)
    cases = [Case(lines[id], answered) for id, answered in answers.items()]
    weights = dict(load_weights(HEARD, KINDS)) if args.answers else None
    print(f"{part}: {len(cases)} narratives")  # noqa: T201 - a command prints
    if args.fit and weights is not None:
        weights, told = fitted([one for case in cases for one in differing(case)], weights)
        print(*told, sep="\n")  # noqa: T201
        kept = {kind: one.model_dump() for kind, one in weights.items()}
        args.fit.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    print(*table(cases, weights), sep="\n")  # noqa: T201


if __name__ == "__main__":
    main()
