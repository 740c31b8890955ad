"""Learns from coded numbered reports where the rules err, and prints what that changes in reports set apart.

    python -m research.training.readers.train_numbered_reader POOL.jsonl[.gz] [--rows ROWS.npz] [--limit N]
                                                      [--processes 2] [--out WEIGHTS.npz]

Learned are the readers of `sgcad_core.reading.second_reader.numbered.numbered_reader`, kind by kind, on nine tenths
of the lines that are not blind. The judge is fitted on the tenth that they did not see; its own line there is cross-
fitted between halves. A kind in which the judge mends too little is left to the rules. Printed are by kind: the share
of the rules' answers that are right, the share with the reader, how many answers it mends and spoils with the exact
McNemar test, and the expected calibration error of what stands; of blind lines these totals and nothing else.
`--rows` keeps the rows between calls: delete it when rules have changed. `--limit`: so many lines, spread over all
parts.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from multiprocessing import Pool
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, hstack

from research.rows import numbered_rows
from research.rows.numbered_rows import Row, drawn_lines, rows_of
from research.training.readers.train_learned_reader import multinomial, softmax
from research.training.weight_fit import calibration_error, logistic, versus
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.learned_reader import READING_WEIGHT, WORDS_NORM, Field, probability
from sgcad_core.reading.second_reader.numbered.numbered_reader import (
    Contest,
    Kind,
    Learned,
    contest,
    rows_at,
    save,
    takes,
)
from sgcad_core.records.second_reader import NUMBERED_WEIGHTS

MENDS = 1.5
"""A kind is kept whose reader mends so many times what it spoils, in the tenth set apart."""
SEEN_IN = 6
"""Questions that a feature must be in."""
L2, L2_ALONE = 4.0, 2.0
STEPS = 60
FOREIGN_SHARE = 0.02
"""Share of the questions set apart that are as foreign as the first of which nothing is said."""
SMALL = 0.002
"""A feature is left out whose weights are all smaller than that share of the largest one."""
Floats = NDArray[np.float64]


# ------------------------------------------------------------------ readers
def taught(rows: Sequence[Row]) -> Kind:
    """Both readers of one kind of question."""
    word_hashes, reading_hashes = (_frequent([getattr(one, name) for one in rows]) for name in ("words", "readings"))
    by_words = matrix([one.words for one in rows], word_hashes, norm=True)
    both = hstack([by_words, matrix([one.readings for one in rows], reading_hashes)]).tocsr()
    values = tuple(sorted({answer for one in rows for answer in one.allowed}))
    may = np.array([[value in one.target for value in values] for one in rows])
    whole, bias = multinomial(both, may, L2, STEPS)
    alone, bias_alone = multinomial(by_words, may, L2_ALONE, STEPS)
    cut = len(word_hashes)
    kept = _large(np.hstack([whole[:cut], alone]))
    field = Field(values, whole[:cut][kept], whole[cut:], bias, alone[kept], bias_alone, (), ())
    return Kind(word_hashes[kept], reading_hashes, field)


def _frequent(rows: Sequence[NDArray[np.uint32]]) -> NDArray[np.uint32]:
    found, count = np.unique(np.concatenate(rows), return_counts=True)
    frequent: NDArray[np.uint32] = found[count >= SEEN_IN]
    return frequent


def _large(weights: Floats) -> NDArray[np.bool_]:
    most = np.abs(weights).max(1)
    large: NDArray[np.bool_] = most > SMALL * most.max()
    return large


def matrix(rows: Sequence[NDArray[np.uint32]], hashes: NDArray[np.uint32], norm: bool = False) -> Any:
    """(questions, features) of what a question has: rows of one length, or the weight of a reading."""
    at = [rows_at(one, hashes) for one in rows]
    scale = [WORDS_NORM / np.sqrt(max(1, len(one))) if norm else READING_WEIGHT for one in at]
    data = np.concatenate([np.full(len(one), by) for one, by in zip(at, scale, strict=True)])
    return csr_matrix((data, np.concatenate(at), np.cumsum([0, *map(len, at)])), shape=(len(rows), len(hashes)))


def say(kind: Kind, rows: Sequence[Row]) -> tuple[Floats, Floats]:
    """(questions, answers) probabilities of both readers."""
    field = kind.field
    by_words = matrix([one.words for one in rows], kind.word_hashes, norm=True)
    read = matrix([one.readings for one in rows], kind.reading_hashes)
    return (
        softmax(by_words @ field.words + read @ field.readings + field.bias),
        softmax(by_words @ field.words_alone + field.bias_alone),
    )


# ------------------------------------------------------------------ judge
def signs(readers: int) -> tuple[int, ...]:
    """Signs of a judge's figures: surer readers are no less likely right, what the text tells no more likely wrong."""
    return 0, *(1,) * readers, -1, -1


class Judged(NamedTuple):
    """One question: what stands beside the rules' own answer, and which of both are right."""

    row: Row
    contest: Contest
    rule_right: bool
    other_right: bool


