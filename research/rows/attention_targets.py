"""Pointers: where in the evidence of a row each value of its answers stands, which attention is to learn.

States that know are not yet answers, as long as no head looks there. Ends of sentences and of noted phrases tell
values, picture tokens those that no sentence does. Knows rows and reports; no model.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from typing import Any

import numpy as np

from research.generator.crash.compass_ties import VAGUE
from research.generator.phrase_notes import NOTES
from research.generator.report import Report
from research.rows import evidence_labels
from research.rows.row import Row


def sources(row: Row, report: Report, path: tuple[Any, ...]) -> list[int]:
    """Places that tell the value at a path: ends of sentences, or picture tokens where no sentence does."""
    fact, shown = evidence_labels.fact_of(path, report.crash)
    alike = {fact, *([fact.replace("lanes.", "ways.")] if _closed(path, report) else [])}
    alike |= {fact.replace("areas.", "side.")} if path[-1] == "striker_area" else set()
    legs = {evidence_labels.TEXT[shown]} if fact == "legs" else set()  # told in parts, by those who use a leg
    told = zip(row.text_tags, report.sentences, strict=True)
    if fact.startswith("lane.") and fact in report.doubtful:
        alike = set()  # "the left lane" of nobody tells how many: the drawing does
    whole = [(at, said, facts) for (at, said), (_, facts) in told if f"{VAGUE}.{fact}" not in facts]
    found = [at for at, said, facts in whole if alike & facts or legs.intersection(said)]
    found += _noted(row, report, path, found)
    if not found and row.picture_tags is not None and fact in report.drawn and shown in evidence_labels.PICTURE:
        found += (row.image_start + np.flatnonzero(row.picture_tags[:, evidence_labels.PICTURE[shown]])).tolist()
    return found


def _noted(row: Row, report: Report, path: tuple[Any, ...], sentences: Sequence[int]) -> list[int]:
    """Places of the noted phrases that tell the value at a path, within the `sentences` (their ends) that tell it."""
    kinds = [{NOTES[name] for name in names} for names in _notes(report, path)]
    if not kinds:
        return []
    ends = [at for at, _ in row.text_tags]
    placed = [(at, ends[bisect_left(ends, at)]) for at, said in row.notes if any(names <= set(said) for names in kinds)]
    return [at for at, end in placed if end in sentences and at < end]


def _notes(report: Report, path: tuple[Any, ...]) -> list[tuple[str, ...]]:
    """Names that all stand behind a phrase that tells a value, of every kind of phrase that may: an item of a list of
    lanes, a road with as many either way, a side.

    Lanes that lead away from the hub are those that lead straight towards it on the other side.
    """
    key = str(path[-1])
    if path[0] == "legs" and len(path) > 2 and path[2] in ("lanes_in", "lanes_out", "turns_in"):
        bearing = report.crash.legs[path[1]].bearing
        items = (f"leg={(bearing + 4) % 8}", "use=through") if key == "lanes_out" else (f"leg={bearing}",)
        return [items, *([(f"axis={bearing % 4}",)] if path[2] != "turns_in" else [])]
    if path[0] == "contacts" and key.endswith("_area") and path[1] < len(report.crash.contacts):
        contact = report.crash.contacts[path[1]]
        actor = report.crash.actors[getattr(contact, key.removesuffix("_area"))].id
        name = f"{actor}.area={getattr(contact, key)}"
        return [(name,)] if name in NOTES else []
    return []


def _closed(path: tuple[Any, ...], report: Report) -> bool:
    """Whether a path asks for lanes of a direction that a one-way road does not have."""
    asks = len(path) == 3 and path[0] == "legs" and path[2] in ("lanes_in", "lanes_out")
    return asks and path[1] < len(report.crash.legs) and not getattr(report.crash.legs[path[1]], path[2])
