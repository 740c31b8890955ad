"""Heads that say of every value of an answer whether the evidence tells it: `python -m
research.training.train_evidence_heads plugins/backbone/mini/weights`.

A model that is asked answers; where the evidence tells nothing it guesses, and its probability does not say which of
the two it did. Its state at the place of the value does: on that state, the last one before the output embedding,
stands one logistic regression for every kind of value (`research.model.evidence_heads`). The model itself is not
changed. Rows are made reports, half of them with sentences left out, some with a drawing, and narratives by writers;
every value is labelled by whether text or drawing tells it. Fit the heads again whenever the weights change.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import torch
from torch import Tensor

from plugins.backbone.mini.patch_convnet import Sight
from research.generator.report import Report, depleted, make_report
from research.generator.writer_texts import shipped, some_report
from research.model import answer_grammar, evidence_heads
from research.model.model import Forward
from research.model.tokens import ROAD, SCENARIO, Coder
from research.rows import evidence_labels
from research.rows.collate import collate
from research.rows.report_rows import evidence, road_ids
from research.rows.row import Row
from research.rows.row_stream import HELD_OUT_BASE, drawing, length_for
from research.training.evaluate import load

SEEDS = 40_000_000
"""Where the seeds of its reports begin."""
MODES = {"text": 0.7, "both": 0.2, "image": 0.1}
WRITTEN = 0.4
"""Share of the rows that writers told."""
DEPLETED = 0.5
BATCH = 12
LEAST = 20
"""Values of either kind, told and untold, that a head needs."""


class Value(NamedTuple):
    """A value of an answer: which head it is of, where it begins in the row, and whether the evidence tells it."""

    head: str
    at: int
    told: bool


def head_of(path: Sequence[Any]) -> str:
    """The head of the value at a path: its names without the places in lists ("legs.lanes_in")."""
    return ".".join(part for part in path if isinstance(part, str))


def is_told(report: Report, path: tuple[Any, ...]) -> bool | None:
    """Whether text or drawing tells the value at a path; None where that is no fact, or told in part."""
    fact, _ = evidence_labels.fact_of(path, report.crash)
    if not fact or fact in report.doubtful:
        return None
    known = report.stated | (report.drawn if report.has_image else set())
    if path[-1] == "exit_road":  # a turn tells where it leads
        return fact in known or fact.replace("man.", "exit.") in known
    return fact in known


def labelled(coder: Coder, report: Report, row: Row) -> list[Value]:
    """Adds both answers to a row of evidence; the values of them that are a choice."""
    found = []
    for task, answer, walk in (
        (ROAD, report.road, answer_grammar.road_walk()),
        (SCENARIO, report.behavior, answer_grammar.behavior_walk(road_ids(report.road))),
    ):
        row.ids.append(coder.special[task])
        for text, pick in answer_grammar.write(walk, answer):
            if pick is not None and len(pick.options) > 1 and pick.path[-1] != "more":
                told = is_told(report, pick.path)
                found += [Value(head_of(pick.path), len(row.ids), told)] if told is not None else []
            row.ids += coder.piece(text)
    row.picks = [(value.at, 1.0) for value in found]
    return found


def reports(count: int, seed: int = SEEDS, held_out: bool = False) -> Iterator[Report]:
    """So many reports that are answered: made ones, half of them depleted, and writers' ones (none if `held_out`)."""
    while count:
        rng = Random(f"{seed} told")
        if not held_out and rng.random() < WRITTEN:
            report = some_report(shipped(), seed)
        else:
            report = make_report(seed, held_out, length_for(rng, "all", rng.random()), MODES)
            if report.narrative and rng.random() < DEPLETED:
                report = depleted(report, rng)
        seed += 1
        if report.behavior is not None:
            count -= 1
            yield report


@torch.no_grad()
def states(forward: Forward, coder: Coder, sight: Sight, some: Sequence[Report]) -> dict[str, tuple[Tensor, Tensor]]:
    """By head: states at its values, (values, hidden), and whether they are told, (values,)."""
    rows = []
    for report in some:
        image = drawing(report) if report.has_image else None
        row = evidence(coder, report.narrative, sight.upright(image) if image else None)
        rows.append((row, labelled(coder, report, row)))
    rows.sort(key=lambda found: len(found[0].ids))
    found: dict[str, list[tuple[Tensor, bool]]] = defaultdict(list)
    for start in range(0, len(rows), BATCH):
        batch = collate([row for row, _ in rows[start : start + BATCH]], coder)
        last = forward.run(batch, batch.picks).last.float()
        values = [value for _, some_values in rows[start : start + BATCH] for value in some_values]
        for value, state in zip(values, last, strict=True):
            found[value.head].append((state, value.told))
    return {
        head: (torch.stack([state for state, _ in both]), torch.tensor([told for _, told in both]))
        for head, both in found.items()
    }


def table(heads: Mapping[str, Tensor], seen: Mapping[str, tuple[Tensor, Tensor]]) -> Iterator[str]:
    """A line a head: values, share told, share right, share of pairs in order."""
    for head, weights in sorted(heads.items()):
        if head in seen:
            right, pairs = evidence_heads.right_and_ordered(weights, *seen[head])
            told = seen[head][1]
            yield f"{head:24s} n={len(told):6d} told={told.float().mean():.3f} right={right:.3f} pairs={pairs:.3f}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m research.training.train_evidence_heads", description=__doc__)
    parser.add_argument("folder", type=Path, help="the model's weights; the heads are written beside them")
    parser.add_argument("--count", type=int, default=4000, help="reports to learn from")
    parser.add_argument("--check", type=int, default=400, help="made reports in held-out wording to count on")
    options = parser.parse_args(arguments)
    torch.set_num_threads(1)
    forward, coder, sight = load(options.folder)
    seen = states(forward, coder, sight, list(reports(options.count)))
    enough = {head: x for head, x in seen.items() if min(int(x[1].sum()), int((~x[1]).sum())) >= LEAST}
    heads = {head: evidence_heads.fit(*x) for head, x in enough.items()}
    evidence_heads.save(heads, options.folder)
    checked = states(forward, coder, sight, list(reports(options.check, HELD_OUT_BASE, held_out=True)))
    sys.stdout.write("\n".join(table(heads, checked)) + "\n")


if __name__ == "__main__":
    main()
