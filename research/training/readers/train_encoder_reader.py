"""Teaches an encoder of whole numbered reports from coded ones, and prints what it adds to the linear readers.

    python -m research.training.readers.train_encoder_reader POOL.jsonl[.gz] [--rows CASES.npz] [--epochs 10]
                                                     [--seed 0] [--limit N] [--out WEIGHTS.npz]

The lines are those of `train_numbered_reader`: nine tenths of those that are not blind teach the encoder, which hides
words of their texts and is to tell them, and gives the codes' answers to all questions of a report. On the tenth set
apart a judge is fitted that hears it beside the shipped linear readers; its line there is cross-fitted between halves.
Each line holds today's answers (linear readers, their judge fitted on the same questions) against those with the
encoder. A kind in which it mends too little there, or no more than may be chance in the blind lines (exact McNemar
test), is left to the linear readers. `--rows` keeps the rows between calls, of
which no word can be read.
"""

from __future__ import annotations

import argparse
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from research.rows import narrative_rows
from research.rows.narrative_rows import Case, case_of
from research.rows.numbered_rows import drawn_lines
from research.training.readers.encoder_batches import BATCH, Lesson, Prepared, batches, lesson, prepared
from research.training.readers.encoder_net import UNSEEN, EncoderNet, Size
from research.training.readers.train_numbered_reader import MENDS, Judge, Judged, crossed, judged
from research.training.weight_fit import calibration_error, versus
from sgcad_core.metrics.statistics import mcnemar
from sgcad_core.reading.second_reader import encoder_reader
from sgcad_core.reading.second_reader.encoder_reader import Encoder, answers
from sgcad_core.reading.second_reader.encoder_tokens import FIRST_WORD, Codes
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.numbered import numbered_reader
from sgcad_core.reading.second_reader.numbered.numbered_reader import Kind, Learned
from sgcad_core.records.second_reader import ENCODER_WEIGHTS

SEEN_IN = 20
"""Reports that a word must be in: names and plates are in fewer."""
RATE, DECAY, WARM = 1.5e-3, 0.05, 0.05
"""Largest step of AdamW, its weight decay, and the share of the steps up to it, with half a cosine down over all."""
HIDE = ((0.0, 0.25, 1.0), (0.2, 0.2, 0.3), (1.0, 0.05, 0.3))
"""From which share of the steps on how many words are hidden (in between on a line) and what telling them weighs."""
SIZE = Size()
CHANCE = 0.05
"""Probability below which what is mended is no chance."""
HELD = 20
"""Of so many reports one is held out, to choose the epoch by."""
Ends = Sequence[tuple[Judged, tuple[float, bool, bool]]]


# ------------------------------------------------------------------ taught
def vocabulary(cases: Sequence[Case], seen_in: int = SEEN_IN) -> Codes:
    """Codes of the words of so many reports, sorted."""
    count = Counter(code for case in cases for code in set(case.told.codes.tolist()) if code >= FIRST_WORD)
    return np.array(sorted(code for code, reports in count.items() if reports >= seen_in), np.uint32)


def values_of(cases: Sequence[Case]) -> dict[str, tuple[str, ...]]:
    """The answers that codes allow, by kind of question."""
    found: dict[str, set[str]] = {}
    for case in cases:
        for row in case.rows:
            found.setdefault(kind_of(row.field), set()).update(row.allowed)
    return {kind: tuple(sorted(some)) for kind, some in sorted(found.items())}


def taught(cases: Sequence[Case], epochs: int, seed: int = 0, size: Size = SIZE, seen_in: int = SEEN_IN) -> Encoder:
    """An encoder of some cases, without judges."""
    torch.manual_seed(seed)
    words, values = vocabulary(cases, seen_in), values_of(cases)
    net = EncoderNet(FIRST_WORD + len(words), {kind: len(some) for kind, some in values.items()}, size)
    ready = [prepared(case, words, values) for case in cases]
    teach(net, ready[::HELD], [one for at, one in enumerate(ready) if at % HELD], epochs, np.random.default_rng(seed))
    return kept(net, words, values)


