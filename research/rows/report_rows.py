"""Reports to rows of tokens.

A row is evidence (narrative, then picture), the road token, the road answer, the scenario token, the behavior
answer: one sequence that trains both queries. Knows no model and no optimizer.
"""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from plugins.backbone.mini import drawing_view
from research.generator.phrase_notes import NOTES
from research.generator.report import Report
from research.model import answer_grammar
from research.model.tokens import IMAGE, ROAD, SCENARIO, VISION_END, VISION_START, Coder
from research.renderer.around import Shape
from research.rows import attention_targets, evidence_labels
from research.rows.row import Row

FINE = 4
"""Pixels along a token in which coverage is counted."""
MAX_TEXT = 640
"""Tokens of narrative that a training row may have; longer ones are made anew, shorter."""


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
            if weight >= 1 and (sources := attention_targets.sources(row, report, pick.path)):
                row.pointers.append((len(row.ids), sources))
        row.ids += ids


def _goes_on(number: str, options: tuple[str, ...]) -> bool:
    """Whether more digits might follow a number, so that its end is a choice too ("5", where "51" may be written).

    A decoder that goes by tokens, not by the options of a walk, asks there; behind a point it always does ("40.0").
    """
    if "." in number:
        return True
    return number.isdigit() and any(other.startswith(number) and other != number for other in options)