class Judge(NamedTuple):
    """Figures of a kind, as `learned_reader.Field` has them."""

    change: tuple[float, ...]
    keep: tuple[float, ...]

    @staticmethod
    def of(some: Sequence[Judged]) -> Judge:
        """From questions that the readers did not learn from."""
        differ = [one for one in some if one.rule_right != one.other_right]
        may = signs(len(some[0].contest.keep) - 1) if some else signs(2)
        change = _figures([one.contest.change for one in differ], [one.other_right for one in differ], may)
        keep = _figures([one.contest.keep for one in some], [one.rule_right for one in some], may[:-2])
        return Judge(change, keep)

    def decides(self, one: Judged) -> tuple[float, bool, bool]:
        """How sure, whether that is right, and whether the rules give way."""
        p = probability(self.change, one.contest.change)
        if p >= takes(one.row.told):
            return p, one.other_right, True
        return probability(self.keep, one.contest.keep), one.rule_right, False


def _figures(of: Sequence[Sequence[float]], marks: Sequence[bool], may: Sequence[int]) -> tuple[float, ...]:
    found = logistic(np.array(of, dtype=float).reshape(-1, len(may)), np.array(marks, dtype=float), may)
    return tuple(round(float(one), 4) for one in found)


def judged(kind: Kind, rows: Sequence[Row], third: Sequence[Floats] | None = None) -> list[Judged]:
    """Questions with what stands beside the rules' answers; `third`: what one more reader gives to every answer."""
    values = tuple(map(str, kind.field.values))
    voices = (*say(kind, rows), *((third,) if third is not None else ())) if rows else ()
    found = []
    for one, *shares in zip(rows, *voices, strict=True) if rows else ():
        if (beside := contest(values, shares, one.rule, one.told, one.may)) is not None:
            found.append(Judged(one, beside, one.rules_right, one.right(beside.other)))
    return found


def words(ends: Sequence[tuple[Judged, tuple[float, bool, bool]]]) -> tuple[str, int, int]:
    """For the table; and how many are mended and spoiled."""
    marks = [(one.rule_right, right) for one, (_, right, _) in ends]
    before, after = (sum(side) / max(1, len(marks)) for side in (zip(*marks, strict=True) if marks else ((), ())))
    error = calibration_error([(p, right) for _, (p, right, _) in ends])
    changed = sum(end[2] for _, end in ends)
    text = f"n {len(marks)}, rules {before:.4f}, both {after:.4f}, {versus(marks)} ({changed} changed), ece {error:.3f}"
    return text, sum(b > a for a, b in marks), sum(a > b for a, b in marks)


def crossed(some: Sequence[Judged]) -> list[tuple[Judged, tuple[float, bool, bool]]]:
    """What the judge of one half decides in the other."""
    halves = some[::2], some[1::2]
    judges = Judge.of(halves[1]), Judge.of(halves[0])
    return [(one, judge.decides(one)) for half, judge in zip(halves, judges, strict=True) for one in half]


def learn(rows: Sequence[Row]) -> Iterator[tuple[str, Kind, bool, list[str]]]:
    """By kind: its readers with the judge, whether it is kept, and lines for the table."""
    for name in sorted({kind_of(one.field) for one in rows}):
        mine = [one for one in rows if kind_of(one.field) == name]
        part = {of: [one for one in mine if one.part == of] for of in ("taught", "apart", "blind")}
        if not part["taught"] or not part["apart"]:
            continue
        kind = taught(part["taught"])
        apart = judged(kind, part["apart"])
        text, mended, spoiled = words(crossed(apart))
        judge, kept = Judge.of(apart), mended >= MENDS * max(1, spoiled)
        lines = [f"{name}, apart, judge cross-fitted: {text}{'' if kept else ' (left to the rules)'}"]
        blind = [(one, judge.decides(one)) for one in judged(kind, part["blind"])]
        lines += [f"{name}, blind: {words(blind)[0]}"] if blind else []
        least = round(float(np.quantile([kind.knows(one.words) for one in part["apart"]], FOREIGN_SHARE)), 3)
        field = kind.field._replace(change=judge.change, keep=judge.keep)
        yield name, kind._replace(field=field, least_known=least), kept, lines


def read_rows(pool: Path, limit: int | None, processes: int) -> list[Row]:
    """The rows of a pool's lines, or of so many drawn."""
    lines = drawn_lines(pool, limit)
    if processes == 1:
        return [row for line in lines for row in rows_of(line)]
    with Pool(processes) as workers:
        return [row for found in workers.imap(rows_of, lines, chunksize=20) for row in found]


def kept_rows(file: Path | None, pool: Path, limit: int | None, processes: int) -> list[Row]:
    """The rows in a file of an earlier call, else those of the pool, which are then kept there."""
    if file is not None and file.is_file():
        return numbered_rows.load(file)
    rows = read_rows(pool, limit, processes)
    if file is not None:
        numbered_rows.save(rows, file)
    return rows


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--rows", type=Path, help="keep the rows here, or take them from here")
    parser.add_argument("--limit", type=int)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, default=NUMBERED_WEIGHTS)
    args = parser.parse_args(arguments)
    learned: dict[str, Kind] = {}
    for name, kind, kept, lines in learn(kept_rows(args.rows, args.pool, args.limit, args.processes)):
        print(*lines, sep="\n", flush=True)  # noqa: T201 - a command prints
        learned |= {name: kind} if kept else {}
    found: Learned = learned
    save(found, args.out)


if __name__ == "__main__":
    main()
