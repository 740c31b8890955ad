"""Training of the north finder on made drawings: `python -m research.training.train_north --out
plugins/backbone/mini/weights`, some minutes."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors.torch import save_file
from torch import Tensor
from torch.nn import functional as F

from plugins.backbone.mini import drawing_view
from plugins.backbone.mini.north_arrow import FILE, SHEET, STRIDE, Floats, NorthFinder, load, sheet
from plugins.precision import native_dtype
from research.generator.report import make_report
from research.renderer.draw import Drawing, draw_labeled
from research.rows.evidence_labels import PICTURE

NORTHS = {index for name, index in PICTURE.items() if name.startswith("north=")}
SEEDS, HELD_OUT = 70_000_000, 60_000_000
"""Where the seeds of its drawings begin; the model's own are far below."""
SHRUNK = (0.6, 1.0)
"""Drawings that train are shrunk by that much, since real ones are several times as large as made ones."""


def lesson(drawing: Drawing, turned: int, shrink: float = 1.0) -> tuple[Floats, NDArray[np.int64]]:
    """Sheet and class of every place (4: no arrow, -1: too near to tell) of a drawing, turned a further `turned` and
    shrunk."""
    image = drawing_view.turn_upright(drawing.image, turned)
    ink, scale = sheet(image, shrink)
    wanted = np.full((SHEET // STRIDE, SHEET // STRIDE), 4)
    quarters = drawing_view.quarters_of(drawing.turn - turned * np.pi / 2)
    for shape in drawing.shapes:
        if not set(shape.tags) & NORTHS:
            continue
        corners = drawing_view.turn_points(shape.corners, drawing.image.size, turned) * scale
        middle, reach = corners.mean(axis=0), float(np.ptp(corners, axis=0).max()) / 2
        y, x = np.mgrid[0 : SHEET // STRIDE, 0 : SHEET // STRIDE] * STRIDE + STRIDE / 2
        far = np.hypot(x - middle[0], y - middle[1])
        wanted[far < 1.6 * reach] = -1
        wanted[far < max(0.5 * reach, 0.75 * STRIDE)] = quarters
    return ink, wanted


def lessons(seed: int) -> Iterator[tuple[Floats, NDArray[np.int64]]]:
    """Lessons without end; every drawing is shown at two quarter turns, so that all four are equally common."""
    while True:
        drawing = draw_labeled(make_report(seed, modes={"image": 1.0}))
        for turned in (seed % 4, (seed + 2) % 4):
            yield lesson(drawing, turned, Random(f"{seed} {turned}").uniform(*SHRUNK))
        seed += 1


def loss_of(finder: NorthFinder, sheets: Tensor, wanted: Tensor) -> Tensor:
    """What the best place says of each sheet, and a little of what every place says of itself.

    Most places are easily no arrow, and their mean passes over the few turn arrows and paths of vehicles that outbid a
    north arrow of ten pixels; among all places and turns of one sheet exactly those count.
    """
    logits = finder(sheets)
    return _best(logits, wanted) + 0.3 * _places(logits, wanted)


def _best(logits: Tensor, wanted: Tensor) -> Tensor:
    """Mean -log of the share of the right place and turn among all of the sheet; of "none" where there is no arrow."""
    odds = (logits[:, :4] - logits[:, 4:]).flatten(1)
    turns = torch.arange(4, device=wanted.device)[None, :, None, None]
    quarter = wanted.flatten(1).where(wanted.flatten(1) < 4, -1).amax(dim=1)
    right = (wanted[:, None] == turns).flatten(1)
    near = ((wanted[:, None] == -1) & (turns == quarter[:, None, None, None])).flatten(1)
    every = torch.cat((odds.masked_fill(near, float("-inf")), odds.new_zeros(len(odds), 1)), dim=1)
    found = every.masked_fill(~torch.cat((right, (quarter < 0)[:, None]), dim=1), float("-inf"))
    return (every.logsumexp(dim=1) - found.logsumexp(dim=1)).mean()


def _places(logits: Tensor, wanted: Tensor) -> Tensor:
    """Cross-entropy over places; those with an arrow weigh as much as all others together."""
    each = F.cross_entropy(logits, wanted, ignore_index=-1, reduction="none")
    arrow = (wanted >= 0) & (wanted < 4)
    return each[arrow].sum() / arrow.sum().clamp(min=1) + each[wanted == 4].mean()


def accuracy(finder: NorthFinder, count: int, seed: int = HELD_OUT) -> float:
    """Share of held-out drawings that are turned upright."""
    drawings = [draw_labeled(make_report(seed + i, modes={"image": 1.0})) for i in range(count)]
    return sum(finder.quarters(d.image) == drawing_view.quarters_of(d.turn) for d in drawings) / count


def train(out: Path, budget: float, batch: int = 16, peak: float = 4e-3, steps: int = 10**9) -> NorthFinder:
    """Train for `budget` seconds or `steps`, from the weights in `out` if there are some; written at the end."""
    torch.manual_seed(0)
    finder, begun, step = load(out) or NorthFinder(), time.monotonic(), 0
    feed, fast = lessons(SEEDS + int(finder.seen)), native_dtype("cpu") == torch.bfloat16
    finder.to(memory_format=torch.channels_last).train()  # type: ignore[call-overload]
    optimizer = torch.optim.AdamW(finder.parameters(), lr=peak, weight_decay=1e-4)
    while (spent := (time.monotonic() - begun) / budget) < 1 and step < steps:
        sheets, wanted = zip(*(next(feed) for _ in range(batch)), strict=True)
        with torch.autocast("cpu", torch.bfloat16, enabled=fast):
            loss = loss_of(finder, torch.from_numpy(np.stack(sheets)), torch.from_numpy(np.stack(wanted)))
        optimizer.zero_grad()
        loss.backward()
        for group in optimizer.param_groups:
            group["lr"] = peak * min(1.0, 0.1 + step / 50) * (1.0 if spent < 0.4 else max(0.02, (1 - spent) / 0.6))
        optimizer.step()
        finder.seen += batch // 2
        step += 1
        if step % 25 == 0:
            sys.stderr.write(json.dumps({"step": step, "spent": round(spent, 3), "loss": round(loss.item(), 4)}) + "\n")
    finder.eval()
    save_file({k: v.contiguous() for k, v in finder.state_dict().items()}, out / FILE)
    return finder


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m research.training.train_north", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("plugins/backbone/mini/weights"))
    parser.add_argument("--budget", type=float, default=400.0, help="seconds")
    parser.add_argument("--check", type=int, default=400, help="held-out drawings to count on")
    options = parser.parse_args(arguments)
    torch.set_num_threads(1)
    options.out.mkdir(parents=True, exist_ok=True)
    train(options.out, options.budget)
    finder = load(options.out)
    assert finder is not None  # noqa: S101 - just written
    sys.stdout.write(f"upright: {accuracy(finder, options.check):.3f} of {options.check} held-out drawings\n")


if __name__ == "__main__":
    main()
