"""Learns where the rules err from coded incident reports, and prints what that would change in reports set apart.

    python -m research.training.readers.train_learned_reader POOL.jsonl [--out \
        sgcad_core/reading/second_reader/learned_reader.npz] [--takes 0.6] [--folds 5]

Learned are the two linear readers and the judge of `sgcad_core.reading.second_reader.learned_reader`, on the training
rows of `research.rows.coded_rows` (blind and validation reports never). Codes allow sets of values: the loss is minus
the logarithm of what a reader gives to all of them together, with an L2 penalty. The judge learns from what readers say
of reports that they did not learn from (stacking; Wolpert 1992, "Stacked generalization"). Printed are, by field: the
share of the rules' values that are right, values mended and spoiled, out of fold and on the validation reports, and the
expected calibration error of what stands in the end. Nothing is played out here: `research.benchmarks.texts.incidents
--config configs/fused.yaml` does that.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.sparse import csr_matrix, hstack

from research.rows.coded_rows import incidents_of_part
from research.rows.reader_rows import FIELDS, Row, row, target
from research.training.weight_fit import calibration_error
from sgcad_core.reading.second_reader.learned_reader import (  # fmt: skip
    READING_WEIGHT,
    WORDS_NORM,
    Contest,
    Field,
    Learned,
    contest,
    hashed,
    known,
    probability,
    save,
)
from sgcad_core.reading.second_reader.learned_reader_features import runs
from sgcad_core.records.second_reader import WEIGHTS, Value

MENDS = 1.5
"""A field is kept whose reader mends, out of fold, so many times what it spoils."""
SEEN_IN = 3
"""Reports that a feature must be in."""
L2, L2_ALONE = 5.0, 2.0
RIDGE = 1.0
"""Strength with which the judge holds to trusting both readers half."""
STEPS = 80
FOREIGN_SHARE = 0.02
"""Share of the reports learned from that are as foreign, out of fold, as the first that nothing is said of."""
Floats = NDArray[np.float64]


# ------------------------------------------------------------------ readers
class Readers(NamedTuple):
    """What both readers of all fields learned; `fields` has values, weights and biases."""

    word_hashes: NDArray[np.uint32]
    reading_hashes: NDArray[np.uint32]
    fields: Mapping[str, tuple[tuple[Value, ...], Floats, Floats, Floats, Floats]]

    def say(self, key: str, rows: Sequence[Row]) -> tuple[Floats, Floats]:
        """(reports, values) probabilities of either reader."""
        _, whole, bias, alone, bias_alone = self.fields[key]
        by_words = _matrix([one.words for one in rows], self.word_hashes, norm=True)
        both = hstack([by_words, _matrix([one.readings for one in rows], self.reading_hashes)]).tocsr()
        return softmax(both @ whole + bias), softmax(by_words @ alone + bias_alone)


def taught(rows: Sequence[Row]) -> Readers:
    """Both readers of every field, from rows."""
    word_hashes, reading_hashes = (_frequent(getattr(one, name) for one in rows) for name in ("words", "readings"))
    by_words = _matrix([one.words for one in rows], word_hashes, norm=True)
    both = hstack([by_words, _matrix([one.readings for one in rows], reading_hashes)]).tocsr()
    fields = {}
    for key in FIELDS:
        at = [i for i, one in enumerate(rows) if key in one.allowed]
        targets = [target(rows[i], key) for i in at]
        values = tuple(sorted({value for some in targets for value in some}, key=str))
        may = np.array([[value in some for value in values] for some in targets])
        fields[key] = values, *multinomial(both[at], may, L2), *multinomial(by_words[at], may, L2_ALONE)
    return Readers(word_hashes, reading_hashes, fields)


def _frequent(rows: Iterable[Iterable[str]]) -> NDArray[np.uint32]:
    counts = Counter(feature for one in rows for feature in one)
    return hashed(feature for feature, n in counts.items() if n >= SEEN_IN)


def _matrix(rows: Sequence[Iterable[str]], hashes: NDArray[np.uint32], norm: bool = False) -> Any:
    """(reports, features) of what a text has: rows of one length, or the weight of a reading."""
    at = [known(one, hashes) for one in rows]
    scale = [WORDS_NORM / np.sqrt(max(1, len(one))) if norm else READING_WEIGHT for one in at]
    data = np.concatenate([np.full(len(one), by) for one, by in zip(at, scale, strict=True)])
    ends = np.cumsum([0, *map(len, at)])
    return csr_matrix((data, np.concatenate(at), ends), shape=(len(rows), len(hashes)))


def multinomial(seen: Any, may: NDArray[np.bool_], l2: float, steps: int = STEPS) -> tuple[Floats, Floats]:
    """Weights (features, values) and biases that make the allowed values likely."""
    count, width = may.shape[1], seen.shape[1]
    turned = seen.T.tocsr()

    def loss(at: Floats) -> tuple[float, Floats]:
        weights, bias = at[:-count].reshape(width, count), at[-count:]
        p = softmax(seen @ weights + bias)
        inside = np.where(may, p, 0.0)
        mass = np.maximum(inside.sum(1, keepdims=True), 1e-300)
        slope = p - inside / mass
        grown = np.concatenate([(turned @ slope + l2 * weights).ravel(), slope.sum(0)])
        return float(-np.log(mass).sum() + l2 / 2 * (weights**2).sum()), grown

    found = minimize(loss, np.zeros((width + 1) * count), jac=True, method="L-BFGS-B", options={"maxiter": steps}).x
    weights: Floats = found[:-count].reshape(width, count)
    return weights, found[-count:]


def softmax(scores: Floats) -> Floats:
    """Shares of every row."""
    powers: Floats = np.exp(scores - scores.max(1, keepdims=True))
    shares: Floats = powers / powers.sum(1, keepdims=True)
    return shares


# ------------------------------------------------------------------ judge
class Judged(NamedTuple):
    """One field of one report: the rules' value, what stands beside it, and which of both are right."""

    row: Row
    rule: Value
    contest: Contest
    rule_right: bool
    other_right: bool


