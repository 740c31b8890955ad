"""What a training is told: options of the command line, and what suits a GPU."""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass, fields
from pathlib import Path


@dataclass
class Options:
    """What one call is told."""

    out: Path
    budget: float
    device: str = "cpu"
    dtype: str = ""
    """Of the arithmetic (masters are fp32): "bfloat16" or "float32"; not given: what the device is fast in."""
    call: float = 1e9
    """Seconds after which this call stops, whatever the budget."""
    seed: int = 0
    tokens: int = 3000
    """Tokens of a batch of one rank, padding counted."""
    workers: int = 1
    threads: int = 1
    """Of each rank."""
    ranks: int = 2
    rank: int = 0
    size: str = "mini"
    save_every: float = 150.0
    max_steps: int = 10**9
    total_steps: int = 0
    """If given, progress is counted in steps rather than seconds: two runs are then equal to the bit."""
    muon_lr: float = 0.015
    adam_lr: float = 0.0025
    texts: int = 6000
    start: str = ""
    """Exported weights to begin with (`plugins/backbone/mini/weights`), with fresh optimizer state."""
    hold: float = 0.4
    """Share of the budget with the full learning rate."""
    stage: str = "auto"
    """What is shown: "pictures" (drawings, no answers: the tower alone), "text" (narratives), "all", these in turn
    ("auto"), "words" (everything, but mostly narratives), "written" (half of it narratives of writers), "drawings"
    (mostly drawings, most of which show turn lanes or kinds of vehicles that are seldom seen), or "gist" (the
    gist of told texts, made incidents and made narratives, beside a quarter of "words")."""
    told: str = ""
    """File of texts of which a part is known (`research.rows.partial_labels.load`), for the stage "gist"."""
    eyes: str = ""
    """Exported weights whose eye and vision tower are taken in place of those of `start`."""
    fixed_eyes: int = 0
    """1: eye and vision tower are not trained."""
    sentences: float = 0.1
    """Weight of what sentences and phrases tell, beside the answers."""
    pointers: float = 0.1
    """Weight of where an answer looks for what it is to say, beside the answers."""
    drawings: float = 0.1
    """Weight of what the tokens of drawings show."""


CHOICES = {
    "dtype": ("", "bfloat16", "float32"),
    "stage": ("auto", "pictures", "text", "words", "written", "drawings", "all", "gist"),
}


def parse(arguments: list[str] | None = None, description: str | None = None) -> Options:
    """Options from the command line; DEVICE and BUDGET in the environment are defaults."""
    parser = argparse.ArgumentParser(prog="python -m research.training.train", description=description)
    parser.add_argument("--out", type=Path, default=Path("runs/mini-train"))
    parser.add_argument("--budget", type=float, default=float(os.environ.get("BUDGET", 3600)))
    parser.add_argument("--device", default=os.environ.get("DEVICE", "cpu"))
    for field in fields(Options):
        if field.name not in ("out", "budget", "device"):
            flag = f"--{field.name.replace('_', '-')}"
            parser.add_argument(flag, type=type(field.default), default=field.default, choices=CHOICES.get(field.name))
    return suited(Options(**vars(parser.parse_args(arguments))))


def suited(options: Options) -> Options:
    """On a GPU: one rank, many workers and large batches, unless told otherwise."""
    if options.device.startswith("cuda"):
        options.ranks = 1
        options.workers = max(options.workers, (os.cpu_count() or 2) - 2)
        options.tokens = options.tokens if options.tokens != Options.tokens else 16_000
    return options
