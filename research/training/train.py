"""Training: `python -m research.training.train --out runs/mini --budget 3600` trains for an hour and can be called
again.

Imports torch, transformers, safetensors, numpy, Pillow and mini only. The folder holds `state.pt`
(research/training/checkpoint.py), `log.jsonl`, the tokenizer, and after every save an `export/` that transformers
loads. Called again with the same folder it goes on from its last save, also after a kill: with `--total-steps` to the
same weights, bit for bit. The budget counts the seconds of all calls together, and the learning rate follows the
budget.
"""

from __future__ import annotations

import json
import random
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from plugins.backbone.mini.patch_convnet import Eye
from plugins.precision import native_dtype
from research.generator.phrase_notes import ASKED
from research.model.batch import Batch, Lesson, Taggers
from research.model.model import Forward, make_config, make_model
from research.model.tokens import Coder, fragments
from research.rows import evidence_labels
from research.rows.collate import collate
from research.rows.row import Row
from research.rows.row_stream import Feed, Place, stage_at
from research.training import checkpoint
from research.training.deepen_weights import BLOCKS, deepened
from research.training.distributed import Ranks
from research.training.muon_adamw import Optimizer
from research.training.train_options import Options, parse

EYES = ("model.visual.", "heads.picture.", "eye.")
"""How the names of those parameters begin that see drawings."""


def schedule(progress: float, hold: float = 0.4) -> float:
    """Learning rate over its peak: a short warm-up, constant to `hold` of the budget, then linear to 2 %."""
    if progress < 0.01:
        return 0.1 + 90 * progress
    return 1.0 if progress < hold else max(0.02, 1 - 0.98 * (progress - hold) / (1 - hold))