def judged(readers: Readers, key: str, rows: Sequence[Row]) -> list[Judged]:
    """Reports in which the rules have a value and the codes judge it."""
    some = [one for one in rows if key in one.allowed and key in one.values]
    values, found = readers.fields[key][0], []
    if not some:
        return []
    for one, both, alone in zip(some, *readers.say(key, some), strict=True):
        rule = one.values[key]
        beside = contest(values, both, alone, rule, key in one.told)
        if beside is not None:
            found.append(Judged(one, rule, beside, one.right(key, rule), one.right(key, beside.other)))
    return found


def figures(of: Sequence[Sequence[float]], marks: Sequence[bool], begun: Sequence[float]) -> tuple[float, ...]:
    """Logistic regression with a ridge about where it begins."""
    start = np.array(begun, dtype=float)
    x, y = np.array(of, dtype=float).reshape(-1, len(start)), np.array(marks, dtype=float)

    def loss(at: Floats) -> tuple[float, Floats]:
        score = x @ at
        slope = x.T @ (1 / (1 + np.exp(-score)) - y) + RIDGE * (at - start)
        return float(np.logaddexp(0, score).sum() - y @ score + RIDGE / 2 * ((at - start) ** 2).sum()), slope

    return tuple(round(float(one), 4) for one in minimize(loss, start, jac=True, method="L-BFGS-B").x)


class Judge(NamedTuple):
    """Figures of a field, as `learned.Field` has them."""

    change: tuple[float, ...]
    keep: tuple[float, ...]

    @staticmethod
    def of(some: Sequence[Judged]) -> Judge:
        """From reports that the readers did not learn from."""
        differ = [one for one in some if one.rule_right != one.other_right]
        change = figures([one.contest.change for one in differ], [one.other_right for one in differ], (0, 0.5, 0.5, 0))
        keep = figures([one.contest.keep for one in some], [one.rule_right for one in some], (0, 0.5, 0.5))
        return Judge(change, keep)

    def decides(self, one: Judged, takes: float) -> tuple[float, bool, bool]:
        """How sure, whether that is right, and whether the rules give way."""
        p = probability(self.change, one.contest.change)
        if p >= takes:
            return p, one.other_right, True
        return probability(self.keep, one.contest.keep), one.rule_right, False


