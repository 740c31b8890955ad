"""The crash in seven words: the walk of a `sgcad_core.reading.second_reader.seven_question_gist.Gist`, and rows that
know only a part of it.

The question is the road token and the scenario token with no layout between them, so no token had to be added. A row
of partial labels has for each field the values that it allows: the loss is -log of the share of all of them together
(Cour, Sapp & Taskar 2011, "Learning from partial labels"), and none where nothing is known. What is read on the way to
a later field is one of the allowed values. Knows no model.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from random import Random

from research.generator.report import Report
from research.model import answer_grammar
from research.model.answer_grammar import Force, Pick, Walk
from research.model.tokens import ROAD, SCENARIO, Coder
from research.rows.partial_labels import OPTIONS, Told
from research.rows.report_rows import MAX_TEXT
from research.rows.row import Row
from sgcad_core.kinds import PLAIN


def gist_walk() -> Walk:
    """`Gist` as compact JSON."""
    for number, (key, options) in enumerate(OPTIONS.items()):
        yield Force(f'{"," if number else "{"}"{key}":')
        yield Pick(options, (key,))
    yield Force("}")


def told_of(report: Report) -> Told | None:
    """What a made report tells of its gist; None where it is refused or the subject's contact is not the first."""
    crash, behavior = report.crash, report.behavior
    if behavior is None or "actors" not in behavior:
        return None
    ids = [actor["id"] for actor in behavior["actors"]]
    contact = behavior["contacts"][0] if behavior["contacts"] else {}
    ends = {contact.get(key): key for key in ("striker", "struck")}
    if "V1" not in ends or len(ends) != 2:
        return None
    mine = ends.pop("V1")
    name, theirs = ends.popitem()
    me, them = ids.index("V1"), ids.index(name)
    actors = behavior["actors"]
    known = "layout" in report.stated or (report.has_image and "layout" in report.drawn)
    values = {
        "touched": True, "met": actors[them]["kind"], "subject": actors[me]["maneuver"],
        "other": actors[them]["maneuver"], "subject_area": contact[f"{mine}_area"],
        "other_area": contact[f"{theirs}_area"], "junction": crash.layout != PLAIN,
    }  # fmt: skip
    paths = {
        "met": ("actors", them, "kind"), "subject": ("actors", me, "maneuver"), "other": ("actors", them, "maneuver"),
        "subject_area": ("contacts", 0, f"{mine}_area"), "other_area": ("contacts", 0, f"{theirs}_area"),
    }  # fmt: skip
    weight = {key: min(1.0, report.weight(path)) for key, path in paths.items()} | {"junction": 1.0 if known else 0.25}
    return Told(str(report.seed), report.narrative, {k: (v,) for k, v in values.items()}, weight)


def gist_row(coder: Coder, told: Told, rng: Random, worn: tuple[float, float] = (0.0, 0.0)) -> Row:
    """Text, question and answer; `worn` as `Coder.worn` has it. Of a text that is too long the end is left out."""
    text = told.text.strip().replace("<|", "< |")
    row = Row(coder.worn(text, *worn, rng)[0][:MAX_TEXT], [])
    row.ids += [coder.special[ROAD], coder.special[SCENARIO]]
    ways = {key: tuple(map(json.dumps, values)) for key, values in told.allowed.items()}
    chosen = {key: rng.choice(ways.get(key, options)) for key, options in OPTIONS.items()}
    for text, pick in answer_grammar.drive(gist_walk(), lambda pick: chosen[str(pick.path[0])]):
        ids = coder.piece(text)
        if pick is not None:
            key = str(pick.path[0])
            weight = float(told.weight.get(key, 1.0)) if key in ways else 0.0
            if weight:
                row.picks.append((len(row.ids), weight))
                row.also[len(row.ids)] = _first_tokens(coder, ways[key])
        row.ids += ids
    return row


def _first_tokens(coder: Coder, values: Iterable[str]) -> list[int]:
    """Every option of a gist is one token."""
    return [coder.piece(value)[0] for value in values]
