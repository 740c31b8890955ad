"""Reports that other writers told from fact sheets: what share is read right by the rules, the model and both?

    python -m research.benchmarks.texts.outside [--config fused.yaml] [--answers FILE.jsonl] [--fit configs/prompts]
    python -m research.benchmarks.texts.outside --drawings ...      each report also with a made drawing of its crash
    python -m research.benchmarks.texts.outside --rules [--folder research/generator/written] [--show KIND]

`research/benchmarks/texts/outside/*.jsonl` (the form of `research.generator.writer_texts`) was written by people who
had seen neither the rules nor the phrases of made reports, nor a real one. Half of it, by the hash of the id, may be
looked at; of the blind half only totals are. The reports in `sparse/` leave out much of their crash on purpose: sides,
lanes, maneuvers. Those in `late/`, written last, do so in part; the shipped weights were fitted before a rule was
mended on them. With `--drawings` every report is read a second time, with a made drawing of its crash
(`research.renderer`); what the drawing shows then counts as told.

Fields are those of `sgcad_core.reading.second_reader.field_claims`; those that are not told do not count. "fused, p":
how many the combiner has right and the rules wrong, the other way round, and the exact McNemar test. The last column is
the expected calibration error of the combiner where both have a value, in ten bins. `--fit` fits the combiner's weights
on the seen half, those for reports with drawings where --drawings is given; its own rows there are cross-fitted. The
model's answers are kept in --answers. `--rules` asks no model; with `--show` it prints the texts in which the rules
have a kind of field wrong.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from research.benchmarks.texts.outside_cases import DRAWN, Case, asked, cases, with_drawing
from research.generator.writer_texts import Written, load
from research.rows.coded_incidents import by_hash
from research.training.weight_fit import SIGNS, calibration_error, logistic, versus
from sgcad_core.asking.second_opinion import load_weights
from sgcad_core.errors import ConfigError
from sgcad_core.reading.second_reader.combiner import FIGURES, FILLS, model_right, terms
from sgcad_core.reading.second_reader.field_claims import KINDS, Claim, kind_of, rules_claim
from sgcad_core.reading.second_reader.fuse_whole import agree, decided, fused_with_answer, same
from sgcad_core.records.second_reader import DRAWN as OF_DRAWN
from sgcad_core.records.second_reader import WHOLE, Opinion, Weights

FOLDER = Path(__file__).parent / "outside"
PARTS = {"": "", "sparse": ", reports that leave out much", "late": ", reports written last"}
"""Folders within it and what is in them."""
WITH_DRAWING = ", with drawings"


# ------------------------------------------------------------------ weights
def fit(some: Iterable[Case]) -> dict[str, Weights]:
    """Weights by kind of field: a logistic regression on where the readers differ and one of both is right.

    Where the rules have no value the model's is held against nothing: such rows count as those where it is untold.
    What the text does not tell is no reason to leave the rules: there a differing value of the model's counts as wrong.
    """
    rows: dict[str, list[tuple[float, ...]]] = defaultdict(list)
    marks: dict[str, list[float]] = defaultdict(list)
    agreed: dict[str, list[bool]] = defaultdict(list)
    for case in some:
        rules, model = case.claims
        for key, said in model.items():
            want, rule = case.truth.get(key), rules.get(key)
            if rule is not None and agree(key, rule, said):
                agreed[kind_of(key)] += [right(key, rule.value, want.value)] if want is not None else []
                continue
            theirs = want is not None and right(key, said.value, want.value)
            mine = rule is not None and want is not None and right(key, rule.value, want.value)
            if rule is None or want is None or mine != theirs:
                rows[kind_of(key)].append(terms(said.p, rule.told if rule is not None else 0.0, said.nats, said.told))
                marks[kind_of(key)].append(float(theirs))
    return {kind: _weights(rows[kind], marks[kind], agreed[kind]) for kind in KINDS if rows[kind]}


def _weights(rows: Sequence[tuple[float, ...]], marks: Sequence[float], agreed: Sequence[bool]) -> Weights:
    figures = [round(float(x), 3) for x in logistic(np.array(rows), np.array(marks), SIGNS)]
    agree = (sum(agreed) + 0.9) / (len(agreed) + 1)
    return Weights(**dict(zip(FIGURES, figures, strict=True)), agree=round(agree, 3))


def right(key: str, got: object, want: object) -> bool:
    """Whether a value is the true one."""
    return got is not None and same(key, got, want)


# ------------------------------------------------------------------ table
def untold(some: Sequence[Case], weights: Mapping[str, Mapping[str, Weights]]) -> str:
    """How many values of the rules that the text does not tell are given up for the model's guess."""
    changed = count = 0
    for case in some:
        rules, model = case.claims
        taken = decided(rules, model, weights[case.id], FILLS)
        for key in (rules.keys() & model.keys()) - case.truth.keys():
            differ = not agree(key, rules[key], model[key])
            count, changed = count + differ, changed + (differ and key in taken)
    return f"not told, readers differ: {count}; of these the model's is taken: {changed}"