class Found(NamedTuple):
    """Of one field: reports, shares right before and after, what changed, calibration in the end."""

    n: int
    before: float
    after: float
    mended: int
    spoiled: int
    changed: int
    error: float

    @staticmethod
    def of(ends: Sequence[tuple[Judged, tuple[float, bool, bool]]]) -> Found:
        """From what was decided."""
        pairs = [(one.rule_right, right) for one, (_, right, _) in ends]
        before, after = (sum(side) / max(1, len(pairs)) for side in (zip(*pairs, strict=True) if pairs else ((), ())))
        mended, spoiled = sum(b > a for a, b in pairs), sum(a > b for a, b in pairs)
        error = calibration_error([(p, right) for _, (p, right, _) in ends])
        return Found(len(pairs), before, after, mended, spoiled, sum(end[2] for _, end in ends), error)

    def words(self) -> str:
        """For the table."""
        shares = f"n {self.n}, rules {self.before:.3f}, both {self.after:.3f}"
        return f"{shares}, +{self.mended} -{self.spoiled} of {self.changed} changed, ece {self.error:.3f}"


def learn(rows: Sequence[Row], apart: Sequence[Row], takes: float, folds: int) -> tuple[Learned, list[str]]:
    """All weights, and the table; fields in which too little is mended are left to the rules."""
    parts = [[one for one in rows if one.fold % folds == n] for n in range(folds)]
    of_fold = [taught([one for one in rows if one.fold % folds != n]) for n in range(folds)]
    readers, fields, lines = taught(rows), {}, []
    for key in FIELDS:
        held = [judged(of_fold[n], key, part) for n, part in enumerate(parts)]
        found, judge = _out_of_fold(held, takes)
        kept = found.mended >= MENDS * max(1, found.spoiled)
        lines.append(f"{key}, out of fold: {found.words()}{'' if kept else ' (left to the rules)'}")
        lines += _apart(key, judged(readers, key, apart), judge, takes)
        if kept:
            fields[key] = _field(readers, key, judge)
    shares = [_known_share(one, of_fold[n]) for n, part in enumerate(parts) for one in part]
    least = round(float(np.quantile(shares, FOREIGN_SHARE)), 3)
    return Learned(readers.word_hashes, readers.reading_hashes, fields, takes, least), lines


def _out_of_fold(held: Sequence[Sequence[Judged]], takes: float) -> tuple[Found, Judge]:
    """What judges of the other folds find in each; the judge of all."""
    ends = []
    for n, part in enumerate(held):
        judge = Judge.of([one for m, other in enumerate(held) if m != n for one in other])
        ends += [(one, judge.decides(one, takes)) for one in part]
    return Found.of(ends), Judge.of([one for part in held for one in part])


def _apart(key: str, some: Sequence[Judged], judge: Judge, takes: float) -> Iterator[str]:
    """A line a genre of the validation reports, and one of all."""
    for genre in (*sorted({one.row.id.partition("-")[0] for one in some}), ""):
        ends = [(one, judge.decides(one, takes)) for one in some if one.row.id.startswith(genre)]
        yield f"{key}, validation {genre or 'all'}: {Found.of(ends).words()}"


def _field(readers: Readers, key: str, judge: Judge) -> Field:
    values, whole, bias, alone, bias_alone = readers.fields[key]
    cut = len(readers.word_hashes)
    return Field(values, whole[:cut], whole[cut:], bias, alone, bias_alone, *judge)


def _known_share(one: Row, readers: Readers) -> float:
    asked = runs(one.words)
    return len(known(asked, readers.word_hashes)) / max(1, len(asked))


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--out", type=Path, default=WEIGHTS)
    parser.add_argument("--takes", type=float, default=0.6)
    parser.add_argument("--folds", type=int, default=5)
    args = parser.parse_args(arguments)
    rows, apart = (
        [r for one in incidents_of_part(args.pool, part) if (r := row(one))] for part in ("train", "validation")
    )
    learned, lines = learn(rows, apart, args.takes, args.folds)
    save(learned, args.out)
    print(*lines, f"{len(rows)} reports, least known {learned.least_known}", sep="\n")  # noqa: T201


if __name__ == "__main__":
    main()