class Log:
    """JSON lines, one a report."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def write(self, **values: Any) -> None:
        """Append a line and show it."""
        line = json.dumps({k: round(v, 5) if isinstance(v, float) else v for k, v in values.items()})
        with self.path.open("a", encoding="utf-8") as file:
            file.write(line + "\n")
        sys.stderr.write(line + "\n")


class Trainer:
    """One run in one folder."""

    def __init__(self, options: Options) -> None:
        self.options = options
        options.out.mkdir(parents=True, exist_ok=True)
        torch.set_num_threads(options.threads)
        torch.manual_seed(options.seed)
        random.seed(options.seed)
        np.random.seed(options.seed)
        self.log = Log(options.out / "log.jsonl")
        self.ranks = Ranks(options.rank, options.ranks, str((options.out / "meeting").resolve()))
        self.tokenizer = checkpoint.make_tokenizer(options)
        self.coder = Coder(self.tokenizer)
        self.model = make_model(make_config(len(self.tokenizer), self.coder.special, options.size)).to(options.device)
        self.eye = Eye().to(options.device)
        self.forward = Forward(self.model, self.eye)
        if options.fixed_eyes:
            self.eye.requires_grad_(False)
            self.forward.vision.requires_grad_(False)
        self.answer_tokens = answer_tokens(self.coder)
        hidden = self.model.config.text_config.hidden_size
        self.taggers = Taggers(hidden, len(evidence_labels.TEXT), ASKED, len(evidence_labels.PICTURE))
        self.taggers.to(options.device)
        others = {"heads": self.taggers, "eye": self.eye}
        self.optimizer = Optimizer(self.model, options.muon_lr, options.adam_lr, others=others)
        for part in (self.model, *others.values()):
            part.to(getattr(torch, options.dtype) if options.dtype else native_dtype(options.device))
        self.spent, self.steps, self.rows = 0.0, 0, 0
        self.place = Place(options.seed * 10_000 + options.rank)
        self._resume()

    def _resume(self) -> None:
        options = self.options
        state = checkpoint.read_state(options.out, self.optimizer, options.device)
        if state is None:
            self._begin()
            return
        self.spent, self.steps, self.rows = (state[k] for k in ("spent", "steps", "rows"))
        self.place = checkpoint.place_of(state["places"], options.rank, options.ranks)
        if not options.rank:
            self.log.write(event="resumed", step=self.steps, seconds=self.spent)

    def _begin(self) -> None:
        """Fresh weights, or exported ones; from then on rows that those have not seen."""
        if not self.options.start:
            return
        found = checkpoint.exported(self.model, Path(self.options.start))
        if self.options.eyes:
            eyes = checkpoint.exported(self.model, Path(self.options.eyes))
            found = {k: v for k, v in found.items() if not k.startswith(EYES)}  # of a deeper tower nothing may stay
            found |= {k: v for k, v in eyes.items() if k.startswith(EYES)}
        masters = self.optimizer.master
        config = self.model.config
        found = deepened(found, config.text_config.num_hidden_layers)
        found = deepened(found, config.vision_config.depth, BLOCKS)
        same = {k for k in found.keys() & masters.keys() if found[k].shape == masters[k].shape}
        fits = {k: v for k, v in found.items() if k in same or not k.startswith("heads.")}
        with torch.no_grad():
            for key, value in fits.items():
                masters[key].copy_(value)
        self.optimizer.publish()
        self.place.pool += 100_000
        fresh = sorted(masters.keys() - fits.keys())
        self.log.write(event="begun with", folder=self.options.start, tensors=len(fits), fresh=fresh)

    def save(self) -> None:
        """State and export; every rank has to call it, the first one writes."""
        places = self.ranks.gathered(self.place.numbers())
        if self.options.rank:
            return
        state = {"optimizer": self.optimizer.state_dict(), "spent": self.spent, "steps": self.steps}
        checkpoint.write_state(self.options.out, state | {"rows": self.rows, "places": places})
        checkpoint.write_export(self.model, self.eye, self.tokenizer, self.taggers, self.options.out)

    @property
    def progress(self) -> float:
        """Share of the budget that is spent."""
        if self.options.total_steps:
            return self.steps / self.options.total_steps
        return self.spent / self.options.budget

    def run(self) -> None:
        """Train until the budget, the call or the steps are spent; saves at the end."""
        options = self.options
        feed = Feed(
            str(options.out / "tokenizer"), options.workers, self.place, options.ranks, options.stage, options.told
        )
        try:
            self._loop(feed)
        finally:
            feed.close()
        self.save()
        self.ranks.close()

    def _loop(self, feed: Feed) -> None:
        """Steps; the first rank's clock says for all when to save and when it is over."""
        options, begun, before = self.options, time.monotonic(), self.spent
        saved = begun
        for rows in self._batches(feed):
            now = time.monotonic()
            self.spent = before + now - begun
            over = self.progress >= 1 or now - begun > options.call or self.steps >= options.max_steps
            due = now - saved > options.save_every
            self.spent, *told = self.ranks.from_first(self.spent, over, due)
            over, due = map(bool, told)
            if over:
                return
            self._step(rows)
            self.place.used += 1
            if due:
                self.save()
                saved = time.monotonic()

    def _batches(self, feed: Feed) -> Iterator[list[Row]]:
        """Batches without end; a resumed run passes over those of its first pool that were used before."""
        for number, rows in feed.pools(lambda: self.progress):
            yield from list(batches(rows, self.options.tokens, number))[self.place.used :]
            self.place.next(self.options.ranks)

    def _candidates(self, wanted: torch.Tensor) -> torch.Tensor:
        """Answer tokens and a tenth of the others, which keeps those down at a tenth of the price."""
        seeded = torch.Generator().manual_seed(self.steps)
        others = torch.randint(len(self.tokenizer), (len(self.tokenizer) // 10,), generator=seeded)
        found: torch.Tensor = torch.cat([p.to(wanted.device) for p in (self.answer_tokens, others, wanted)]).unique()
        return found

    def _lesson(self, batch: Batch) -> Lesson:
        """The losses of the stage."""
        if stage_at(self.options.stage, self.place.made_at)[0] != "pictures":
            return self.forward.lesson(batch, self._candidates(batch.allowed[batch.allowed >= 0]), self.taggers)
        drawings = self.taggers.drawings(self.forward.seen(batch), batch.drawn)
        nothing = torch.zeros(())
        return Lesson(nothing, nothing, nothing, nothing, drawings, nothing)

    def _step(self, rows: list[Row]) -> None:
        batch = collate(rows, self.coder).to(self.options.device)
        started = time.monotonic()
        options, lesson = self.options, self._lesson(batch)
        loss = lesson.answers + options.drawings * lesson.drawings + options.pointers * lesson.pointers
        loss = loss + options.sentences * (lesson.sentences + lesson.phrases)
        loss.backward()
        self.ranks.average(self.optimizer.live.values())
        self.optimizer.step(schedule(self.progress, self.options.hold))
        self.steps += 1
        self.rows += len(rows) * self.options.ranks
        if self.steps % 20 == 0 and not self.options.rank:
            took = time.monotonic() - started
            self.log.write(
                step=self.steps,
                seconds=self.spent,
                rows=self.rows,
                **lesson.figures,
                step_s=took,
                batch=len(rows),
                tokens=batch.ids.shape[1],
            )


def answer_tokens(coder: Coder) -> torch.Tensor:
    """Tokens that answers are made of."""
    texts = [*fragments(), *(str(n) for n in range(100)), ",", "]}", "}", ".0"]
    return torch.tensor(sorted({i for text in texts for i in coder.piece(text)}))


def batches(rows: list[Row], tokens: int, seed: int) -> Iterator[list[Row]]:
    """Neighbors in length, as many as fit into `tokens`, in random order."""
    groups: list[list[Row]] = [[]]
    for row in rows:
        if groups[-1] and (len(groups[-1]) + 1) * len(row.ids) > tokens:
            groups.append([])
        groups[-1].append(row)
    random.Random(seed).shuffle(groups)
    yield from groups


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point: the first rank starts the others."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    options = parse(given, __doc__)
    others = []
    if options.rank == 0 and options.ranks > 1:
        options.out.mkdir(parents=True, exist_ok=True)
        (options.out / "meeting").unlink(missing_ok=True)
        checkpoint.make_tokenizer(options)
        others = [
            subprocess.Popen([sys.executable, "-m", "research.training.train", *given, "--rank", str(rank)])  # noqa: S603 - ourselves
            for rank in range(1, options.ranks)
        ]
    Trainer(options).run()
    for other in others:
        other.wait(timeout=60)


if __name__ == "__main__":
    main()