def table(some: Sequence[Case], weights: Mapping[str, Mapping[str, Weights]]) -> Iterator[str]:
    """Lines by kind of field; `weights` by id of the case."""
    marks: dict[str, list[tuple[bool, bool, bool]]] = defaultdict(list)
    sure: dict[str, list[tuple[float, bool]]] = defaultdict(list)
    for case in some:
        rules, model = case.claims
        opinion = Opinion(weights=weights[case.id], answered=case.answered, takes=FILLS)
        both = fused_with_answer(case.reading, opinion)
        after = rules_claim(both)
        for key, want in case.truth.items():
            three = tuple(right(key, c[key].value, want.value) if key in c else False for c in (rules, model, after))
            for kind in (kind_of(key), "all"):
                marks[kind].append(three)  # type: ignore[arg-type]
            p = confidence(key, rules.get(key), model.get(key), opinion)
            if p is not None:
                sure[kind_of(key)].append((p, three[2]))
    yield "| field | n | rules | model | fused | either | fused, p | calibration error |"
    yield "|---|---|---|---|---|---|---|---|"
    for kind in (*KINDS, "all"):
        if found := marks[kind]:
            shares = [sum(one[i] for one in found) / len(found) for i in range(3)]
            either = sum(one[0] or one[1] for one in found) / len(found)
            told = " | ".join(f"{x:.3f}" for x in (*shares, either))
            error = f"{calibration_error(sure[kind]):.3f}" if sure[kind] else ""
            yield f"| {kind} | {len(found)} | {told} | {versus([(one[0], one[2]) for one in found])} | {error} |"


def confidence(key: str, rule: Claim | None, said: Claim | None, opinion: Opinion) -> float | None:
    """How sure the combiner is of what it takes; None where one of both has no value."""
    weights = opinion.weights.get(kind_of(key))
    if weights is None or rule is None or said is None:
        return None
    if agree(key, rule, said):
        return weights.agree
    p = model_right(weights, said.p, rule.told, said.nats, said.told)
    return p if p >= opinion.takes else 1 - p


def rules_alone(texts: Sequence[Written], show: str | None) -> Iterator[str]:
    """The rules' shares by kind, of both halves; or the errors of a kind in the half that may be looked at."""
    found = cases(texts, {})
    if show is None:
        for name, blind in (("seen", False), ("blind", True)):
            some = [case for case in found if case.blind == blind]
            yield f"{name} half, {len(some)} texts"
            yield from table(some, {case.id: {} for case in some})
        return
    told = {one.id: one.text for one in texts}
    for case in found:
        rules = rules_claim(case.reading)
        for key, want in case.truth.items():
            got = rules[key].value if key in rules else None
            if kind_of(key) == show and not case.blind and not right(key, got, want.value):
                yield f"----- {case.id}\n{told[case.id]}\n{key}: want {want.value}, got {got}\n"


