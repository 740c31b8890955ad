"""One training row: tokens, the places of values in them with their weights, and labels of the evidence."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass
class Row:
    """One training row; picks are places of value tokens with their weights."""

    ids: list[int]
    picks: list[tuple[int, float]]
    sheet: NDArray[np.uint8] | None = None
    grid: tuple[int, int] = (0, 0)
    image_start: int = 0
    pieces: list[tuple[str, str]] = field(default_factory=list)
    text_tags: list[tuple[int, list[int]]] = field(default_factory=list)
    """Place of the last token of each sentence and what the sentence tells, as indices into `evidence_labels.TEXT`."""
    notes: list[tuple[int, list[int]]] = field(default_factory=list)
    """Place of the last token of each noted phrase and what it tells, as indices into `NOTES`."""
    pointers: list[tuple[int, list[int]]] = field(default_factory=list)
    """Place of a value and the places that tell it."""
    also: dict[int, list[int]] = field(default_factory=dict)
    """Place of a value of which only a set is known, and the tokens of that set."""
    picture_tags: NDArray[np.uint8] | None = None
    """What each picture token shows, (tokens, len(evidence_labels.PICTURE)) of 0 and 1."""
