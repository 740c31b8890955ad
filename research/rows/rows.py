"""Reports to rows of tokens, and rows to padded batches.

A row is evidence (narrative, then picture), the road token, the road answer, the scenario token, the behavior
answer: one sequence that trains both queries. Knows no model and no optimizer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from plugins.backbone.mini import drawing_view
from research.generator.phrase_notes import ASKED, NOTES
from research.generator.report import Report
from research.model import answer_grammar
from research.model.batch import Batch
from research.model.tokens import IMAGE, PAD, ROAD, SCENARIO, VISION_END, VISION_START, Coder
from research.rows import attention_targets as pointers
from research.rows import evidence_labels

if TYPE_CHECKING:
    from research.renderer.draw import Shape

Ints = NDArray[np.int64]
FINE = 4
"""Pixels along a token in which coverage is counted."""
MAX_TEXT = 640
"""Tokens of narrative that a training row may have; longer ones are made anew, shorter."""


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
    """Place of the last token of each sentence and what the sentence tells, as indices into `tags.TEXT`."""
    notes: list[tuple[int, list[int]]] = field(default_factory=list)
    """Place of the last token of each noted phrase and what it tells, as indices into `NOTES`."""
    pointers: list[tuple[int, list[int]]] = field(default_factory=list)
    """Place of a value and the places that tell it."""
    also: dict[int, list[int]] = field(default_factory=dict)
    """Place of a value of which only a set is known, and the tokens of that set."""
    picture_tags: NDArray[np.uint8] | None = None
    """What each picture token shows, (tokens, len(tags.PICTURE)) of 0 and 1."""


def evidence(coder: Coder, narrative: str, image: Image.Image | None, view: int = 0) -> Row:
    """The prompt without its task; the drawing in one of its views."""
    return _shown(coder, Row(coder.text(narrative.strip()), []), image, view)


def _shown(coder: Coder, row: Row, image: Image.Image | None, view: int) -> Row:
    """A row with a drawing behind what it has."""
    if image is not None:
        row.sheet, row.grid = drawing_view.look(image, view)
        row.image_start = len(row.ids) + 1
        count = row.grid[0] * row.grid[1] // 4
        row.ids += [coder.special[VISION_START], *[coder.special[IMAGE]] * count, coder.special[VISION_END]]
    return row


def road_ids(road: Any) -> tuple[str, ...]:
    """Ids of the roads of a layout, legs first."""
    legs = [leg["bearing"] for leg in road["legs"]]
    outer = [f"{a['leg']}_outer" for a in road["accesses"]]
    sides = {"both": ("left", "right")}
    ends = [f"{a['leg']}_access_{side}" for a in road["accesses"] for side in sides.get(a["side"], (a["side"],))]
    return tuple(dict.fromkeys([*legs, *outer, *ends]))


def tag_text(row: Row, report: Report, ends: Sequence[int]) -> None:
    """Note at the end of every sentence and of every noted phrase what it tells; `ends` are the letters behind the
    narrative's tokens."""
    behind, before = np.array(ends), set[str]()
    for end, facts in report.sentences:
        row.text_tags.append(
            (int(np.searchsorted(behind, end)), evidence_labels.stated_tags(report.crash, facts, before))
        )
        before |= facts
    notes: dict[int, set[int]] = {}  # an item may end within the last token of its road: "lanes)"
    for end, names in report.notes:
        at = int(np.searchsorted(behind, end))
        at -= bool(at and behind[at] > end)  # its last word may be left out
        notes.setdefault(at, set()).update(NOTES[name] for name in names)
    row.notes = [(at, sorted(said)) for at, said in notes.items()]


def tag_picture(row: Row, image: Image.Image, shapes: Sequence[Shape], view: int = 0) -> None:
    """Note for every token of a picture which shapes cover it."""
    fit = drawing_view.fit(image, view)
    rows, columns = fit.grid[0] // 2, fit.grid[1] // 2
    row.picture_tags = np.zeros((rows * columns, len(evidence_labels.PICTURE)), np.uint8)
    for shape in shapes:
        sheet = Image.new("L", (columns * FINE, rows * FINE))
        corners = fit(shape.corners) * (FINE / (2 * drawing_view.PATCH))
        ImageDraw.Draw(sheet).polygon([tuple(p) for p in corners], fill=255)
        share = np.asarray(sheet, np.float32).reshape(rows, FINE, columns, FINE).mean(axis=(1, 3)).reshape(-1) / 255
        row.picture_tags[np.ix_(share >= shape.least, shape.tags)] = 1


def training_row(
    coder: Coder,
    report: Report,
    image: Image.Image | None,
    shapes: Sequence[Shape] = (),
    view: int = 0,
    worn: tuple[float, float] = (0.0, 0.0),
) -> Row:
    """Evidence and both answers, and the tags of both sources; `worn`: shares of the narrative's tokens that are broken
    up and of its words to spare that are left out."""
    ids, ends = coder.worn(report.narrative, *worn, Random(f"{report.seed} worn"))
    row = _shown(coder, Row(ids, []), image, view)
    tag_text(row, report, ends)
    if image is not None:
        tag_picture(row, image, shapes, view)
    _answer(coder, row, ROAD, answer_grammar.write(answer_grammar.road_walk(), report.road), report)
    if report.behavior is not None:
        walk = answer_grammar.behavior_walk(road_ids(report.road))
        _answer(coder, row, SCENARIO, answer_grammar.write(walk, report.behavior), report)
    return row


def _answer(coder: Coder, row: Row, task: str, pieces: list[answer_grammar.Piece], report: Report) -> None:
    row.ids.append(coder.special[task])
    open_number = False
    for text, pick in pieces:
        ids = coder.piece(text)
        row.picks += [(len(row.ids), 1.0)] * open_number
        open_number = pick is not None and _goes_on(text, pick.options)
        if pick is not None and len(pick.options) >= 1:
            weight = report.weight(pick.path)
            row.picks += [(len(row.ids) + i, weight) for i in range(len(ids))]
            if weight >= 1 and (sources := pointers.sources(row, report, pick.path)):
                row.pointers.append((len(row.ids), sources))
        row.ids += ids


def _goes_on(number: str, options: tuple[str, ...]) -> bool:
    """Whether more digits might follow a number, so that its end is a choice too ("5", where "51" may be written).

    A decoder that goes by tokens, not by the options of a walk, asks there; behind a point it always does ("40.0").
    """
    if "." in number:
        return True
    return number.isdigit() and any(other.startswith(number) and other != number for other in options)


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