def crossed(some: Sequence[Case]) -> dict[str, dict[str, Weights]]:
    """For each case weights that were fitted without its fold, five folds by the hash of the id."""
    folds = {case.id: by_hash(case.id.removesuffix(DRAWN) + "fold") % 5 for case in some}
    fitted = {k: both_fits([case for case in some if folds[case.id] != k]) for k in range(5)}
    return {id: fitted[k][_weights_for(id)] for id, k in folds.items()}


def both_fits(some: Sequence[Case]) -> dict[str, dict[str, Weights]]:
    """Weights for texts alone, of those alone, and for texts with drawings, of all: real drawings are harder to read
    than made ones, so these weights are held back by what holds for texts."""
    return {WHOLE: fit(case for case in some if not case.id.endswith(DRAWN)), OF_DRAWN: fit(some)}


def _weights_for(id: str) -> str:
    return OF_DRAWN if id.endswith(DRAWN) else WHOLE


def shipped_weights() -> dict[str, dict[str, Weights]]:
    """Those that the default config uses."""
    return {name: dict(load_weights(name, KINDS)) for name in (WHOLE, OF_DRAWN)}


def texts_of(folder: Path) -> dict[str, tuple[Written, ...]]:
    """What is in a folder of reports and in its PARTS, by what they are."""
    return {name: load(folder / part) for part, name in PARTS.items() if (folder / part).is_dir()}


def by_part(some: Sequence[Case], texts: Mapping[str, Sequence[Written]]) -> Iterator[tuple[str, list[Case]]]:
    """Texts alone by what they are, and all that are read with drawings."""
    for name, found in texts.items():
        ids = {one.id for one in found}
        yield name, [case for case in some if case.id in ids]
    yield WITH_DRAWING, [case for case in some if case.id.endswith(DRAWN)]


def main(arguments: Sequence[str] | None = None) -> None:
    """Ask, fit, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=FOLDER)
    parser.add_argument("--config", default="fused.yaml")
    parser.add_argument("--set", action="append", default=[], dest="overrides", help="key=value, as for sgcad")
    parser.add_argument("--answers", type=Path, help="a file that keeps the model's answers")
    parser.add_argument("--fit", type=Path, metavar="FOLDER", help="write the weights here")
    parser.add_argument("--drawings", action="store_true", help="each report also with a drawing of its crash")
    parser.add_argument("--rules", action="store_true", help="the rules alone")
    parser.add_argument("--show", choices=KINDS, help="print the texts that may be looked at and are read wrong")
    options = parser.parse_args(arguments)
    if options.fit is not None and not options.fit.is_dir():
        parser.error(f"--fit {options.fit}: no such folder; give the one for the weights, such as configs/prompts")
    try:
        parts = texts_of(options.folder)
        texts = tuple(one for some in parts.values() for one in some)
        if options.rules:
            print("\n".join(rules_alone(texts, options.show)))  # noqa: T201 - a command prints
            return
        shipped = shipped_weights() if options.fit is None else {}
        texts = (*texts, *map(with_drawing, texts if options.drawings else ()))
        all_cases = cases(texts, asked(texts, options.config, options.overrides, options.answers))
    except (ConfigError, ValueError) as fault:
        raise SystemExit(str(fault)) from fault
    seen, blind = ([case for case in all_cases if case.blind == half] for half in (False, True))
    shipped = shipped or both_fits(seen)
    halves = (
        ("seen half, weights cross-fitted", seen, crossed(seen)),
        ("blind half", blind, {case.id: shipped[_weights_for(case.id)] for case in blind}),
    )
    for half, some, weights in halves:
        for name, part in by_part(some, parts):
            lines = [f"{half}{name}: {len(part)} texts", *table(part, weights), "", untold(part, weights), ""]
            print("\n".join(lines if part else []))  # noqa: T201 - a command prints
    if options.fit is not None:
        for name in (WHOLE, OF_DRAWN) if options.drawings else (WHOLE,):
            weights = {kind: one.model_dump() for kind, one in shipped[name].items()}
            (options.fit / f"{name}.json").write_text(json.dumps(weights, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