def kept(net: EncoderNet, words: Codes, values: Mapping[str, tuple[str, ...]]) -> Encoder:
    """What of a net is read: 16-bit weights without the head for hidden words."""
    state = {name: one for name, one in net.state_dict().items() if not name.startswith(UNSEEN)}
    arrays = {name: one.numpy().astype(np.float16).astype(np.float32) for name, one in state.items()}
    return Encoder(arrays, words, values, {}, net.heads)


def teach(
    net: EncoderNet, held: Sequence[Prepared], cases: Sequence[Prepared], epochs: int, draw: np.random.Generator
) -> None:
    """Steps of so many epochs; prints a line an epoch, and leaves the weights of the epoch that fits the reports
    held out best."""
    optimizer = torch.optim.AdamW(_groups(net), lr=RATE, betas=(0.9, 0.98))
    step, steps, best = 0, epochs * math.ceil(len(cases) / BATCH), (math.inf, net.state_dict())
    for epoch in range(1, epochs + 1):
        for some in batches(cases, draw):
            passed = step / steps
            for group in optimizer.param_groups:
                group["lr"] = RATE * min(1, (passed + 1 / steps) / WARM) * (0.51 + 0.49 * math.cos(math.pi * passed))
            _step(net, optimizer, some, passed, draw)
            step += 1
        wrong = loss_of(net, held)
        print(f"epoch {epoch}, step {step}: held out {wrong:.4f}", flush=True)  # noqa: T201 - a command prints
        if wrong < best[0]:
            best = wrong, {name: one.clone() for name, one in net.state_dict().items()}
    net.load_state_dict(best[1])
    net.eval()


def _groups(net: EncoderNet) -> list[dict[str, Any]]:
    decayed = {name for name, p in net.named_parameters() if p.ndim > 1 and not name.startswith(("emb", "pos"))}
    parts = [[p for name, p in net.named_parameters() if (name in decayed) == decay] for decay in (True, False)]
    return [{"params": parts[0], "weight_decay": DECAY}, {"params": parts[1], "weight_decay": 0.0}]


def _step(
    net: EncoderNet, optimizer: torch.optim.Optimizer, some: list[Prepared], passed: float, draw: np.random.Generator
) -> None:
    hide, weight = _schedule(passed)
    wrong, untold = losses(net.train(), lesson(some, net.emb.num_embeddings, hide, draw))
    optimizer.zero_grad(set_to_none=True)
    (wrong + weight * untold).backward()
    torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
    optimizer.step()


def loss_of(net: EncoderNet, cases: Sequence[Prepared]) -> float:
    """Of the answers to the questions of some reports, a report."""
    net.eval()
    order = sorted(cases, key=lambda one: len(one.ids))
    with torch.no_grad():
        lessons = (lesson(order[at : at + BATCH], net.emb.num_embeddings, 0.0) for at in range(0, len(order), BATCH))
        return sum(float(losses(net, one)[0]) for one in lessons) * BATCH / max(1, len(order))


def _schedule(passed: float) -> tuple[float, float]:
    at, shares, weights = zip(*HIDE, strict=True)
    return float(np.interp(passed, at, shares)), next(
        w for a, w in zip(at[::-1], weights[::-1], strict=True) if passed >= a
    )


def losses(net: EncoderNet, one: Lesson) -> tuple[Tensor, Tensor]:
    """Of the answers (-log of the summed probability of those that may be, Jin and Ghahramani 2002, a report and half
    its questions), and of the hidden words."""
    seen = net.encoded(one.batch)
    pooled = net.pooled(seen, one.batch)
    wrong = torch.zeros(())
    for kind, (of, may) in one.asked.items():
        scores = net.scores(kind, pooled[of, net.kinds.index(kind)].flatten(1))
        allowed = functional.log_softmax(scores, 1).masked_fill(~may, -math.inf)
        wrong = wrong - torch.logsumexp(allowed, 1).sum() / (2 * BATCH)
    told = net.words(seen[one.hidden])
    return wrong, functional.cross_entropy(told, one.words) if len(one.words) else wrong * 0


# ------------------------------------------------------------------ heard
def heard(encoder: Encoder, cases: Sequence[Case]) -> dict[str, list[tuple[Any, Any]]]:
    """Rows with the probabilities of their answers, by kind of question."""
    found: dict[str, list[tuple[Any, Any]]] = {}
    for case in cases:
        said = answers(encoder, case.told, [row.field for row in case.rows])
        for row in case.rows:
            if row.field in said:
                found.setdefault(kind_of(row.field), []).append((row, said[row.field]))
    return found


