"""What a training leaves on disk. Every file is replaced whole, so that after a kill at any moment the folder goes on.

`state.pt` holds all that the next step depends on: masters, optimizer, steps, seconds, and for every rank where it
stands among its rows. A step draws nothing from the global random generators (seeds follow from numbers), so that none
of them is kept. Knows no loop and no losses.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import load_file, save_file

from plugins.backbone.mini import patch_convnet
from research.generator.report import make_report
from research.model.tokens import load_tokenizer, train_tokenizer
from research.rows.row_stream import Place
from research.training.export import export
from research.training.muon_adamw import Optimizer
from research.training.train_options import Options

TOKENIZER_BASE = 40_000_000
HEADS = "tags.safetensors"
STATE = "state.pt"
KEPT = ("optimizer", "spent", "steps", "rows", "places")


def make_tokenizer(options: Options) -> Any:
    """The folder's tokenizer; where there is none it is copied from `start` or trained."""
    folder = options.out / "tokenizer"
    if not (folder / "tokenizer.json").is_file():
        if options.start and not folder.is_dir():
            made = load_tokenizer(Path(options.start))
        else:
            texts = (make_report(TOKENIZER_BASE + i, False, 0.7, {"text": 1.0}).narrative for i in range(options.texts))
            made = train_tokenizer(texts)
        _replace_folder(folder, made)
    return load_tokenizer(folder)


def _replace_folder(folder: Path, tokenizer: Any) -> None:
    fresh = folder.with_name(f"{folder.name}.new")
    shutil.rmtree(fresh, ignore_errors=True)
    tokenizer.save_pretrained(fresh)
    shutil.rmtree(folder, ignore_errors=True)
    fresh.rename(folder)


def write_state(folder: Path, state: Mapping[str, Any]) -> None:
    """Replace the state, which has the keys KEPT."""
    path = folder / STATE
    torch.save(dict(state), path.with_suffix(".new"))
    os.replace(path.with_suffix(".new"), path)


def read_state(folder: Path, optimizer: Optimizer, device: str) -> dict[str, Any] | None:
    """The state, whose optimizer is restored already; None where there is none yet.

    Raises ValueError for one of a model with other layers or heads, or of an older form.
    """
    path = folder / STATE
    if not path.is_file():
        return None
    state: dict[str, Any] = torch.load(path, map_location=device, weights_only=True)
    if state["optimizer"]["master"].keys() != optimizer.master.keys():
        raise ValueError(f"{path} is of a model with other layers or heads: {_elsewhere(folder)}")
    if state.keys() != set(KEPT):
        raise ValueError(f"{path} does not say where each process stood among its rows: {_elsewhere(folder)}")
    optimizer.load_state_dict(state["optimizer"])
    return state


def _elsewhere(folder: Path) -> str:
    return f"train in another folder, --start {folder}/export"


def place_of(places: list[list[float]], rank: int, ranks: int) -> Place:
    """Where a rank goes on: where it stood, or behind all rows used so far if there were more or fewer ranks."""
    if len(places) == ranks:
        return Place.of(places[rank])
    return Place(max(Place.of(numbers).pool for numbers in places) + 1 + rank)


def write_export(model: Any, seen_by: patch_convnet.Eye, tokenizer: Any, heads: torch.nn.Module, folder: Path) -> None:
    """`export/`: written beside it, then moved over file by file."""
    fresh, there = folder / "export.new", folder / "export"
    export(model, seen_by, tokenizer, fresh)
    save_file({k: v.contiguous() for k, v in heads.state_dict().items()}, fresh / HEADS)
    there.mkdir(exist_ok=True)
    for file in sorted(fresh.iterdir()):
        os.replace(file, there / file.name)
    fresh.rmdir()


def exported(model: Any, folder: Path) -> dict[str, torch.Tensor]:
    """Weights of an export by name, and of the heads and the eye beside them where there are some."""
    weights = type(model).from_pretrained(folder, dtype=torch.float32, local_files_only=True)
    found = dict(weights.named_parameters())
    for name, file in (("heads", HEADS), ("eye", patch_convnet.FILE)):
        if (folder / file).is_file():
            found |= {f"{name}.{k}": v.float() for k, v in load_file(folder / file).items()}
    return found
