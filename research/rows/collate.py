"""Rows to padded batches. Knows no model and no optimizer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from plugins.backbone.mini import drawing_view
from research.generator.phrase_notes import ASKED
from research.model.batch import Batch
from research.model.tokens import PAD, Coder
from research.rows import evidence_labels
from research.rows.row import Row

Ints = NDArray[np.int64]


def positions(row: Row) -> Ints:
    """M-RoPE positions (3, L): text counts on, a picture spans its grid and moves on by its longer side."""
    length = len(row.ids)
    out = np.broadcast_to(np.arange(length), (3, length)).copy()
    if row.sheet is None:
        return out
    rows, columns = row.grid[0] // 2, row.grid[1] // 2
    start, count = row.image_start, rows * columns
    out[0, start : start + count] = start
    out[1, start : start + count] = start + np.repeat(np.arange(rows), columns)
    out[2, start : start + count] = start + np.tile(np.arange(columns), rows)
    out[:, start + count :] += max(rows, columns) - count
    return out


def collate(rows: Sequence[Row], coder: Coder) -> Batch:
    """A padded batch, pad on the right."""
    longest = max(len(row.ids) for row in rows)
    ids = np.full((len(rows), longest), coder.special[PAD])
    place = np.zeros((3, len(rows), longest), np.int64)
    picks, wanted, weights = [], [], []
    allowed: list[list[int]] = []
    for i, row in enumerate(rows):
        n = len(row.ids)
        ids[i, :n], place[:, i, :n] = row.ids, positions(row)
        for at, weight in row.picks:
            picks.append(i * longest + at - 1)
            wanted.append(row.ids[at])
            allowed.append(row.also.get(at, [row.ids[at]]))
            weights.append(weight)
    pointing = [(i, at, found) for i, row in enumerate(rows) for at, found in row.pointers]
    sources = np.zeros((len(pointing), longest), np.bool_)
    for n, (_, _, found) in enumerate(pointing):
        sources[n, found] = True
    seen = _pictured(rows)
    ends, told = _asked([row.text_tags for row in rows], len(evidence_labels.TEXT), longest)
    phrases, noted = _asked([row.notes for row in rows], ASKED, longest)
    return Batch(
        ids=torch.from_numpy(ids),
        positions=torch.from_numpy(place),
        picks=torch.tensor(picks),
        wanted=torch.tensor(wanted),
        weights=torch.tensor(weights),
        allowed=_padded(allowed),
        ends=ends,
        sentence_tags=told,
        phrases=phrases,
        noted=noted,
        drawn=_drawn(seen),
        pointing=torch.tensor([i * longest + at - 1 for i, at, _ in pointing], dtype=torch.int64),
        sources=torch.from_numpy(sources),
        **_pictures(seen, longest),
    )


def _padded(allowed: Sequence[Sequence[int]]) -> torch.Tensor:
    """Lists of tokens as a table, -1 behind shorter ones."""
    most = max((len(some) for some in allowed), default=1)
    return torch.tensor([[*some, *[-1] * (most - len(some))] for some in allowed]).reshape(-1, most)


def _asked(
    found: Sequence[Sequence[tuple[int, list[int]]]], kinds: int, longest: int
) -> tuple[torch.Tensor, torch.Tensor]:
    """Flat places of the tagged tokens of every row, (S,), and which of the first `kinds` tags each has, (S, kinds)."""
    places = [i * longest + at for i, row in enumerate(found) for at, _ in row]
    told = np.zeros((len(places), kinds), np.float32)
    for n, said in enumerate(said for row in found for _, said in row):
        told[n, [tag for tag in said if tag < kinds]] = 1
    return torch.tensor(places, dtype=torch.int64), torch.from_numpy(told)


def _pictured(rows: Sequence[Row]) -> list[tuple[int, Row]]:
    """Rows with a picture, those of one shape together, and their numbers."""
    return sorted(((i, row) for i, row in enumerate(rows) if row.sheet is not None), key=lambda found: found[1].grid)


def _drawn(seen: Sequence[tuple[int, Row]]) -> torch.Tensor:
    """Tags of all picture tokens, in the order of `Batch.patch_index`."""
    found = [row.picture_tags for _, row in seen if row.picture_tags is not None]
    empty = np.zeros((0, len(evidence_labels.PICTURE)), np.uint8)
    return torch.from_numpy(np.concatenate((empty, *found))).float()


def _pictures(seen: Sequence[tuple[int, Row]], longest: int) -> dict[str, Any]:
    """sheets, grids, lengths, image_index, patch_index."""
    sheets: dict[tuple[int, int], list[NDArray[np.uint8]]] = {}
    for _, row in seen:
        sheets.setdefault(row.grid, []).append(row.sheet)  # type: ignore[arg-type]
    lengths = [row.grid[0] * row.grid[1] for _, row in seen]
    most = max(lengths, default=4)
    grids = np.zeros((len(seen), most, 2), np.int64)
    places, tokens = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for n, ((i, row), count) in enumerate(zip(seen, lengths, strict=True)):
        grids[n, :count] = drawing_view.places(row.grid)
        places.append(i * longest + row.image_start + np.arange(count // 4))
        tokens.append(n * (most // 4) + np.arange(count // 4))
    return {
        "sheets": [torch.from_numpy(np.stack(group)) for group in sheets.values()],
        "grids": torch.from_numpy(grids),
        "lengths": torch.tensor(lengths, dtype=torch.int64),
        "image_index": torch.from_numpy(np.concatenate(places)),
        "patch_index": torch.from_numpy(np.concatenate(tokens)),
    }