def learn(encoder: Encoder, cases: Sequence[Case], learned: Learned) -> Iterator[tuple[str, Judge | None, list[str]]]:
    """By kind: the judge that hears the encoder, None where it adds too little, and lines for the table."""
    said = {part: heard(encoder, [case for case in cases if case.part == part]) for part in ("apart", "blind")}
    for name, kind in learned.items():
        apart, blind = (said[part].get(name, []) for part in ("apart", "blind"))
        if apart and tuple(kind.field.values) == encoder.values.get(name):
            before, after = _both(kind, apart)
            text, marks = words(crossed(before), crossed(after))
            judges = Judge.of(before), Judge.of(after)
            ends = [
                [(one, judge.decides(one)) for one in some]
                for judge, some in zip(judges, _both(kind, blind), strict=True)
            ]
            unseen, more = words(*ends)
            use = adds(marks, more)
            lines = [f"{name}, apart, judges cross-fitted: {text}{'' if use else ' (left to the linear readers)'}"]
            yield name, judges[1] if use else None, [*lines, *([f"{name}, blind: {unseen}"] if blind else [])]


def adds(apart: Sequence[tuple[bool, bool]], blind: Sequence[tuple[bool, bool]]) -> bool:
    """Whether the encoder mends enough of those set apart, and of the blind ones more than by chance."""
    mended, spoiled = (sum(pair == which for pair in apart) for which in ((False, True), (True, False)))
    before, after = zip(*blind, strict=True) if blind else ((), ())
    return mended >= MENDS * max(1, spoiled) and mcnemar(before, after) < CHANCE


def _both(kind: Kind, said: Sequence[tuple[Any, Any]]) -> tuple[list[Judged], list[Judged]]:
    rows = [row for row, _ in said]
    return judged(kind, rows), judged(kind, rows, [shares for _, shares in said])


def words(before: Ends, after: Ends) -> tuple[str, list[tuple[bool, bool]]]:
    """For the table; and whether each answer is right before and with the encoder."""
    marks = [(a[1], b[1]) for (_, a), (_, b) in zip(before, after, strict=True)]
    rules = [one.rule_right for one, _ in after]
    share = [sum(some) / max(1, len(rules)) for some in (rules, [a for a, _ in marks], [b for _, b in marks])]
    error = [calibration_error([(p, right) for _, (p, right, _) in some]) for some in (before, after)]
    text = (
        f"n {len(rules)}, rules {share[0]:.4f}, linear {share[1]:.4f}, with the encoder {share[2]:.4f}, {versus(marks)}"
    )
    return f"{text}, ece {error[0]:.3f} {error[1]:.3f}", marks


# ------------------------------------------------------------------ command
def kept_cases(file: Path | None, pool: Path, limit: int | None) -> list[Case]:
    """The cases of an earlier call's file, else those of the pool, which are then kept there."""
    if file is not None and file.is_file():
        return narrative_rows.load(file)
    cases = [case for line in drawn_lines(pool, limit) if (case := case_of(line))]
    if file is not None:
        narrative_rows.save(cases, file)
    return cases


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pool", type=Path)
    parser.add_argument("--rows", type=Path, help="keep the rows here, or take them from here")
    parser.add_argument("--limit", type=int)
    parser.add_argument("--epochs", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=ENCODER_WEIGHTS)
    args = parser.parse_args(arguments)
    torch.set_num_threads(1)
    cases = kept_cases(args.rows, args.pool, args.limit)
    encoder = taught([case for case in cases if case.part == "taught"], args.epochs, args.seed)
    encoder_reader.save(encoder, args.out)
    judges: dict[str, encoder_reader.Judge] = {}
    for name, judge, lines in learn(encoder, cases, numbered_reader.load()):
        print(*lines, sep="\n", flush=True)  # noqa: T201 - a command prints
        judges |= {name: encoder_reader.Judge(*judge)} if judge else {}
    encoder_reader.save(encoder._replace(judges=judges), args.out)


if __name__ == "__main__":
    main()
